"""Arms as a factory has them, simulated by MuJoCo: programmes from point to point with pauses, repeated cycles, drives whose gain nobody calibrated,
slow and coarse loggers, friction that bends with speed and goes with the load.

usage: factory_arms.py TRIBO DIRECTORY [--arms ur5e,xarm6,kinova_gen3,ur10e,panda,iiwa14] [--seeds 1,2,3,4] [--json]

Links, friction and offsets are wrong as in `mujoco_arms.py`. By the seed, and for all joints: motion (point to point, the same path faster, sines),
rate (30 to 1000 Hz), velocities logged or not, noise and resolution of the torques, payload; and for each joint: drive gain (up to 16 % off), Stribeck
friction, friction that bends, friction with the load, friction that differs by direction. `tribo diagnose` sees the first motion and holds its answer
against the second, which is half as fast again. Needs MuJoCo and NumPy.
"""
import argparse, json, pathlib

import mujoco
import numpy as np

from mujoco_arms import arm, diagnosed, exported
from simulated_arms import ENCODER_RAD, VELOCITY_RAD_S

REACH_RAD, PAUSE_S, SMOOTH_S = 0.7, (0.5, 0.3), 0.04
SPEED_RAD_S, ACCELERATION_RAD_S2 = (0.6, 0.9), (2.0, 3.0)


def point_to_point(model, points, part, cycles):
    """Trapezoids of speed from point to point, smoothed, with a pause at each."""
    dt, speed, acceleration = model.opt.timestep, SPEED_RAD_S[part], ACCELERATION_RAD_S2[part]
    path = [np.repeat(points[:1], int(1.0 / dt), 0)]
    for _ in range(cycles):
        for start, end in zip(points, np.roll(points, -1, 0)):
            far = np.abs(end - start).max()
            ramp_s = min(speed / acceleration, np.sqrt(far / acceleration))
            whole_s = ramp_s + far / (acceleration * ramp_s)
            t, ramp = np.arange(0, whole_s, dt) / whole_s, ramp_s / whole_s
            rising, falling = t**2 / (2 * ramp), 1 - ramp - (1 - t) ** 2 / (2 * ramp)
            share = np.where(t < ramp, rising, np.where(t < 1 - ramp, t - ramp / 2, falling)) / (1 - ramp)
            path += [start + share[:, None] * (end - start), np.repeat(end[None], int(PAUSE_S[part] / dt), 0)]
    q, width = np.concatenate(path), int(SMOOTH_S / dt)
    q = np.concatenate([np.repeat(q[:1], width, 0), q, np.repeat(q[-1:], width, 0)])
    for _ in range(2):
        q = np.stack([np.convolve(column, np.ones(width) / width, "same") for column in q.T], 1)
    q = q[width:-width]
    qd = np.gradient(q, dt, axis=0)
    return q, qd, np.gradient(qd, dt, axis=0)


def sines(model, part, rng):
    """Four sines per joint about the ready pose."""
    joints, ready, seconds, faster = model.nv, model.key_qpos[0], (40, 20)[part], (1.0, 1.5)[part]
    room = np.minimum(model.jnt_range[:, 1] - ready, ready - model.jnt_range[:, 0])
    hz, phase = rng.uniform(0.05, 0.35, (4, joints)) * faster, rng.uniform(0, 2 * np.pi, (4, joints))
    size = rng.uniform(0.5, 1, (4, joints))
    size *= np.minimum(REACH_RAD, 0.8 * room) / size.sum(0)
    size /= np.maximum(1, (2 * np.pi * hz * size).sum(0) / SPEED_RAD_S[1])
    t = np.arange(0, seconds, model.opt.timestep)[:, None, None]
    begun, rate = np.minimum(1, t[:, 0] / 2), 2 * np.pi * hz
    angle = rate * t + phase
    return (ready + begun * (size * np.sin(angle)).sum(1), begun * (size * rate * np.cos(angle)).sum(1),
            -begun * (size * rate**2 * np.sin(angle)).sum(1))


def record(model, motion, truth, rng, path):
    """Plays a motion under a computed torque, and logs what the drives say of it."""
    joints, limit, loss = model.nv, model.actuator_ctrlrange[:, 1], model.dof_frictionloss.copy()
    data, wanted, rows = mujoco.MjData(model), mujoco.MjData(model), []
    every = round(1 / model.opt.timestep / truth["rate_hz"])
    data.qpos[:] = motion[0][0]
    for k, (q, qd, qdd) in enumerate(zip(*motion)):
        wanted.qpos[:], wanted.qvel[:] = data.qpos, data.qvel
        wanted.qacc[:] = qdd + 100 * (q - data.qpos) + 20 * (qd - data.qvel)
        mujoco.mj_inverse(model, wanted)
        torque = np.clip(wanted.qfrc_inverse, -limit, limit)
        speed = np.abs(data.qvel)
        bump = truth["stribeck"] * np.exp(-((speed / truth["stribeck_rad_s"]) ** 2)) + truth["bend"] * speed / (speed + 0.5)
        one_way = 1 + truth["asymmetry"] * np.sign(data.qvel)
        model.dof_frictionloss[:] = (loss * (1 + bump) + truth["load"] * np.abs(data.qfrc_bias)) * one_way
        if k % every == 0:
            seen = (torque + truth["offset"]) * truth["gain"] + rng.normal(0, truth["noise"] * limit)
            if truth["resolution"] > 0:
                seen = np.round(seen / (truth["resolution"] * limit)) * truth["resolution"] * limit
            q_seen, qd_seen = data.qpos + rng.normal(0, ENCODER_RAD, joints), data.qvel + rng.normal(0, VELOCITY_RAD_S, joints)
            rows.append(np.concatenate([[k * model.opt.timestep], q_seen, *([qd_seen] if truth["velocities"] else []), seen]))
        data.ctrl[:] = torque
        mujoco.mj_step(model, data)
    model.dof_frictionloss[:] = loss
    signals = ("q", "dq", "tau_J") if truth["velocities"] else ("q", "tau_J")
    names = [f"{signal}_{joint}" for signal in signals for joint in range(joints)]
    np.savetxt(path, rows, delimiter=",", header="time," + ",".join(names), comments="", fmt="%.9g")


def draw(model, offset, payload, rng):
    """What this robot is like beside its wrong links."""
    joints = model.nv
    now_and_then = lambda chance, low, high: (rng.random() < chance) * rng.uniform(low, high, joints)
    return {
        "kind": ("point to point", "cycle", "sines", "point to point")[rng.integers(4)],
        "rate_hz": (30, 50, 125, 250, 500, 1000)[rng.integers(6)],
        "velocities": bool(rng.random() < 0.7),
        "payload_kg": payload,
        "offset": offset,
        "gain": 1 + now_and_then(0.6, -0.1, 0.1) + (rng.random() < 0.5) * rng.uniform(-0.06, 0.06),
        "noise": (3e-4, 1e-3, 4e-3)[rng.integers(3)],
        "resolution": (rng.random() < 0.4) * (5e-4, 2e-3)[rng.integers(2)],
        "stribeck": now_and_then(0.5, 0.1, 0.8),
        "stribeck_rad_s": rng.uniform(0.02, 0.15, joints),
        "bend": now_and_then(0.4, 0.2, 0.8),
        "load": now_and_then(0.4, 0.01, 0.08),
        "asymmetry": now_and_then(0.3, -0.15, 0.15),
    }


def judged(tribo, robot, train, test):
    answer, bodies, found = diagnosed(tribo, robot, train, test)
    return found | {
        "payload_ci95": bodies[0]["params_ci95"]["mass_kg"] if bodies else None,
        "sure": not (bodies and bodies[0]["alternatives"]),
        "findings": len(answer["findings"]),
    }


def main():
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("tribo")
    asked.add_argument("directory", type=pathlib.Path)
    asked.add_argument("--arms", default="ur5e,xarm6,kinova_gen3,ur10e,panda,iiwa14")
    asked.add_argument("--seeds", default="1,2,3,4")
    asked.add_argument("--json", action="store_true")
    asked = asked.parse_args()
    asked.directory.mkdir(parents=True, exist_ok=True)
    answers = []
    for robot in asked.arms.split(","):
        path = exported(asked.tribo, robot, "mjcf", asked.directory / f"{robot}.xml")
        for seed in map(int, asked.seeds.split(",")):
            rng = np.random.default_rng([seed, *robot.encode()])
            payload = (0.0, 0.0, 0.5, 1.5)[rng.integers(4)]
            model, offset = arm(path, payload, rng)
            truth = draw(model, offset, payload, rng)
            ready = model.key_qpos[0]
            room = np.minimum(REACH_RAD, 0.8 * np.minimum(model.jnt_range[:, 1] - ready, ready - model.jnt_range[:, 0]))
            points = [ready + rng.uniform(-1, 1, (7, model.nv)) * room for _ in range(2)]
            logs = [asked.directory / f"{robot}_{seed}_{part}.csv" for part in ("train", "test")]
            for part, log in enumerate(logs):
                if truth["kind"] == "sines":
                    motion = sines(model, part, rng)
                else:
                    cycle = truth["kind"] == "cycle"
                    motion = point_to_point(model, points[0 if cycle else part], part, 3 if cycle and part == 0 else 2)
                record(model, motion, truth, rng, log)
            found = {"robot": robot, "seed": seed, "motion": truth["kind"], "rate_hz": truth["rate_hz"], "truth_kg": payload,
                     "gains": truth["gain"].round(3).tolist()} | judged(asked.tribo, robot, *logs)
            answers.append(found)
            if not asked.json:
                low, high = found["payload_ci95"] or (0, 0)
                body = "none" if found["payload_kg"] is None else f"{found['payload_kg']:.2f} [{low:.2f}, {high:.2f}]"
                doubt = "" if found["sure"] else ", not sure"
                print(f"| {robot} | {truth['kind']} | {truth['rate_hz']} | {found['ratio']:.2f} | {found['worst_joint']:.2f} "
                      f"| {100 * found['inside95']:.0f} % | {payload:g} | {body}{doubt} | {found['findings']} |", flush=True)
    if asked.json:
        print(json.dumps(answers))
    else:
        ratios = [found["ratio"] for found in answers]
        print(f"ratio: mean {np.mean(ratios):.3f}, worst {max(ratios):.2f}")


if __name__ == "__main__":
    main()
