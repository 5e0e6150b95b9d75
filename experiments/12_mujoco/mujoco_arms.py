"""Arms that MuJoCo simulates, diagnosed by a `tribo` that knows them only from a model which is wrong everywhere.

usage: mujoco_arms.py TRIBO DIRECTORY [--arms panda,ur5e,xarm7,iiwa14] [--payloads 0,1] [--seeds 1,2] [--seconds 40,20] [--json]

For every arm, payload and seed: `tribo export` writes the arm as MJCF; every link is made wrong by 3 to 5 % (mass, inertia, centre of
mass over its gyration radius), dry and viscous friction by up to 20 %, every torque sensor gets an offset. MuJoCo plays two motions at
1 kHz under a computed torque, the second faster. `tribo diagnose` sees the first, holds its answer against the second, and knows
neither friction nor payload. Needs MuJoCo and NumPy.
"""
import argparse, json, pathlib, sys

import mujoco
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from simulated_arms import LINK_ERROR, OFFSET, diagnosed, exported, four_sines, seen, write_log

FRICTION_ERROR = 0.2


def inertia_of(model, body):
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    return turn.reshape(3, 3) @ np.diag(model.body_inertia[body]) @ turn.reshape(3, 3).T


def carry(model, mass):
    """Puts a body of 5 cm radius of gyration 5 cm in front of the flange."""
    body, com = model.nbody - 1, model.body_ipos[model.nbody - 1].copy()
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.site_quat[0])
    place = model.site_pos[0] + turn.reshape(3, 3) @ [0.0, 0.0, 0.05]
    both = (model.body_mass[body] * com + mass * place) / (model.body_mass[body] + mass)
    moved = lambda m, d: m * (d @ d * np.eye(3) - np.outer(d, d))
    inertia = inertia_of(model, body) + moved(model.body_mass[body], com - both) + moved(mass, place - both)
    size, axes = np.linalg.eigh(inertia + mass * 0.05**2 * np.eye(3))
    axes[:, 0] *= np.linalg.det(axes)
    turned = np.zeros(4)
    mujoco.mju_mat2Quat(turned, axes.flatten())
    model.body_mass[body] += mass
    model.body_ipos[body], model.body_inertia[body], model.body_iquat[body] = both, size, turned


def arm(path, payload, rng):
    """The arm as it is, and the offsets of its sensors."""
    model = mujoco.MjModel.from_xml_path(str(path))
    error = lambda: rng.choice([-1, 1]) * rng.uniform(*LINK_ERROR)
    for body in range(1, model.nbody):
        radius = np.sqrt(model.body_inertia[body].sum() / 2 / model.body_mass[body])
        model.body_mass[body] *= 1 + error()
        model.body_ipos[body] += [error() * radius for _ in range(3)]
        model.body_inertia[body] *= 1 + error()
    if payload > 0:
        carry(model, payload)
    for friction in (model.dof_frictionloss, model.dof_damping):
        friction *= 1 + rng.uniform(-FRICTION_ERROR, FRICTION_ERROR, model.nv)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model, OFFSET * model.actuator_ctrlrange[:, 1] * rng.uniform(-1, 1, model.nv)


def record(model, offset, seconds, faster, rng, path):
    """Four sines per joint about the ready pose, followed by a computed torque, as a log."""
    joints, limit = model.nv, model.actuator_ctrlrange[:, 1]
    ready, data, wanted = model.key_qpos[0], mujoco.MjData(model), mujoco.MjData(model)
    reference = four_sines(ready, model.jnt_range[:, 0], model.jnt_range[:, 1], faster, rng)
    mujoco.mj_resetData(model, data)
    data.qpos[:] = reference(0)[0]
    rows = []
    for k in range(int(seconds / model.opt.timestep)):
        t = k * model.opt.timestep
        q, qd, qdd = reference(t)
        wanted.qpos[:], wanted.qvel[:] = data.qpos, data.qvel
        wanted.qacc[:] = qdd + 100 * (q - data.qpos) + 20 * (qd - data.qvel)
        mujoco.mj_inverse(model, wanted)
        torque = np.clip(wanted.qfrc_inverse, -limit, limit)
        rows.append(seen(t, data.qpos, data.qvel, torque + offset, limit, rng))
        data.ctrl[:] = torque
        mujoco.mj_step(model, data)
    write_log(path, rows, joints)


def judged(tribo, robot, train, test):
    answer, _, found = diagnosed(tribo, robot, train, test)
    return found | {"leads": any("frictionloss" in note for note in answer["notes"])}


def main():
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("tribo")
    asked.add_argument("directory", type=pathlib.Path)
    asked.add_argument("--arms", default="panda,ur5e,xarm7,iiwa14")
    asked.add_argument("--payloads", default="0,1", help="kg")
    asked.add_argument("--seeds", default="1,2")
    asked.add_argument("--seconds", default="40,20", help="of the two motions")
    asked.add_argument("--json", action="store_true")
    asked = asked.parse_args()
    asked.directory.mkdir(parents=True, exist_ok=True)
    answers = []
    for robot in asked.arms.split(","):
        path = exported(asked.tribo, robot, "mjcf", asked.directory / f"{robot}.xml")
        for payload in map(float, asked.payloads.split(",")):
            for seed in map(int, asked.seeds.split(",")):
                rng = np.random.default_rng(seed)
                model, offset = arm(path, payload, rng)
                logs = [asked.directory / f"{robot}_{payload:g}_{seed}_{part}.csv" for part in ("train", "test")]
                for log, seconds, faster in zip(logs, map(float, asked.seconds.split(",")), (1.0, 1.6)):
                    record(model, offset, seconds, faster, rng, log)
                found = {"robot": robot, "truth_kg": payload, "seed": seed} | judged(asked.tribo, robot, *logs)
                answers.append(found)
                if not asked.json:
                    body = "no body" if found["payload_kg"] is None else f"{found['payload_kg']:.3f} kg"
                    print(f"| {robot} | {payload:g} | {seed} | {found['ratio']:.3f} | {found['worst_joint']:.2f} | {100 * found['inside95']:.1f} % "
                          f"| {body} | {', '.join(found['causes'])} |", flush=True)
    if asked.json:
        print(json.dumps(answers))


if __name__ == "__main__":
    main()
