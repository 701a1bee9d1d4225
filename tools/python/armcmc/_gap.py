import json
import os
import subprocess
import tempfile
from pathlib import Path

from ._prefix import PREFIX


def gap(model, data, out=None):
    """Runs armcmc-gap on measured data and returns its result.json as a dict.

    model  As for Estimator; None if `data` is a recording file, which names the plant.
    data   CSV with t and the plant's signals, or a recording file (.toml).
    out    Folder for result.json, report.html and model.toml; None: the files are not kept.

    Runs the program of the same installation or build as a separate process, which takes seconds to minutes. Raises
    ValueError with the message of the program if an input is wrong, RuntimeError if it fails otherwise.
    """
    program = PREFIX / "bin" / "armcmc-gap"
    if not program.is_file():
        raise RuntimeError(f"{program} is missing: build or install the programs together with this package")
    data = os.fspath(data)
    command = [str(program), "--recording" if data.endswith(".toml") else "--data", data]
    if model is not None:
        command += ["--model", os.fspath(model)]
    with tempfile.TemporaryDirectory(prefix="armcmc-gap-") as scratch:
        folder = Path(scratch if out is None else os.fspath(out))
        run = subprocess.run(command + ["--out", str(folder)], stdin=subprocess.DEVNULL, capture_output=True,
                             text=True, errors="replace", check=False)
        if run.returncode != 0:
            words = (run.stderr.strip().splitlines() or ["no message"])[-1]
            error = ValueError if run.returncode == 2 else RuntimeError
            raise error(words if run.returncode > 0 else f"armcmc-gap was ended by signal {-run.returncode}: {words}")
        return json.loads((folder / "result.json").read_text(encoding="utf-8"))
