"""Robots that each hide one of two causes that look alike, asked by `tribo investigate` until the cause has one name.

usage: investigate_robots.py TRIBO DIRECTORY [--live] [--robots N] [--first SEED]

Each robot is a Panda with known friction and one hidden cause, drawn from its seed. With --live, `tribo serve --lockstep` is the
robot; without, `tribo simulate` through --robot-command. Prints one line per robot and the counts:

right              the strongest finding has the hidden cause's name (and joint, where it has one), and the verdict names it
confidently wrong  the verdict names another
undecided          the verdict is ambiguous, unknown or nothing missing
"""
import argparse, json, pathlib, random, subprocess, sys

FRICTION = [(0.60, 1.0), (0.90, 1.4), (0.55, 0.8), (0.80, 1.1), (0.40, 0.5), (0.30, 0.4), (0.35, 0.3)]
PAIRS = [("coulomb", "torque_offset"), ("payload", "link_inertial"), ("presliding", "stribeck"),
         ("position_spring", "link_inertial"), ("time_delay", "joint_elasticity"), ("torque_gain", "rotor_inertia")]


def hidden(rng, cause):
    joint = rng.randrange(7)
    size = 1.0 if joint < 4 else 0.5
    draw = rng.uniform
    return {
        "coulomb": {"joint": joint, "delta_coulomb_nm": size * draw(0.3, 0.7)},
        "torque_offset": {"joint": joint, "offset_nm": size * draw(0.3, 0.7)},
        "payload": {"mass_kg": draw(0.3, 1.0), "com_m": [draw(-0.02, 0.02), draw(-0.02, 0.02), draw(0.03, 0.1)]},
        "link_inertial": {"link": rng.randrange(2, 6), "delta_mass_kg": draw(0.3, 0.8),
                          "delta_first_moment_kg_m": [draw(-0.05, 0.05) for _ in range(3)]},
        "presliding": {"joint": joint, "presliding_distance_rad": draw(0.005, 0.02)},
        "stribeck": {"joint": joint, "breakaway_minus_coulomb_nm": size * draw(0.3, 0.7), "stribeck_velocity_rad_s": draw(0.02, 0.08)},
        "position_spring": {"joint": joint, "stiffness_nm_per_rad": size * draw(1.5, 4.0), "rest_rad": draw(-0.3, 0.3)},
        "time_delay": {"delay_s": draw(0.006, 0.015)},
        "joint_elasticity": {"joint": joint, "stiffness_nm_per_rad": draw(800.0, 2500.0), "damping_nm_s_per_rad": 2.0},
        "torque_gain": {"joint": rng.choice([1, 3]), "gain_error": rng.choice([-1, 1]) * draw(0.05, 0.12)},
        "rotor_inertia": {"joint": joint, "delta_rotor_inertia_kg_m2": draw(0.15, 0.4)},
    }[cause]


def model(cause=None, parameters=None):
    lines = ["schema: tribo.model/1", "robot: panda", "friction:", "  law: coulomb_viscous", "  joints:"]
    lines += [f"  - {{coulomb_nm: {c}, viscous_nm_s_per_rad: {v}}}" for c, v in FRICTION]
    if cause:
        lines += ["effects:", "- " + json.dumps({"cause": cause, **parameters})]
    return "\n".join(lines) + "\n"


def ask(tribo, at, live):
    common = ["--model", str(at / "known.yaml"), "--out", str(at / "asked"), "--json", "-q"]
    truth = str(at / "truth.yaml")
    if not live:
        command = f"'{tribo}' simulate --truth '{truth}' --trajectory {{trajectory}} --log {{log}} -q"
        return subprocess.run([tribo, "investigate", "--robot-command", command, *common], capture_output=True, text=True)
    server = subprocess.Popen([tribo, "serve", "--lockstep", "--port", "0", "--json", "-q", "--truth", truth],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        text = ""
        while not text.rstrip().endswith("}"):
            text += server.stdout.readline()
        host = f"127.0.0.1:{json.loads(text)['port']}"
        return subprocess.run([tribo, "investigate", "--live", host, "--yes", *common], capture_output=True, text=True)
    finally:
        server.kill()
        server.wait()


def main():
    options = argparse.ArgumentParser()
    options.add_argument("tribo")
    options.add_argument("directory", type=pathlib.Path)
    options.add_argument("--live", action="store_true")
    options.add_argument("--robots", type=int, default=60)
    options.add_argument("--first", type=int, default=1000)
    options = options.parse_args()
    counts = {"right": 0, "confidently wrong": 0, "undecided": 0, "failed": 0}
    for number in range(options.robots):
        rng = random.Random(options.first + number)
        pair = PAIRS[number % len(PAIRS)]
        cause = pair[(number // len(PAIRS)) % 2]
        parameters = hidden(rng, cause)
        at = options.directory / f"robot_{number:02}"
        at.mkdir(parents=True, exist_ok=True)
        (at / "known.yaml").write_text(model())
        (at / "truth.yaml").write_text(model(cause, parameters))
        run = ask(options.tribo, at.resolve(), options.live)
        if run.returncode != 0:
            result, told, motions = "failed", run.stderr.strip().splitlines()[-1:], 0
        else:
            answer = json.loads(run.stdout)
            found = answer["answer"]["findings"]
            motions, verdict = answer["motions"], answer["verdict"]
            told = [(f["label"], f.get("joint"), f.get("link")) for f in found]
            place = parameters.get("joint", parameters.get("link"))
            first = told[0] if told else (None, None, None)
            same = first[0] == cause and place in (None, first[1] if "joint" in parameters else first[2])
            result = "right" if same and verdict == "named" else "confidently wrong" if verdict == "named" else "undecided"
        counts[result] += 1
        print(f"{number:2} {cause:17} {parameters.get('joint', parameters.get('link', '-'))!s:2} {motions} motions  {result:17} {told[:4]}", flush=True)
    print(json.dumps(counts))


if __name__ == "__main__":
    sys.exit(main())
