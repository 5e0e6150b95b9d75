"""Arms whose joints have everything at once, their dynamics by Pinocchio, diagnosed by a `tribo` that knows none of it.

usage: everything_arms.py TRIBO DIRECTORY [--seeds 1:29] [--keep]

The seed draws the arm, a payload of 0, .5 or 1 kg, the motion (four sines per joint, or point to point between seven poses with pauses, that again and
again), 100 to 1000 Hz, the resolution of the encoders, noise and low-pass filter of the torques, and whether these are those of the links or of motor currents,
whose gains are up to 5 % off. Every link is 3 to 5 % wrong, gravity half a degree. In every joint: bristles, a Stribeck peak, viscous friction that bends, friction
that differs by direction, goes with the load and with the angle, and falls as the joint warms up; rotors where torque is that of the motors. The second
motion is half as fast again, between other poses. Needs Pinocchio (`pin`) and NumPy.
"""
import argparse, pathlib, sys

import numpy as np
import pinocchio

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from simulated_arms import READY, diagnosed, four_sines, write_log, wrong_urdf

PERIOD_S = 5e-4
SECONDS = (40, 20)
BANDWIDTH_RAD_S, POSITION_NOISE_RAD = 20, 2e-6
PAUSE_S, SPEED_RAD_S, REACH_RAD = 0.5, 0.6, 0.7


def point_to_point(ready, lower, upper, faster, rng):
    """Seven poses about the ready pose again and again, quintic between them, with pauses."""
    room = np.minimum(upper - ready, ready - lower)
    poses = ready + rng.uniform(-1, 1, (7, len(ready))) * np.minimum(REACH_RAD, 0.8 * room)
    legs, begin = [], 0.0
    for start, end in zip(list(range(7)) * 20, (list(range(7)) * 20)[1:]):
        lasts = max(0.8, 1.875 * np.abs(poses[end] - poses[start]).max() / (SPEED_RAD_S * faster))
        legs.append((begin, lasts, poses[start], poses[end]))
        begin += lasts + PAUSE_S
    begins = np.array([leg[0] for leg in legs])

    def reference(t):
        begin, lasts, start, end = legs[max(0, int(np.searchsorted(begins, t, side="right")) - 1)]
        s, way = min(1, (t - begin) / lasts), end - start
        if s >= 1:
            return end, 0 * way, 0 * way
        return (start + way * (10 * s**3 - 15 * s**4 + 6 * s**5), way * (30 * s**2 - 60 * s**3 + 30 * s**4) / lasts,
                way * (60 * s - 180 * s**2 + 120 * s**3) / lasts**2)

    return reference


def draw(model, ready, rng):
    """Joints and sensors; friction over the torque limit, more of it behind a motor than behind a sensor at the link."""
    joints, limit = model.nv, model.effortLimit.copy()
    within = lambda low, high: rng.uniform(low, high, joints)
    now_and_then = lambda share, high: within(0, high) * (rng.random(joints) < share)
    motor = bool(rng.integers(2))
    rate, motion = int(rng.choice([100, 125, 250, 500, 1000])), ("sines", "point to point")[rng.integers(2)]
    dry = (within(0.02, 0.06) if motor else within(0.005, 0.02)) * limit
    return {
        "motor": motor, "rate": rate, "motion": motion, "limit": limit, "dry": dry,
        "viscous": (within(0.02, 0.08) if motor else within(0.005, 0.02)) * limit,
        "load": now_and_then(0.5, 0.08) if motor else now_and_then(0.3, 0.03),
        "ripple": within(0, 0.08) * dry, "waves": rng.integers(2, 6, joints), "phase": within(0, 6.28),
        "peak": within(1.0, 1.5), "peak_rad_s": within(0.01, 0.06), "power": within(0.6, 1.0),
        "asymmetry": within(-0.1, 0.1), "bristle_rad": within(2e-4, 2e-3), "warm": within(0, 0.12), "warm_s": rng.uniform(30, 200),
        "rotor": within(0, 0.002) * limit if motor else np.zeros(joints),
        "gain": 1 + (within(-0.05, 0.05) if motor else within(-0.01, 0.01)), "offset": within(-0.01, 0.01) * limit,
        "tilt": rng.normal(0, 0.005, 2), "noise": rng.choice([2e-4, 6e-4, 2e-3]) * limit,
        "resolution": 2 * np.pi / 2 ** rng.choice([16, 18, 20]), "filter_hz": float(rng.choice([0, 30, 60])),
        "lower": np.maximum(model.lowerPositionLimit, ready - 3), "upper": np.minimum(model.upperPositionLimit, ready + 3),
    }


def friction(arm, q, qd, weight, bristle, t):
    """Torque of the joints, stiffness of their bristles as damping over one period, and the bristles after it."""
    slide = np.abs(qd)
    dry = (arm["dry"] + arm["load"] * np.abs(weight)) * (1 - arm["warm"] * (1 - np.exp(-t / arm["warm_s"]))) * (1 + arm["asymmetry"] * np.sign(qd))
    dry = dry * (1 + (arm["peak"] - 1) * np.exp(-(qd / arm["peak_rad_s"]) ** 2))
    end = np.where(slide > 1e-12, np.sign(qd), bristle)
    bristle = end + (bristle - end) * np.exp(-slide * PERIOD_S / arm["bristle_rad"])
    torque = dry * bristle + arm["viscous"] * np.sign(qd) * slide ** arm["power"] + arm["ripple"] * np.sin(arm["waves"] * q + arm["phase"])
    damping = dry / arm["bristle_rad"] * PERIOD_S * np.clip(1 - np.sign(qd) * bristle, 0, 2)
    return torque, damping + arm["viscous"] * np.maximum(slide, 1e-3) ** (arm["power"] - 1), bristle


def record(model, arm, ready, seconds, faster, warm_s, rng, out):
    """A motion under a computed torque that knows .8 of the dry friction, as a log; joints have worked for `warm_s` seconds."""
    data, joints = model.createData(), model.nv
    model.gravity.linear = np.array([9.81 * arm["tilt"][0], 9.81 * arm["tilt"][1], -9.81])
    reference = (four_sines if arm["motion"] == "sines" else point_to_point)(ready, arm["lower"], arm["upper"], faster, rng)
    q, qd, bristle, smooth, seen_before = reference(0)[0].copy(), np.zeros(joints), np.zeros(joints), None, None
    share, every, rows = 1 - np.exp(-2 * np.pi * arm["filter_hz"] * PERIOD_S), round(1 / (arm["rate"] * PERIOD_S)), []
    for k in range(int(seconds / PERIOD_S)):
        t = k * PERIOD_S
        wanted, wanted_rate, wanted_acceleration = reference(t)
        upper = np.triu(pinocchio.crba(model, data, q))
        inertia = upper + np.triu(upper, 1).T + np.diag(arm["rotor"])
        bias = pinocchio.nonLinearEffects(model, data, q, qd)
        lost, damping, bristle = friction(arm, q, qd, bias, bristle, t + warm_s)
        asked = wanted_acceleration + BANDWIDTH_RAD_S**2 * (wanted - q) + 2 * BANDWIDTH_RAD_S * (wanted_rate - qd)
        torque = inertia @ asked + bias + 0.8 * arm["dry"] * np.tanh(wanted_rate / 0.02) + arm["viscous"] * wanted_rate
        torque = np.clip(torque, -2 * arm["limit"], 2 * arm["limit"])
        if k % every == 0:
            seen = np.round((q + rng.normal(0, POSITION_NOISE_RAD, joints)) / arm["resolution"]) * arm["resolution"]
            rate = 0 * qd if seen_before is None else (seen - seen_before) * arm["rate"]
            measured = torque if smooth is None else smooth
            rows.append(np.concatenate([[t], seen, rate, measured * arm["gain"] + arm["offset"] + rng.normal(0, arm["noise"])]))
            seen_before = seen
        if arm["filter_hz"] > 0:
            smooth = torque if smooth is None else smooth + (torque - smooth) * share
        # Implicit in the velocity: bristles are stiff.
        qd = qd + np.linalg.solve(inertia + PERIOD_S * np.diag(damping), PERIOD_S * (torque - bias - lost))
        q = q + PERIOD_S * qd
    write_log(out, rows, joints)


def main():
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("tribo")
    asked.add_argument("directory", type=pathlib.Path)
    asked.add_argument("--seeds", default="1:29", help="first and the one after the last")
    asked.add_argument("--keep", action="store_true", help="use logs that are there")
    asked = asked.parse_args()
    all_found = []
    for seed in range(*map(int, asked.seeds.split(":"))):
        rng = np.random.default_rng(seed)
        robot, payload = list(READY)[seed % len(READY)], float([0, 0, 1, 0.5][rng.integers(4)])
        directory = asked.directory / str(seed)
        directory.mkdir(parents=True, exist_ok=True)
        model = pinocchio.buildModelFromUrdf(str(wrong_urdf(asked.tribo, robot, payload, rng, directory)))
        ready = np.array(READY[robot], float)
        arm = draw(model, ready, rng)
        logs = [directory / f"{part}.csv" for part in ("train", "test")]
        for log, seconds, faster, warm_s in zip(logs, SECONDS, (1.0, 1.5), (0, SECONDS[0])):
            if not (asked.keep and log.exists()):
                record(model, arm, ready, seconds, faster, warm_s, rng, log)
        answer, bodies, found = diagnosed(asked.tribo, robot, *logs, "--torque-side", "motor" if arm["motor"] else "link")
        all_found.append(found)
        mass = "none"
        if bodies:
            low, high = bodies[0]["params_ci95"]["mass_kg"]
            mass = f"{found['payload_kg']:.2f} [{low:.2f}, {high:.2f}]" + (", not sure" if bodies[0]["alternatives"] else "")
        print(f"| {seed} | {robot} | {'motor' if arm['motor'] else 'link'} | {arm['motion']} | {arm['rate']} | {found['ratio']:.2f} | {found['worst_joint']:.2f} "
              f"| {100 * found['inside95']:.0f} % | {payload:g} | {mass} | {len(answer['findings'])} |", flush=True)
    ratios, inside = (np.array([found[key] for found in all_found]) for key in ("ratio", "inside95"))
    print(f"ratio: mean {ratios.mean():.3f}, worst {ratios.max():.2f}; inside: mean {100 * inside.mean():.1f} %, between {100 * inside.min():.0f} and {100 * inside.max():.0f} %")


if __name__ == "__main__":
    main()
