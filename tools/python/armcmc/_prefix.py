"""The prefix of the installation or build, which contains bin/ and share/armcmc/."""

import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path


def _find():
    for folder in Path(__file__).absolute().parents:  # absolute, not resolved: a build tree links to the sources
        if (folder / "share" / "armcmc" / "plants").is_dir():
            return folder
    return Path("/usr")


PREFIX = _find()


def import_problem():
    """Why this interpreter cannot load the compiled part; nothing where it was built for it."""
    files = [file.name for file in Path(__file__).parent.glob("_armcmc.*.so")]
    if any(file == "_armcmc" + suffix for file in files for suffix in EXTENSION_SUFFIXES):
        return ""
    here = f"{sys.executable} is Python {sys.version_info.major}.{sys.version_info.minor}"
    there = f"armcmc was built for another Python ({', '.join(sorted(files))})" if files else "armcmc was not built"
    return f"{there}, and {here}: run the other one, or build armcmc again with -DPython_EXECUTABLE={sys.executable}"
