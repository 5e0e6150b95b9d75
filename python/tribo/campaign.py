"""Tuning on one's own robot: ask for parameters, run the trial, tell what came of it."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

from tribo import _tribo
from tribo._paths import LogLike, Path, as_log, plain
from tribo._tribo import Compensator


@dataclass(frozen=True)
class Trial:
    """Parameters to try on the robot."""

    number: int
    """Number of the trial."""
    compensator: Compensator
    """What is to be added in this trial: ``compensator.torque(dq, dq_reference)``."""
    params: dict[str, Any]
    """The parameters, joint by joint."""
    origin: Any
    """Who chose them."""
    document: dict[str, Any] = field(repr=False)
    """Everything, as ``tribo ask --json`` prints it."""


@dataclass(frozen=True)
class Told:
    """What a trial cost, and what is known since."""

    trial: int
    """Number of the trial."""
    cost: float
    """Its cost J: max + mean of the wrench's components (N + Nm)."""
    best: dict[str, Any] | None
    """The trial whose parameters to use, with the cost expected of them and its standard deviation."""
    early_stop: Any | None
    """Why another trial is not worth its time, if it is not."""
    remarks: list[str]
    """What the logs say of joints that stand and of the friction law."""
    document: dict[str, Any] = field(repr=False)
    """Everything, as ``tribo tell --json`` prints it."""

    @property
    def done(self) -> bool:
        """Whether there is nothing left to gain, or all trials have been told."""
        return self.early_stop is not None or self.document["finished"] >= self.document["trials"]


class Campaign:
    """A tuning campaign in a directory, whose trials run on your robot.

    Everything is in the directory's journal before a call returns: a process may die between two calls, another may go on, and the
    command ``tribo ask`` and ``tribo tell`` may take turns with it.

    :param directory: where the campaign is, or will be once the first trial is asked for.
    :param settings: settings of a new campaign, by the names of ``campaign.yaml``: ``robot``, ``strategy``, ``trials``, ``velocity``, ``seed``,
        ``user_trials={"judged_from_s": 3.0, "judged_s": 30.0, "torque": "commanded"}`` …
    """

    def __init__(self, directory: Path, **settings: Any) -> None:
        self.directory = FilePath(os.fspath(directory))
        self._settings = json.dumps(settings, default=plain)
        if settings and (self.directory / "campaign.yaml").exists():
            raise ValueError(f"{self.directory}: holds a campaign, which keeps the settings it began with")

    def ask(self, *, anyway: bool = False) -> Trial:
        """The next parameters to try; with ``anyway`` also where another trial is not worth its time."""
        return self._asked(None, anyway)

    def asked(self, trial: int) -> Trial:
        """The parameters of a running trial once more."""
        return self._asked(trial, False)

    def _asked(self, trial: int | None, anyway: bool) -> Trial:
        text, compensator = _tribo.ask(self.directory, self._settings, anyway, trial)
        document = json.loads(text)
        return Trial(
            number=document["trial"],
            compensator=Compensator.from_yaml(compensator),
            params=document["params"],
            origin=document["origin"],
            document=document,
        )

    def tell(self, log: LogLike | None = None, trial: Trial | int | None = None, *, failed: str | None = None) -> Told:
        """Records what came of a trial: its log, and where it was stopped, why.

        :param log: log of the whole trial, from the start of the motion; none only of one that failed.
        :param trial: the trial; may be left out where one is running.
        :param failed: why the trial was stopped.
        """
        number = trial.number if isinstance(trial, Trial) else trial
        told = None if log is None else as_log(log)
        document = json.loads(_tribo.tell(self.directory, told, number, failed))
        return Told(
            trial=document["trial"],
            cost=document["cost"],
            best=document["best"],
            early_stop=document["early_stop"],
            remarks=document["remarks"],
            document=document,
        )

    def withdraw(self, trial: int, reason: str) -> None:
        """Takes a told trial back; it stays in the journal with the reason and counts no more."""
        _tribo.withdraw(self.directory, trial, reason)

    def give_up(self, trial: int) -> None:
        """Gives a running trial up, as if it had never been asked for."""
        _tribo.give_up(self.directory, trial)

    @property
    def finished(self) -> list[int]:
        """Numbers of the trials that have been told."""
        return _tribo.campaign_state(self.directory)[0]

    @property
    def running(self) -> list[int]:
        """Numbers of the trials that have been asked for and not been told."""
        return _tribo.campaign_state(self.directory)[1]

    @property
    def compensator(self) -> Compensator:
        """The best compensator so far (``tuned.yaml``)."""
        return Compensator.read(self.directory / "tuned.yaml")

    def __repr__(self) -> str:
        return f"Campaign({str(self.directory)!r})"
