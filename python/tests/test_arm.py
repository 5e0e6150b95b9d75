"""Kinematics and dynamics on arrays."""

import json
import os

import numpy as np
import pytest
import tribo


@pytest.mark.parametrize("name", ["panda", "ur10e"])
def test_dynamics_agree_with_each_other(name, random):
    arm = tribo.Arm.preset(name)
    n = arm.joints
    q, qd, qdd = random.normal(size=(3, 20, n))
    tau = arm.inverse_dynamics(q, qd, qdd)
    assert tau.shape == (20, n)
    np.testing.assert_allclose(arm.forward_dynamics(q, qd, tau), qdd, atol=1e-9)
    mass = arm.mass_matrix(q)
    np.testing.assert_allclose(tau, np.einsum("nij,nj->ni", mass, qdd) + arm.bias(q, qd), atol=1e-10)
    np.testing.assert_allclose(arm.gravity(q), arm.bias(q, np.zeros_like(q)), atol=1e-12)
    of_links = np.einsum("nij,j->ni", arm.regressor(q, qd, qdd), arm.inertial_parameters)
    np.testing.assert_allclose(of_links + arm.rotor_inertia * qdd, tau, atol=1e-10)


def test_jacobian_is_the_derivative_of_the_pose(random):
    arm = tribo.Arm.preset("panda")
    q, qd, h = random.normal(size=7), random.normal(size=7), 1e-6
    before, here, after = arm.pose(np.stack([q - h * qd, q, q + h * qd]))
    twist = arm.jacobian(q) @ qd
    np.testing.assert_allclose((after - before)[:3, 3] / (2 * h), twist[:3], atol=1e-8)
    turn = (after - before)[:3, :3] / (2 * h) @ here[:3, :3].T
    np.testing.assert_allclose([turn[2, 1], turn[0, 2], turn[1, 0]], twist[3:], atol=1e-8)


def test_the_same_bits_as_in_rust():
    expected = os.environ.get("TRIBO_EXPECTED")
    if expected is None:
        pytest.skip("TRIBO_EXPECTED is set by the test that runs this one")
    with open(expected, encoding="utf-8") as file:
        known = json.load(file)
    tau = tribo.Arm.preset("panda").inverse_dynamics(known["q"], known["qd"], known["qdd"])
    assert tau.tolist() == known["tau"]


def test_every_kind_of_array_is_taken(random):
    arm = tribo.Arm.preset("panda")
    q = random.normal(size=(10, 7))
    wanted = arm.gravity(q)
    wide = np.zeros((10, 14))
    wide[:, ::2] = q
    for same in [q.tolist(), np.asfortranarray(q), wide[:, ::2]]:
        assert (arm.gravity(same) == wanted).all()
    assert (arm.gravity(q[3]) == wanted[3]).all()
    single = q.astype(np.float32)
    assert (arm.gravity(single) == arm.gravity(single.astype(float))).all()
    assert arm.gravity(np.zeros((0, 7))).shape == (0, 7)
    assert arm.gravity(np.zeros(7, dtype=int)).shape == (7,)


def test_wrong_arrays_are_told():
    arm = tribo.Arm.preset("panda")
    with pytest.raises(ValueError, match="q has 6 columns; the arm has 7 joints"):
        arm.gravity(np.zeros((5, 6)))
    with pytest.raises(ValueError, match=r"qd has shape \[4, 7\]; the first array has \[5, 7\]"):
        arm.bias(np.zeros((5, 7)), np.zeros((4, 7)))
    with pytest.raises(ValueError, match="q is no array of numbers"):
        arm.gravity(["a"] * 7)
    with pytest.raises(ValueError, match=r"allowed: \(n, joints\) or \(joints,\)"):
        arm.gravity(np.zeros((2, 2, 7)))
    with pytest.raises(ValueError, match="robot is pandda; allowed: panda"):
        tribo.Arm.preset("pandda")
    with pytest.raises(ValueError, match="no_such.urdf"):
        tribo.Arm.from_urdf("no_such.urdf")


def test_what_an_arm_says_of_itself():
    arm = tribo.Arm.preset("panda")
    assert (arm.name, arm.joints, arm.poses.shape) == ("panda", 7, (3, 7))
    limits = arm.limits
    assert set(limits) == {"q_min", "q_max", "qd_max", "tau_max", "tau_rate_max"}
    assert (limits["q_min"] < arm.poses[0]).all() and (arm.poses[0] < limits["q_max"]).all()
    assert repr(arm) == "Arm(panda, 7 joints)"
    assert tribo.Model.bare("panda").joint_names[0] == "joint_0"


def test_a_robot_comes_back_from_mjcf_and_urdf(tmp_path, random):
    compensator = tribo.tune(trials=1).compensator
    arm, q = tribo.Arm.preset("panda"), random.normal(size=(10, 7))
    for form, read in [("mjcf", tribo.Arm.from_mjcf), ("urdf", tribo.Arm.from_urdf)]:
        text, _ = compensator.export(form)
        path = tmp_path / f"panda.{form}"
        path.write_text(text)
        again = read(path)
        np.testing.assert_allclose(again.gravity(q), arm.gravity(q), atol=1e-9)
        np.testing.assert_allclose(again.pose(q), arm.pose(q), atol=1e-9)
    mass = tribo.Arm.from_mjcf(tmp_path / "panda.mjcf").mass_matrix(q)
    np.testing.assert_allclose(mass, arm.mass_matrix(q), atol=1e-9)
