"""What arms of every physics engine share: how wrong their model is, how they move, how `tribo diagnose` is asked about them. Needs NumPy."""
import json, subprocess

import numpy as np

LINK_ERROR, OFFSET = (0.03, 0.05), 0.006
ENCODER_RAD, VELOCITY_RAD_S = 1e-5, 1e-3
SPEED_RAD_S, REACH_RAD = 0.8, 0.55
# Noise of the torque sensors over the joint's limit.
TORQUE_NOISE = 6e-4


def four_sines(ready, lower, upper, faster, rng):
    """Position, velocity and acceleration at a time of four sines per joint about the ready pose, which begin within two seconds."""
    joints, room = len(ready), np.minimum(upper - ready, ready - lower)
    hz, phase = rng.uniform(0.05, 0.35, (4, joints)) * faster, rng.uniform(0, 2 * np.pi, (4, joints))
    size = rng.uniform(0.5, 1, (4, joints))
    size *= np.minimum(REACH_RAD, 0.8 * room) / size.sum(0)
    size /= np.maximum(1, (2 * np.pi * hz * size).sum(0) / SPEED_RAD_S)

    def reference(t):
        begun, angle, rate = min(1.0, t / 2), 2 * np.pi * hz * t + phase, 2 * np.pi * hz
        return (ready + begun * (size * np.sin(angle)).sum(0), begun * (size * rate * np.cos(angle)).sum(0),
                -begun * (size * rate**2 * np.sin(angle)).sum(0))

    return reference


def seen(t, q, qd, torque, limit, rng):
    """A row of the log: time, encoders, velocities and torque sensors with their noise."""
    joints = len(q)
    return np.concatenate([[t], q + rng.normal(0, ENCODER_RAD, joints), qd + rng.normal(0, VELOCITY_RAD_S, joints),
                           torque + rng.normal(0, TORQUE_NOISE * limit)])


def write_log(path, rows, joints):
    names = [f"{signal}_{joint}" for signal in ("q", "dq", "tau_J") for joint in range(joints)]
    np.savetxt(path, rows, delimiter=",", header="time," + ",".join(names), comments="", fmt="%.9g")


def exported(tribo, robot, form, path):
    """The arm as a file of another program."""
    subprocess.run([tribo, "export", "--robot", robot, "--format", form, "--out", str(path), "--quiet"], check=True)
    return path


def diagnosed(tribo, robot, train, test, *options):
    """The answer about one log, what it leaves of another over what the better plain fit does, and the bodies that it names."""
    asked = [tribo, "diagnose", str(train), "--robot", robot, *options, "--validate", str(test), "--json", "--quiet"]
    answer = json.loads(subprocess.run(asked, check=True, capture_output=True, text=True).stdout)
    held = answer["validation"][0]
    ours, plain, full = (np.array(held[key]) for key in ("after_nm", "plain_nm", "full_nm"))
    better = plain if (plain / full).mean() <= (full / plain).mean() else full
    bodies = [finding for finding in answer["findings"] if finding["cause"] == "payload"]
    return answer, bodies, {
        "ratio": float((ours / better).mean()),
        "worst_joint": float((ours / better).max()),
        "inside95": held["inside95"],
        "payload_kg": bodies[0]["params"]["mass_kg"] if bodies else None,
        "causes": sorted({finding["cause"] for finding in answer["findings"]}),
    }
