"""Adaptive recursive MCMC: the posterior of a plant's parameters, pack by pack.

    estimator = armcmc.Estimator("servo_axis")
    estimate = estimator.step(u, y, dt)            # u: (samples, inputs), y: (samples,)
    samples, weights = estimator.draws()

The same code as the programs armcmc-replay and armcmc-estimator: the same packs and settings give bit-identical
results. Not for real time, for which there is armcmc-estimator.
"""

import os

try:
    from . import _armcmc
except ImportError as _error:
    from ._prefix import import_problem

    raise ImportError(import_problem() or str(_error)) from _error
from ._estimator import Estimate, Estimator, Record
from ._gap import gap
from ._prefix import PREFIX as _PREFIX

_armcmc.use_shared_prefix(os.fsencode(_PREFIX))

__version__ = _armcmc.version
MAX_PACK_SAMPLES = _armcmc.max_pack_samples
__all__ = ["Estimate", "Estimator", "MAX_PACK_SAMPLES", "Record", "gap", "models"]


def models():
    """Names of the bundled plants, as `armcmc-model list` shows them."""
    return _armcmc.plant_names()
