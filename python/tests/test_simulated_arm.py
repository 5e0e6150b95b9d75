"""An arm with friction."""

import numpy as np
import pytest
import tribo


def test_friction_holds_an_arm_that_gravity_does_not_pull():
    arm, believed = tribo.SimulatedArm(seed=1), tribo.Arm.preset("panda")
    start = arm.hidden["q"]
    for _ in range(200):
        arm.step(believed.gravity(start) + 0.2)
    assert (arm.hidden["q"] == start).all()
    for _ in range(200):
        arm.step(believed.gravity(start) + 3.0)
    assert np.abs(arm.hidden["dq"]).max() > 0.01
    assert np.abs(arm.hidden["friction"]).max() > 0.3


def test_the_same_seed_gives_the_same_bits():
    def run(seed):
        arm, believed = tribo.SimulatedArm("ur10e", seed=seed), tribo.Arm.preset("ur10e")
        state = arm.state
        for _ in range(50):
            state = arm.step(believed.gravity(state["q"]) + 30.0)
        return state

    first, second, other = run(1), run(1), run(2)
    assert all(np.array_equal(first[key], second[key]) for key in first)
    assert not np.array_equal(first["q"], other["q"])
    assert (first["time"], first["q"].shape) == (pytest.approx(0.05), (6,))


def test_without_friction_it_obeys_the_equations_of_motion(random):
    arm, believed = tribo.SimulatedArm("panda", "frictionless", noise=0), tribo.Arm.preset("panda")
    tau = believed.gravity(arm.hidden["q"]) + random.normal(size=7)
    q, qd = arm.hidden["q"], arm.hidden["dq"]
    arm.step(tau)
    expected = qd + arm.dt * believed.forward_dynamics(q, qd, tau)
    np.testing.assert_allclose(arm.hidden["dq"], expected, rtol=1e-3, atol=1e-9)


def test_reset_and_wrong_input():
    arm = tribo.SimulatedArm(seed=4)
    first = arm.state
    arm.step(np.zeros(7))
    assert np.array_equal(arm.reset()["q"], first["q"])
    moved = arm.reset(np.array([0, -0.5, 0, -2, 0, 1.5, 0.5]), seed=9)
    assert moved["q"][1] == pytest.approx(-0.5, abs=1e-4)
    with pytest.raises(ValueError, match="tau has 6 numbers"):
        arm.step(np.zeros(6))
    with pytest.raises(ValueError, match="allowed: finite numbers"):
        arm.step(np.full(7, np.nan))
    with pytest.raises(ValueError, match="six numbers"):
        arm.step(np.zeros(7), [1, 2])
    with pytest.raises(FileNotFoundError, match="no_such"):
        tribo.SimulatedArm(friction="no_such.yaml")
    with pytest.raises(ValueError, match="noise is -1"):
        tribo.SimulatedArm(noise=-1)
