"""Tuning on the simulated arm."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any

from tribo import _tribo
from tribo._paths import Path, plain
from tribo._tribo import Compensator


@dataclass(frozen=True)
class TuneResult:
    """What came of a campaign."""

    compensator: Compensator | None
    """The best compensator; none where every trial failed."""
    best_cost: float | None
    """Cost J that is expected of another trial with it (N + Nm)."""
    uncompensated_cost: float
    """J without compensation."""
    oracle_cost: float
    """J of a compensator that knows the true friction."""
    trials: list[dict[str, Any]]
    """The trials: ``trial``, ``state``, ``cost``, ``params`` …"""
    document: dict[str, Any] = field(repr=False)
    """Everything, as ``tribo tune --json`` prints it."""

    def __repr__(self) -> str:
        best = "none" if self.best_cost is None else f"{self.best_cost:.3g}"
        return f"TuneResult({len(self.trials)} trials, J {self.uncompensated_cost:.3g} -> {best})"


def tune(*, out: Path | None = None, threads: int = 0, **settings: Any) -> TuneResult:
    """Tunes the friction compensator of a simulated arm.

    :param out: directory of the campaign, as ``tribo tune --out`` makes it; in memory where it is left out.
    :param threads: threads; 0 takes all processors. The result does not depend on it.
    :param settings: by the names of ``campaign.yaml``: ``robot``, ``truth`` (the simulated friction), ``strategy``, ``residual``, ``trials``, ``seed`` …
    """
    text, compensator = _tribo.tune(json.dumps(settings, default=plain), None if out is None else os.fspath(out), threads)
    document: dict[str, Any] = json.loads(text)
    best = document["best"]
    return TuneResult(
        compensator=compensator,
        best_cost=None if best is None else best["cost"],
        uncompensated_cost=document["uncompensated_cost"],
        oracle_cost=document["oracle_cost"],
        trials=document["trials"],
        document=document,
    )
