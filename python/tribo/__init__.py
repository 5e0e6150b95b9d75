"""Sense of touch for robot arms without force sensors.

Estimates the wrench at the tool, tunes friction compensators, and says what a model lacks to explain a measured log.

All arrays are ``(n, joints)``, a row per sample; SI units, radians; wrenches are force (N) then moment (Nm), by the robot on its environment, in base axes at
the flange. Input that cannot be used is a ``ValueError`` that says what is allowed, a file that the system refuses an ``OSError``; what may be wrong
with a log is a ``UserWarning``.

>>> import tribo
>>> arm = tribo.Arm.preset("panda")
>>> arm.gravity(arm.poses[0]).shape
(7,)
"""

from tribo._tribo import (
    PRESETS,
    Arm,
    Compensator,
    Log,
    Model,
    SimulatedArm,
    Study,
    WrenchEstimator,
)
from tribo._tribo import VERSION as __version__
from tribo.campaign import Campaign, Told, Trial
from tribo.diagnosis import Diagnosis, Finding, diagnose
from tribo.frames import log_from_pandas, log_to_pandas, read_log, record
from tribo.tuning import TuneResult, tune
from tribo.wrench import WrenchSeries, estimate

__all__ = [
    "PRESETS",
    "Arm",
    "Campaign",
    "Compensator",
    "Diagnosis",
    "Finding",
    "Log",
    "Model",
    "SimulatedArm",
    "Study",
    "Told",
    "Trial",
    "TuneResult",
    "WrenchEstimator",
    "WrenchSeries",
    "__version__",
    "diagnose",
    "estimate",
    "log_from_pandas",
    "log_to_pandas",
    "read_log",
    "record",
    "tune",
]
