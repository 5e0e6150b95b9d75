"""Wrench estimates, along a log and tick by tick."""

import json

import numpy as np
import pytest
import tribo


@pytest.fixture(scope="module")
def pushed():
    """A standing arm that pushes 10 N downwards against its environment for the last second of two."""
    arm, believed = tribo.SimulatedArm("panda", "frictionless", seed=2), tribo.Arm.preset("panda")
    state, rows = arm.state, []
    start = state["q"]
    for k in range(2000):
        wrench = [0, 0, -10.0 if k >= 1000 else 0, 0, 0, 0]
        tau = believed.gravity(state["q"]) + 300 * (start - state["q"]) - 20 * state["dq"]
        state = arm.step(tau, wrench)
        rows.append((state["time"], state["q"], state["dq"], tau))
    return [np.array(column) for column in zip(*rows)]


@pytest.mark.parametrize("residual", ["ekf", "momentum", "qp"])
def test_a_push_is_felt_along_a_log_and_tick_by_tick(pushed, residual):
    time, q, dq, tau = pushed
    log = tribo.Log.from_arrays(time, q, tau, dq)
    series = tribo.estimate(log, "panda", residual=residual, anyway=True)
    assert series.wrench.shape == series.sd.shape == series.upper95.shape == (2000, 6)
    assert np.isnan(series.wrench[0]).all()
    late = series.wrench[1700:].mean(axis=0)
    assert late[2] == pytest.approx(-10, abs=2.5)
    estimator = tribo.WrenchEstimator("panda", residual)
    ticks = np.array([estimator.step(*row) for row in zip(q, dq, tau)])
    assert ticks[1700:, 2].mean() == pytest.approx(late[2], abs=0.5)
    assert estimator.covariance.shape == (6, 6) and estimator.limits95.shape == (2, 6)
    lower, upper = estimator.limits95
    assert (lower <= ticks[-1]).all() and (ticks[-1] <= upper).all()


def test_frames(pushed):
    pytest.importorskip("pandas")
    time, q, dq, tau = pushed
    frame = tribo.estimate(tribo.Log.from_arrays(time, q, tau, dq), "panda", anyway=True).to_pandas()
    assert list(frame.columns[:6]) == ["Fx", "Fy", "Fz", "Mx", "My", "Mz"] and frame.index.name == "time"


def test_the_command_says_the_same(pushed, tmp_path, command):
    time, q, dq, tau = pushed
    log = tribo.Log.from_arrays(time, q, tau, dq)
    log.write(tmp_path / "log.csv")
    words = ["estimate", "log.csv", "--robot", "panda", "--residual", "ekf", "--anyway", "--json", "--quiet"]
    said = json.loads(command(*words).stdout)["estimators"]["ekf"]
    ours = tribo.estimate(tmp_path / "log.csv", "panda", anyway=True).summary
    assert {key: said[key] for key in ours} == ours


def test_wrong_input_is_told(pushed):
    time, q, dq, tau = pushed
    log = tribo.Log.from_arrays(time, q, tau, dq)
    with pytest.raises(ValueError, match="residual is kalman; allowed: ekf, momentum"):
        tribo.estimate(log, "panda", residual="kalman")
    with pytest.raises(ValueError, match="no theta, which double_encoder needs"):
        tribo.estimate(log, "panda", residual="double_encoder", anyway=True)
    with pytest.raises(ValueError, match="touched"):
        tribo.estimate(log, "panda", touched=2.0, anyway=True)
    estimator = tribo.WrenchEstimator("panda")
    estimator.step(q[0], dq[0], tau[0])
    with pytest.raises(ValueError, match="not finite"):
        estimator.step(q[0] * np.nan, dq[0], tau[0])
    with pytest.raises(ValueError, match="tau has 6 numbers; the arm has 7 joints"):
        estimator.step(q[0], dq[0], tau[0][:6])
