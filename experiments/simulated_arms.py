"""What arms of every physics engine share: how wrong their model is, how they move, how `tribo diagnose` is asked about them. Needs NumPy."""
import json, subprocess
import xml.etree.ElementTree as xml

import numpy as np

LINK_ERROR, OFFSET = (0.03, 0.05), 0.006
ENCODER_RAD, VELOCITY_RAD_S = 1e-5, 1e-3
SPEED_RAD_S, REACH_RAD = 0.8, 0.55
# Noise of the torque sensors over the joint's limit.
TORQUE_NOISE = 6e-4
READY = {
    "panda": [0, -0.785, 0, -2.356, 0, 1.571, 0.785],
    "ur5e": [-1.57, -1.57, 1.57, -1.57, -1.57, 0],
    "xarm7": [0, -0.247, 0, 0.909, 0, 1.156, 0],
    "iiwa14": [0, 0.785, 0, -1.571, 0, 0, 0],
    "xarm6": [0, -0.4, -0.8, 0, 1.0, 0],
    "ur10e": [-1.57, -1.57, 1.57, -1.57, -1.57, 0],
    "ur3e": [-1.57, -1.57, 1.57, -1.57, -1.57, 0],
    "kinova_gen3": [0, 0.4, 0, 1.6, 0, -0.9, 0],
}
TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


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


def body_of(link, mass, tensor):
    body = xml.SubElement(link, "inertial")
    xml.SubElement(body, "origin", xyz="0 0 0", rpy="0 0 0")
    xml.SubElement(body, "mass", value=repr(mass))
    xml.SubElement(body, "inertia", {key: repr(tensor if key[1] == key[2] else 0.0) for key in TENSOR})


def wrong_urdf(tribo, robot, payload, rng, directory):
    """The arm as it is, as URDF: every link is not what the model says; what it carries is a body of 5 cm radius of gyration 5 cm in front of the flange."""
    tree = xml.parse(exported(tribo, robot, "urdf", directory / f"{robot}.urdf"))
    error = lambda: float(rng.choice([-1, 1]) * rng.uniform(*LINK_ERROR))
    for link in tree.iter("link"):
        body = link.find("inertial")
        if body is None:
            # Bullet takes a link without a body for one of 1 kg.
            body_of(link, 1e-6, 1e-9)
            continue
        mass, inertia, origin = body.find("mass"), body.find("inertia"), body.find("origin")
        kilograms = float(mass.get("value"))
        radius = (sum(float(inertia.get(key)) for key in TENSOR[:3]) / 2 / kilograms) ** 0.5
        mass.set("value", repr(kilograms * (1 + error())))
        wrong = 1 + error()
        for key in TENSOR:
            inertia.set(key, repr(float(inertia.get(key)) * wrong))
        origin.set("xyz", " ".join(repr(float(x) + error() * radius) for x in origin.get("xyz").split()))
    if payload > 0:
        children = {joint.find("child").get("link") for joint in tree.iter("joint")}
        parents = {joint.find("parent").get("link") for joint in tree.iter("joint")}
        [tip] = children - parents
        body_of(xml.SubElement(tree.getroot(), "link", name="payload"), payload, payload * 0.05**2)
        joint = xml.SubElement(tree.getroot(), "joint", name="grasp", type="fixed")
        xml.SubElement(joint, "parent", link=tip)
        xml.SubElement(joint, "child", link="payload")
        xml.SubElement(joint, "origin", xyz="0 0 0.05", rpy="0 0 0")
    true = directory / f"{robot}_{payload:g}_true.urdf"
    tree.write(true)
    return true


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
