"""Bayesian optimisation of any function."""

import math

import pytest
import tribo


def run(seed, trials=25):
    study = tribo.Study({"x": (-1.0, 1.0), "y": (0.0, 2.0)}, seed=seed)
    points = []
    for _ in range(trials):
        trial, (x, y) = study.ask()
        points.append((x, y))
        study.tell(trial, (x - 0.3) ** 2 + (y - 0.7) ** 2 + 0.1)
    return study, points


def test_it_finds_the_minimum_and_repeats_itself():
    study, points = run(1)
    assert study.best[2] < 0.101 and len(study) == 25
    assert run(1)[1] == points and run(2)[1] != points
    trial, point, cost = study.recommend()
    assert trial == study.best[0] and math.dist(point, (0.3, 0.7)) < 0.05 and cost < 0.11


def test_failed_trials_and_wrong_input():
    study = tribo.Study([("x", (0.0, 1.0))], method="random")
    assert study.best is None and study.recommend() is None
    trial, _ = study.ask()
    study.tell(trial)
    assert study.best is None
    with pytest.raises(ValueError, match="allowed: finite"):
        study.tell(study.ask()[0], float("nan"))
    with pytest.raises(ValueError):
        study.tell(0, 1.0)
    with pytest.raises(ValueError, match="method is gp; allowed: bo"):
        tribo.Study({"x": (0.0, 1.0)}, method="gp")
    with pytest.raises(ValueError):
        tribo.Study({"x": (1.0, 0.0)})
