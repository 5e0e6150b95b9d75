"""panda-python (libfranka 0.9) against the server at question["host"]; prints what it saw."""
import json, sys
import panda_py
from panda_py import controllers, libfranka

question = json.load(open(sys.argv[1]))
panda = panda_py.Panda(question["host"])
robot = panda.get_robot()
seen = {}
panda.set_default_behavior()
goal = [0.1, -0.7, 0.1, -2.2, 0.1, 1.6, 0.8]
panda.move_to_joint_position(goal)
seen["joint_error"] = max(abs(a - b) for a, b in zip(panda.q, goal))
pose = panda.get_pose()
pose[2, 3] += 0.05
panda.move_to_pose(pose)
seen["height_error"] = abs(panda.get_position()[2] - pose[2, 3])
control = controllers.CartesianImpedance(filter_coeff=1.0)
position, orientation = panda.get_position(), panda.get_orientation()
panda.start_controller(control)
with panda.create_context(frequency=1e3, max_runtime=1.0) as context:
    while context.ok():
        control.set_control([position[0], position[1] + 0.02, position[2]], orientation)
panda.stop_controller()
seen["sideways"] = panda.get_position()[1] - position[1]

robot.set_load(0.3, [0.0, 0.0, 0.05], [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3])
robot.set_ee([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1, 1.0])


def push(thresholds):
    robot.set_collision_behavior(thresholds, thresholds, [90.0] * 6, [90.0] * 6)
    ticks = 0

    def tau(state, period):
        nonlocal ticks
        ticks += 1
        torques = libfranka.Torques([min(12.0, 0.2 * ticks)] + [-5.0 * dq for dq in state.dq[1:]])
        torques.motion_finished = ticks == 200
        return torques

    try:
        robot.control(tau)
    except Exception as error:
        return str(error)
    return ""


seen["push"] = push([60.0] * 7)
seen["collision"] = push([0.5] * 7)
seen["refused"] = push([60.0] * 7)
panda.recover()
seen["recovered"] = push([60.0] * 7)

model, state = panda.get_model(), panda.get_state()
state = robot.read_once()
q, dq = goal, [0.3, -0.2, 0.4, 0.1, -0.5, 0.6, -0.7]
load = ([1e-3, 2e-4, 0.0, 2e-4, 2e-3, 1e-4, 0.0, 1e-4, 3e-3], 1.3, [0.01, -0.02, 0.06])
frame = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.02, 0.03, 0.1, 1.0]
unit = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
seen["q"], seen["dq"], seen["load"], seen["frame"] = q, dq, load, frame
seen["mass"] = list(model.mass(q, *load))
seen["coriolis"] = list(model.coriolis(q, dq, *load))
seen["gravity"] = list(model.gravity(q, load[1], load[2], [0.0, 0.0, -9.81]))
frames = [libfranka.Frame.kJoint1, libfranka.Frame.kJoint2, libfranka.Frame.kJoint4, libfranka.Frame.kJoint7, libfranka.Frame.kFlange, libfranka.Frame.kEndEffector]
seen["poses"] = [list(model.pose(f, q, frame, unit)) for f in frames]
seen["zero_jacobians"] = [list(model.zero_jacobian(f, q, frame, unit)) for f in frames]
seen["body_jacobians"] = [list(model.body_jacobian(f, q, frame, unit)) for f in frames] if hasattr(model, "body_jacobian") else []
print(json.dumps(seen))
