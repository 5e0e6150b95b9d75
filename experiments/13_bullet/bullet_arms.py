"""Arms that Bullet simulates, whose joints stick, diagnosed by a `tribo` that knows them only from a model which is wrong everywhere.

usage: bullet_arms.py TRIBO DIRECTORY [--arms panda,ur5e,xarm7,iiwa14] [--payloads 0,1] [--seeds 1,2] [--seconds 40,20] [--gain 20] [--feed 0.7]

For every arm, payload and seed: `tribo export` writes the arm as URDF; every link is made wrong by 3 to 5 % (mass, inertia, centre of mass over
its gyration radius), every torque sensor gets an offset, every joint dry and viscous friction of .7 to 1.7 % of its torque limit. Bullet holds dry friction by a
constraint: a joint that stops sticks until more than that friction is asked for. It plays two motions at 1 kHz under a computed torque, the second faster.
`tribo diagnose` sees the first, holds its answer against the second, and knows neither friction nor payload. Needs PyBullet and NumPy.
"""
import argparse, pathlib, sys

import numpy as np
import pybullet as bullet

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from simulated_arms import OFFSET, READY, diagnosed, four_sines, seen, wrong_urdf, write_log

PERIOD_S = 1e-3
# Friction over the torque limit, and how much of dry friction varies from joint to joint.
DRY, VISCOUS, VARIES = 0.012, 0.012, 0.4


def opened(path):
    """The body and its joints, without any damping of Bullet's own."""
    bullet.resetSimulation()
    bullet.setGravity(0, 0, -9.81)
    bullet.setTimeStep(PERIOD_S)
    body = bullet.loadURDF(str(path), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE)
    links = range(bullet.getNumJoints(body))
    for link in range(-1, len(links)):
        bullet.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0)
    return body, [link for link in links if bullet.getJointInfo(body, link)[2] == bullet.JOINT_REVOLUTE]


def record(path, arm, control, seconds, faster, rng, out):
    """Four sines per joint about the ready pose, followed by a computed torque, as a log."""
    ready, dry, viscous, offset = arm["ready"], arm["dry"], arm["viscous"], arm["offset"]
    joints = len(ready)
    body, places = opened(path)
    for place, force in zip(places, dry):
        # A motor that asks for standstill with no more than this force is dry friction.
        bullet.setJointMotorControl2(body, place, bullet.VELOCITY_CONTROL, targetVelocity=0, force=force)
    reference = four_sines(ready, arm["lower"], arm["upper"], faster, rng)
    for place, angle in zip(places, reference(0)[0]):
        bullet.resetJointState(body, place, angle, 0)
    rows = []
    for k in range(int(seconds / PERIOD_S)):
        t = k * PERIOD_S
        states = bullet.getJointStates(body, places)
        q, qd = np.array([state[0] for state in states]), np.array([state[1] for state in states])
        wanted, wanted_rate, wanted_acceleration = reference(t)
        asked = wanted_acceleration + control.gain**2 * (wanted - q) + 2 * control.gain * (wanted_rate - qd)
        torque = np.array(bullet.calculateInverseDynamics(body, list(q), list(qd), list(asked)))
        torque = np.clip(torque + control.feed * dry * np.tanh(wanted_rate / 0.02) + viscous * qd, -arm["limit"], arm["limit"])
        rows.append(seen(t, q, qd, torque + offset, arm["limit"], rng))
        bullet.setJointMotorControlArray(body, places, bullet.TORQUE_CONTROL, forces=list(torque - viscous * qd))
        bullet.stepSimulation()
    write_log(out, rows, joints)


def main():
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("tribo")
    asked.add_argument("directory", type=pathlib.Path)
    asked.add_argument("--arms", default="panda,ur5e,xarm7,iiwa14")
    asked.add_argument("--payloads", default="0,1", help="kg")
    asked.add_argument("--seeds", default="1,2")
    asked.add_argument("--seconds", default="40,20", help="of the two motions")
    asked.add_argument("--gain", type=float, default=20, help="bandwidth of the controller (rad/s)")
    asked.add_argument("--feed", type=float, default=0.7, help="part of dry friction that the controller feeds forward")
    asked.add_argument("--keep", action="store_true", help="use logs that are there")
    asked = asked.parse_args()
    asked.directory.mkdir(parents=True, exist_ok=True)
    bullet.connect(bullet.DIRECT)
    for robot in asked.arms.split(","):
        for payload in map(float, asked.payloads.split(",")):
            for seed in map(int, asked.seeds.split(",")):
                rng = np.random.default_rng(seed)
                path = wrong_urdf(asked.tribo, robot, payload, rng, asked.directory)
                body, places = opened(path)
                lower, upper, limit = (np.array([bullet.getJointInfo(body, place)[i] for place in places]) for i in (8, 9, 10))
                drawn = lambda size: size * limit * (1 + rng.uniform(-VARIES, VARIES, len(places)))
                true = {"ready": np.array(READY[robot]), "lower": lower, "upper": upper, "limit": limit, "dry": drawn(DRY), "viscous": drawn(VISCOUS),
                        "offset": OFFSET * limit * rng.uniform(-1, 1, len(places))}
                logs = [asked.directory / f"{robot}_{payload:g}_{seed}_{part}.csv" for part in ("train", "test")]
                for log, seconds, faster in zip(logs, map(float, asked.seconds.split(",")), (1.0, 1.6)):
                    if not (asked.keep and log.exists()):
                        record(path, true, asked, seconds, faster, rng, log)
                answer, _, found = diagnosed(asked.tribo, robot, *logs, "--torque-side", "link")
                mass = "no body" if found["payload_kg"] is None else f"{found['payload_kg']:.3f} kg"
                print(f"| {robot} | {payload:g} | {seed} | {found['ratio']:.3f} | {found['worst_joint']:.2f} | {100 * found['inside95']:.1f} % | {mass} "
                      f"| {answer['sticks']} | {', '.join(found['causes'])} |", flush=True)


if __name__ == "__main__":
    main()
