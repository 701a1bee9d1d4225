import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

from ._arrays import is_table, path_bytes, write_csv
from ._prefix import PREFIX


def gap(model, data, out=None, *, heldout=None, earlier=None, data_dir=None, seed=None, period_ms=None, without=(),
        no_pairs=False, skip_bad=False):
    """Runs armcmc-gap on measured data and returns its result.json as a dict.

    model  As for Estimator; None if `data` is a recording file, which names the plant.
    data   Columns t and the plant's signals, in their units: a dict of arrays, a structured array or a DataFrame, or
           the path of a CSV; or a recording file (.toml), which says what the columns of a CSV are.
    out    Folder for result.json, report.html and model.toml; None: the files are not kept.
    Keywords are the options of armcmc-gap: the holdout and an earlier run, given as `data` is; the folder of a
    recording's CSV; the seed of the bootstrap; the length of a pack in ms; names of effects to exclude; single effects
    only; bad rows are counted and left out.

    Runs the program of the same installation or build as a separate process, which takes seconds to minutes; other
    threads go on, and an interrupt (Ctrl-C) ends it. Raises ValueError with the message of the program if an input is
    wrong, RuntimeError if it fails otherwise.
    """
    program = PREFIX / "bin" / "armcmc-gap"
    if not program.is_file():
        raise RuntimeError(f"{program} is missing: build or install the programs together with this package")
    with tempfile.TemporaryDirectory(prefix="armcmc-gap-") as scratch:
        folder = os.fsencode(scratch) if out is None else path_bytes("out", out)
        command = [os.fsencode(program), b"--out", folder]

        def add(name, value):
            command.extend((b"--" + name.replace("_", "-").encode(), value))

        def file(name, value):
            if not is_table(value):
                return path_bytes(name, value)
            write_csv(name, value, Path(scratch, name), finite=not skip_bad)
            return os.fsencode(Path(scratch, name))

        source = file("data", data)
        recording = source.endswith(b".toml")
        if recording and model is not None:
            raise ValueError("the recording file names the plant: give None as model")
        if not recording and model is None:
            raise ValueError("model = None: give a plant; only a recording file (.toml) names one")
        add("recording" if recording else "data", source)
        for name, value in (("model", model), ("data_dir", data_dir)):
            if value is not None:
                add(name, path_bytes(name, value))
        for name, value in (("heldout", heldout), ("earlier", earlier)):
            if value is not None:
                add(name, file(name, value))
        names = [without] if isinstance(without, str) else without
        for name, value in (("seed", seed), ("period_ms", period_ms), *(("without", effect) for effect in names)):
            if value is not None:
                add(name, path_bytes(name, str(value)))
        command += [b"--no-pairs"] * bool(no_pairs) + [b"--skip-bad"] * bool(skip_bad)
        run = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, encoding="utf-8",
                             errors="backslashreplace", check=False)
        if run.returncode != 0:
            words = _for_python((run.stderr.strip().splitlines() or ["no message"])[-1], scratch)
            error = ValueError if run.returncode == 2 else RuntimeError
            raise error(words if run.returncode > 0 else f"armcmc-gap was ended by signal {-run.returncode}: {words}")
        return json.loads(Path(os.fsdecode(folder), "result.json").read_text(encoding="utf-8"))


def _for_python(words, scratch):
    """The message of the program with names of keywords instead of options, and without its scratch folder."""
    words = words.removeprefix("armcmc-gap: ").replace(scratch + os.sep, "")
    option = r"(?<![^\s(])--(model|data|out|heldout|earlier|data-dir|seed|period-ms|without|no-pairs|skip-bad)(?![\w-])"
    return re.sub(option, lambda match: match[1].replace("-", "_"), words)
