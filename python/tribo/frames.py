"""Logs from and to DataFrames, and from the simulated arm."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from tribo import _tribo
from tribo._paths import ModelLike, Path
from tribo._tribo import Log

if TYPE_CHECKING:
    import pandas as pd

Map = Union[str, "os.PathLike[str]", Mapping[str, Any]]
"""Which column is what: entries, the path of a map file, or its content."""


def read_log(path: Path, *, map: Map | None = None, joints: Sequence[str] = ()) -> Log:
    """Reads a log of any format that the command reads: CSV, Parquet, MCAP, rosbag2, NumPy ``.npz`` and the public data sets.

    :param path: the file, or the directory of a rosbag2.
    :param map: which column is what, where they are not Tribo's own names: ``"q=pos_{joint}[deg],tau=eff_{joint},time=stamp[ms]"``, the path of a map file, or its
        content as a dictionary (docs/logs.md). Left out, the names themselves say it, and a ``UserWarning`` says what was taken; where they leave a choice it is an error.
    :param joints: names of the arm's joints from the base, where the columns have names.
    """
    text, is_text = _map_text(map)
    return _tribo.read_log(path, text, is_text, list(joints), None)


def _map_text(map: Map | None) -> tuple[str | None, bool]:
    if map is None or isinstance(map, str):
        return map, False
    if isinstance(map, os.PathLike):
        return os.fspath(map), False
    return json.dumps(map), True


def log_from_pandas(frame: pd.DataFrame, *, map: Map | None = None, joints: Sequence[str] = ()) -> Log:
    """A log from a DataFrame: one row per sample, or one per joint and sample.

    :param frame: the columns ``time``, ``q_0`` …, ``tau_J_0`` … of a canonical log, or others that ``map`` or their names explain; an index with a name is a column too.
    :param map: as in ``read_log``.
    :param joints: as in ``read_log``.
    """
    if frame.index.name is not None and frame.index.name not in frame.columns:
        frame = frame.reset_index()
    columns: dict[str, Any] = {str(name): frame[name].to_numpy() for name in frame.columns}
    if map is None and {"time", "q_0"} <= columns.keys():
        return Log.from_columns(columns)
    text, is_text = _map_text(map)
    buffer = io.BytesIO()
    if all(values.dtype.kind in "fiub" for values in columns.values()):
        np.savez(buffer, **columns)
        name = "frame.npz"
    else:
        buffer.write(frame.to_csv(index=False).encode())
        name = "frame.csv"
    return _tribo.read_log(name, text, is_text, list(joints), buffer.getvalue())


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
