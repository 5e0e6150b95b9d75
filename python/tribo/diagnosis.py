"""What a model lacks to explain a log."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from tribo import _tribo
from tribo._paths import LogLike, ModelLike, Path, as_logs
from tribo._tribo import Model


@dataclass(frozen=True)
class Finding:
    """One cause that the model lacks."""

    cause: str
    """Kind of the cause: ``payload``, ``coulomb``, ``torque_offset`` …, as in model files."""
    joint: int | None
    """Joint at which it acts, from 0; none of a cause of a link or of the whole arm."""
    link: int | None
    """Link that is wrong, from 0."""
    params: dict[str, float | list[float]]
    """Its parameters, by name with unit: ``mass_kg``, ``com_m`` …"""
    params_ci95: dict[str, list[Any]]
    """Their 95 % intervals."""
    alternatives: list[dict[str, Any]]
    """Causes that the logs do not tell from this one; where there are any, the diagnosis is not sure."""
    held_out_gain: float | None
    """Part of the residual's RMS on unseen samples that goes with this finding."""
    p_value: float | None
    """Chance of as much evidence where nothing is missing."""
    evidence: float | None
    """Log evidence for it."""
    sentence: str
    """The finding in words."""
    raw: dict[str, Any] = field(repr=False)
    """The finding as in ``tribo diagnose --json``."""

    @property
    def label(self) -> str:
        """The older name of ``cause``."""
        return self.cause

    def __str__(self) -> str:
        return self.sentence


@dataclass(frozen=True)
class Diagnosis:
    """What a model lacks, how sure that is, and what it is worth on data that was not fitted."""

    verdict: str
    """``nothing_missing``, ``named``, ``ambiguous`` or ``unknown``."""
    sentence: str
    """The verdict in words."""
    findings: list[Finding]
    """The causes, the most important first."""
    rms_nm: dict[str, list[float]]
    """RMS of the torque residual of each joint (Nm): ``before``, ``after``, ``held_out_before``, ``held_out_after``."""
    gain_heldout: float | None
    """Part of the residual's RMS on unseen samples that the extended model explains."""
    unseen: dict[str, Any] | None
    """RMS on unseen samples by model, plain least-squares baselines among them; the extended model over the better baseline is
    ``ratio_to_better_baseline``: below 1 the diagnosis is worth its complexity."""
    next_experiment: dict[str, Any] | None
    """The motion that would tell the rivals apart."""
    notes: list[str]
    """What else is to be known."""
    document: dict[str, Any] = field(repr=False)
    """Everything, as ``tribo diagnose --json`` prints it (``tribo.diagnosis/1``)."""
    _raw: _tribo.RawDiagnosis = field(repr=False, compare=False)

    @property
    def model(self) -> Model:
        """The model extended by all that was found."""
        return self._raw.extended()

    def extend(self, path: Path) -> Model:
        """Writes the extended model as a model file, whole or not at all, and gives it."""
        model = self._raw.extended()
        model.save(os.fspath(path))
        return model

    def report(self, path: Path) -> None:
        """Writes the report with its plots, one HTML file."""
        self._raw.write_report(os.fspath(path))

    def __str__(self) -> str:
        return "\n".join([self.sentence, *(f"- {finding}" for finding in self.findings)])

    def _repr_html_(self) -> str:
        text, joints = html.escape, self._raw.joints()
        rows = "".join(
            "<tr>"
            f"<td>{text(finding.cause.replace('_', ' '))}</td><td>{text(_place(finding.joint, finding.link, joints))}</td>"
            f"<td style='text-align:left'>{'<br>'.join(_values(finding))}</td>"
            f"<td>{_percent(finding.held_out_gain)}</td>"
            f"<td>{text(', '.join(_rival(rival, joints) for rival in finding.alternatives))}</td>"
            "</tr>"
            for finding in self.findings
        )
        heads = ["cause", "where", "parameters [95 %]", "gain on unseen", "not told from"]
        table = f"<table><tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr>{rows}</table>" if rows else ""
        columns = "".join(f"<th>{text(joint)}</th>" for joint in joints)
        figures = "".join(
            f"<tr><th>{name}</th>{''.join(f'<td>{_number(value)}</td>' for value in self.rms_nm[key])}</tr>"
            for name, key in [("before", "held_out_before"), ("after", "held_out_after")]
        )
        unseen = f"<table><tr><th>RMS on unseen [Nm], joint</th>{columns}</tr>{figures}</table>"
        return f"<p><b>{text(self.sentence)}</b></p>{table}{unseen}"


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.0f} %"


def _place(joint: int | None, link: int | None, joints: list[str]) -> str:
    if joint is not None:
        return joints[joint]
    return f"link {link}" if link is not None else "arm"


def _rival(rival: dict[str, Any], joints: list[str]) -> str:
    place = _place(rival["joint"], rival["link"], joints)
    return str(rival["cause"]).replace("_", " ") + ("" if place == "arm" else f" at {place}")


def _values(finding: Finding) -> list[str]:
    lines = []
    params: dict[str, Any] = dict(finding.params)
    if "wrench_by_robot" in finding.raw:
        # Of a push people read the wrench that estimators give; params hold the push itself.
        wrench = finding.raw["wrench_by_robot"]
        params |= {"force_by_robot_n": wrench["force_n"], "moment_by_robot_nm": wrench["moment_nm"]}
        params = {name: value for name, value in params.items() if name not in ("force_n", "moment_nm")}
    for name, value in params.items():
        interval = finding.params_ci95.get(name)
        if isinstance(value, float) and isinstance(interval, list) and len(interval) == 2:
            shown = f"{value:.4g} [{interval[0]:.4g}, {interval[1]:.4g}]"
        elif isinstance(value, list):
            shown = ", ".join(_number(part) if isinstance(part, float) else str(part) for part in value)
        else:
            shown = str(value)
        lines.append(f"{html.escape(name)}: {html.escape(shown)}")
    return lines


def diagnose(
    logs: LogLike | Iterable[LogLike],
    model: ModelLike | None = None,
    *,
    reference: LogLike | Iterable[LogLike] = (),
    validate: LogLike | Iterable[LogLike] = (),
    seed: int = 0,
    band_hz: float | None = None,
    anyway: bool = False,
    threads: int = 0,
    progress: Callable[[str, float], object] | None = None,
) -> Diagnosis:
    """Finds what ``model`` lacks to explain the logs of contact-free motion.

    :param logs: one log or several of the same arm, or their paths.
    :param model: what is believed; left out, the bare Panda of logs with seven joints.
    :param reference: logs of the same arm with nothing at its flange.
    :param validate: logs that nothing is fitted to; the answer says how the extended model does on them.
    :param seed: seed of permutations and bootstrap; the same logs, model and seed give the same answer.
    :param band_hz: band of the residual (Hz); chosen from the noise of the logs where it is left out.
    :param anyway: go on with a log that cannot be right; what is wrong then is a warning.
    :param threads: threads; 0 takes all processors. The answer does not depend on it.
    :param progress: called with stage and part done, 0 to 1.
    """
    raw = _tribo.diagnose(
        as_logs(logs), model, as_logs(reference), as_logs(validate), seed, band_hz, anyway, threads, progress
    )
    document: dict[str, Any] = json.loads(raw.document())
    findings = [
        Finding(
            cause=entry["cause"],
            joint=entry["joint"],
            link=entry["link"],
            params=entry["params"],
            params_ci95=entry["params_ci95"],
            alternatives=entry["alternatives"],
            held_out_gain=entry["held_out_gain"],
            p_value=entry["p_value"],
            evidence=entry["evidence"],
            sentence=sentence,
            raw=entry,
        )
        for entry, sentence in zip(document["findings"], raw.finding_sentences())
    ]
    return Diagnosis(
        verdict=document["verdict"],
        sentence=raw.verdict_sentence(),
        findings=findings,
        rms_nm=document["rms_nm"],
        gain_heldout=document["gain_heldout"],
        unseen=document["unseen"],
        next_experiment=document["next_experiment"],
        notes=document["notes"],
        document=document,
        _raw=raw,
    )
