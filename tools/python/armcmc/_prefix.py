"""Where the product is installed, or built: bin/ and share/armcmc/ are there."""

from pathlib import Path


def _find():
    for folder in Path(__file__).absolute().parents:  # absolute, not resolved: a build tree links to the sources
        if (folder / "share" / "armcmc" / "plants").is_dir():
            return folder
    return Path("/usr")


PREFIX = _find()
