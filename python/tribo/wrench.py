"""The wrench at the tool along a log."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from tribo import _tribo
from tribo._paths import LogLike, ModelLike, as_log

if TYPE_CHECKING:
    import pandas as pd

AXES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
"""Components of a wrench: force (N), moment (Nm)."""


@dataclass(frozen=True)
class WrenchSeries:
    """The wrench by the robot on its environment along a log; the rows in which the estimator settles are NaN."""

    time: npt.NDArray[np.float64]
    """Stamps (s), ``(n,)``."""
    wrench: npt.NDArray[np.float64]
    """Force (N) then moment (Nm) at the flange, base axes, ``(n, 6)``."""
    sd: npt.NDArray[np.float64]
    """Standard deviation that the estimator states, ``(n, 6)``."""
    lower95: npt.NDArray[np.float64]
    """Lower 95 % limits, ``(n, 6)``."""
    upper95: npt.NDArray[np.float64]
    """Upper 95 % limits, ``(n, 6)``."""
    summary: dict[str, Any]
    """Mean, RMS, maximum … as in ``tribo estimate --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """A DataFrame over time (s) with columns ``Fx`` … ``Mz``, ``Fx_sd`` …"""
        import pandas as pd

        columns = {axis: self.wrench[:, i] for i, axis in enumerate(AXES)}
        columns |= {f"{axis}_sd": self.sd[:, i] for i, axis in enumerate(AXES)}
        return pd.DataFrame(columns, index=pd.Index(self.time, name="time"))


def estimate(
    log: LogLike,
    model: ModelLike | None = None,
    *,
    residual: str = "ekf",
    free: LogLike | None = None,
    touched: float | None = None,
    anyway: bool = False,
) -> WrenchSeries:
    """Estimates the wrench at the tool along a log.

    :param log: the log, or its path.
    :param model: what is believed of the arm; left out, the bare Panda. Friction that the model does not have counts as wrench.
    :param residual: ``ekf``, ``momentum``, ``qp``, ``thermal`` or ``double_encoder``.
    :param free: a log of the same arm that nobody touched, from which friction band, noise and tare are taken.
    :param touched: share of the time in which somebody touches the arm, above 0 and at most 1, where it is known.
    :param anyway: go on with a log that cannot be right; what is wrong then is a warning.
    """
    free_log = None if free is None else as_log(free)
    time, wrench, sd, lower, upper, summary = _tribo.estimate(as_log(log), model, residual, free_log, touched, anyway)
    return WrenchSeries(time, wrench, sd, lower, upper, json.loads(summary))
