"""Straight-line C for one arm, by CasADi: generated.py INPUTS OUT writes OUT/generated.c for the arm of INPUTS/arm.txt.

The recursive algorithms in link frames as expressions of numbers and joint angles: zeros and ones fold away, what is computed twice is
computed once, and each term takes the way with the fewest operations that we know. Prints the operations of each function.
"""
import sys
from pathlib import Path

import casadi as ca

SX = ca.SX
JOINTS = 7


def sparse(rows, columns, values):
    """A matrix, row by row, in which zeros are structural."""
    matrix = SX(rows, columns)
    for i, value in enumerate(values):
        if value != 0.0:
            matrix[i // columns, i % columns] = value
    return matrix


def read_arm(path):
    numbers = iter(map(float, path.read_text().split()))
    take = lambda rows, columns: sparse(rows, columns, [next(numbers) for _ in range(rows * columns)])
    links = [dict(rotation=take(3, 3), p=take(3, 1), mass=next(numbers), com=take(3, 1), inertia=take(3, 3)) for _ in range(JOINTS)]
    return links, take(3, 3), take(3, 1), take(3, 1)


LINKS, FLANGE_ROTATION, FLANGE_P, GRAVITY = read_arm(Path(sys.argv[1]) / "arm.txt")
Z = sparse(3, 1, [0.0, 0.0, 1.0])
q, qd, qdd = SX.sym("q", JOINTS), SX.sym("qd", JOINTS), SX.sym("qdd", JOINTS)


def turned(rotation, angle):
    s, c = ca.sin(angle), ca.cos(angle)
    about_z = SX(3, 3)
    about_z[0, 0], about_z[0, 1], about_z[1, 0], about_z[1, 1], about_z[2, 2] = c, -s, s, c, 1
    return rotation @ about_z


TURNS = [turned(link["rotation"], q[k]) for k, link in enumerate(LINKS)]


def newton_euler(qd, qdd, acceleration):
    """Torque, and ω, ω̇, a of the last link in its axes."""
    w, dw, a = SX(3, 1), SX(3, 1), acceleration
    forces, moments, torque = [], [], SX(JOINTS, 1)
    for k, link in enumerate(LINKS):
        back = TURNS[k].T
        a = back @ (a + ca.cross(dw, link["p"]) + ca.cross(w, ca.cross(w, link["p"])))
        w = back @ w
        dw = back @ dw + ca.cross(w, Z * qd[k]) + Z * qdd[k]
        w = w + Z * qd[k]
        com, inertia = link["com"], link["inertia"]
        force = (a + ca.cross(dw, com) + ca.cross(w, ca.cross(w, com))) * link["mass"]
        forces.append(force)
        moments.append(inertia @ dw + ca.cross(w, inertia @ w) + ca.cross(com, force))
    for k in reversed(range(JOINTS)):
        torque[k] = moments[k][2]
        if k:
            force = TURNS[k] @ forces[k]
            forces[k - 1] += force
            moments[k - 1] += TURNS[k] @ moments[k] + ca.cross(LINKS[k]["p"], force)
    return torque, (w, dw, a)


def composites():
    """Mass matrix, and first moment of everything outboard of each joint in the axes of its link."""
    masses = [link["mass"] for link in LINKS]
    moments = [link["mass"] * link["com"] for link in LINKS]
    steiner = lambda m, c: m * (ca.dot(c, c) * SX.eye(3) - c @ c.T)
    inertias = [link["inertia"] + steiner(link["mass"], link["com"]) for link in LINKS]
    matrix = SX(JOINTS, JOINTS)
    for k in reversed(range(JOINTS)):
        force, moment = ca.cross(Z, moments[k]), inertias[k][:, 2]
        matrix[k, k] = moment[2]
        for i in range(k, 0, -1):
            force = TURNS[i] @ force
            moment = TURNS[i] @ moment + ca.cross(LINKS[i]["p"], force)
            matrix[i - 1, k] = matrix[k, i - 1] = moment[2]
        if k:
            p, h = LINKS[k]["p"], TURNS[k] @ moments[k]
            u = h + p * (0.5 * masses[k])
            inertias[k - 1] += TURNS[k] @ inertias[k] @ TURNS[k].T + 2 * ca.dot(p, u) * SX.eye(3) - p @ u.T - u @ p.T
            moments[k - 1] += h + p * masses[k]
            masses[k - 1] += masses[k]
    return matrix, moments


def weights(moments):
    torque, gravity = SX(JOINTS, 1), GRAVITY
    for k in range(JOINTS):
        gravity = TURNS[k].T @ gravity
        torque[k] = -ca.cross(moments[k], gravity)[2]
    return torque


def frames():
    """Rotation and origin of the flange, Jacobian."""
    rotation, origin, axes, origins = SX.eye(3), SX(3, 1), [], []
    for k, link in enumerate(LINKS):
        origin = origin + rotation @ link["p"]
        rotation = rotation @ TURNS[k]
        axes.append(rotation[:, 2])
        origins.append(origin)
    flange = origin + rotation @ FLANGE_P
    columns = [ca.vertcat(z, ca.cross(z, flange - o)) for z, o in zip(axes, origins)]
    return rotation, flange, ca.horzcat(*columns)


def main():
    none = SX(JOINTS, 1)
    matrix, moments = composites()
    last, flange, jacobian = frames()
    coriolis, (w, dw, a) = newton_euler(qd, none, SX(3, 1))
    drift = ca.vertcat(last @ dw, last @ (a + ca.cross(dw, FLANGE_P) + ca.cross(w, ca.cross(w, FLANGE_P))))
    frame = [last @ FLANGE_ROTATION, flange, jacobian, drift]
    functions = {
        "generated_rnea": ([q, qd, qdd], [newton_euler(qd, qdd, -GRAVITY)[0]]),
        "generated_crba": ([q], [matrix]),
        "generated_jacobian_drift": ([q, qd], frame),
        "generated_control_terms": ([q, qd], frame + [matrix, coriolis, weights(moments)]),
    }
    source = ca.CodeGenerator("generated.c")
    for name, (inputs, outputs) in functions.items():
        function = ca.Function(name, inputs, ca.cse([ca.densify(output) for output in outputs]))
        operations = [function.instruction_id(i) for i in range(function.n_instructions())]
        moved = (ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT)
        print(name, "operations", sum(operation not in moved for operation in operations))
        source.add(function)
    source.generate(sys.argv[2] + "/")


main()
