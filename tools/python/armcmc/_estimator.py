import operator
import os

from . import _armcmc, _toml
from ._arrays import numbers, path_bytes, seconds


class Record(dict):
    """A dict whose keys are also attributes."""

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"no {name!r} here; there are {', '.join(map(str, self)) or 'none'}") from None


class Estimate(Record):
    """The result of one step: see the table in the README. `estimate["K"]` is quantity K of the reported mode."""

    def __missing__(self, name):
        quantities = self["modes"][self["report_mode"]]["quantities"] if self.keys() >= {"modes", "report_mode"} else {}
        if name not in quantities:
            raise KeyError(f"no {name!r} here; there are {', '.join(map(str, [*quantities, *self])) or 'none'}")
        return quantities[name]


def _mode(mode):
    try:
        return max(-1, min(operator.index(mode), 2**31 - 1))
    except TypeError:
        raise ValueError(f"mode = {mode!r}: give the number of a mode, an integer from 0") from None


def _records(value):
    if isinstance(value, dict):
        return Record((key, _records(item)) for key, item in value.items())
    return [_records(item) for item in value] if isinstance(value, list) else value


class Estimator:
    """The estimator of one plant.

    model   Built-in name, name of a bundled plant (armcmc.models()), or path of a plant or model file.
    config  Configuration of armcmc-estimator, by path or by name; None: the defaults of the programs.
    Keywords override tables and keys of it: sampler={"draws": 5000, "seed": 3}, noise={"std": 0.1}, method="rls".

    Raises ValueError with the key, its value and what was expected.
    """

    def __init__(self, model, config=None, **overrides):
        model = path_bytes("model", model)
        config = None if config is None else path_bytes("config", config)
        if config is not None and not overrides:
            self._own = _armcmc.Estimator.from_file(model, config)
        else:
            table, name = {"schema": 1}, b"the keywords"
            if config is not None:
                path = _armcmc.config_path(config)
                table, name = _toml.read(path), path + b" with the keywords"
            self._own = _armcmc.Estimator.from_text(model, _toml.text(_toml.merged(table, overrides)), name)
        self._model = os.fsdecode(model)

    def __repr__(self):
        return f"<armcmc.Estimator of {self._model}: {', '.join(p.name for p in self.parameters)}>"

    def __reduce__(self):
        raise TypeError("an Estimator can be neither copied nor pickled: make another one from the same arguments")

    def step(self, u, y, dt, t_last=None):
        """One pack: draws, summary, and the prior of the next pack. Releases the interpreter lock while it computes.

        u       (samples, inputs), columns as in `inputs`, in their units; at most 256 samples.
        y       (samples,), the output.
        dt      Sample interval, s.
        t_last  Time of the last sample, s; None: the pack directly follows the previous one. The numbers of packs that
                are missing before it are skipped.

        Returns an Estimate. Raises ValueError if the pack is invalid, and leaves the estimator unchanged.
        """
        own_t_last = None if t_last is None else seconds("t_last", t_last)
        return Estimate(_records(self._own.step(numbers("u", u), numbers("y", y), seconds("dt", dt), own_t_last)))

    def draws(self, mode=0):
        """(samples, weights) of the newest step: (n, dim) in the units of the columns, and (n,) with sum 1.

        The candidates with nonzero weight, each once; draw_names(mode) has the names of the columns.
        Raises ValueError if the step carried no information about that mode.
        """
        return self._own.draws(_mode(mode))

    def draw_names(self, mode=0):
        """The names of the parameters, then "noise_std" if the scale of the noise is estimated."""
        return self._own.draw_columns(_mode(mode))

    def reset(self):
        """Discards everything learnt; the next pack is the first, and starts at time 0."""
        self._own.reset()

    @property
    def parameters(self):
        """Name, unit and prior of each sampled parameter; mean, sd and bounds on the scale on which it is sampled."""
        return _records(self._own.parameters())

    @property
    def inputs(self):
        """Name and unit of each column of u."""
        return _records(self._own.inputs())

    @property
    def output(self):
        """Name and unit of y."""
        return _records(self._own.output())
