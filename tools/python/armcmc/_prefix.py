"""The prefix of the installation or build, which contains bin/ and share/armcmc/."""

from pathlib import Path


def _find():
    for folder in Path(__file__).absolute().parents:  # absolute, not resolved: a build tree links to the sources
        if (folder / "share" / "armcmc" / "plants").is_dir():
            return folder
    return Path("/usr")


PREFIX = _find()
