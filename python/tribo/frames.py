"""Logs from and to DataFrames, and from the simulated arm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tribo import _tribo
from tribo._paths import ModelLike
from tribo._tribo import Log

if TYPE_CHECKING:
    import pandas as pd


def log_from_pandas(frame: pd.DataFrame) -> Log:
    """A log from a DataFrame with the columns ``time`` (or the index of that name), ``q_0`` …, ``tau_J_0`` … and others of a canonical log; unknown columns are left out."""
    named = {str(name): frame[name].to_numpy() for name in frame.columns}
    if "time" not in named and frame.index.name == "time":
        named["time"] = frame.index.to_numpy()
    return Log.from_columns(named)


def log_to_pandas(log: Log) -> pd.DataFrame:
    """A DataFrame over ``time`` (s) with the canonical columns of the log."""
    import pandas as pd

    columns = dict(log.columns())
    time = columns.pop("time")
    return pd.DataFrame(columns, index=pd.Index(time, name="time"))


def record(
    model: ModelLike,
    motion: str = "multisine",
    *,
    duration: float = 30.0,
    rate: float = 500.0,
    noise: float = 1.0,
    seed: int = 1,
) -> Log:
    """The log that an arm which is truly as ``model`` says would leave of a motion, by inverse dynamics.

    :param motion: ``multisine``, ``cruise``, ``back_and_forth``, ``static_poses``, ``small_fast`` or ``joint_by_joint``.
    :param duration: length of the motion (s).
    :param rate: samples per second (Hz).
    :param noise: factor on the usual noise of encoders and torques.
    :param seed: draws the motion and the noise.
    """
    return _tribo.record(model, motion, duration, rate, noise, seed)
