"""Everything that libfranka's Python binding offers, against the server at question["host"]; prints what it saw."""
import json, math, sys
import pylibfranka as franka

question = json.load(open(sys.argv[1]))
robot = franka.Robot(question["host"], franka.RealtimeConfig.kIgnore)
seen = {}


def ends_with(action):
    try:
        action()
    except Exception as error:
        return str(error)
    return ""


def torques(ticks, tau):
    control = robot.start_torque_control()
    for tick in range(1, ticks + 1):
        state, _ = control.readOnce()
        command = franka.Torques(tau(tick, state))
        command.motion_finished = tick == ticks
        control.writeOnce(command)


def joints(ticks, position):
    control = robot.start_joint_position_control(franka.ControllerMode.JointImpedance)
    start = None
    for tick in range(1, ticks + 1):
        state, _ = control.readOnce()
        start = start or list(state.q_d)
        command = franka.JointPositions(position(tick, start))
        command.motion_finished = tick == ticks
        control.writeOnce(command)


robot.set_collision_behavior([40.0] * 7, [40.0] * 7, [60.0] * 6, [60.0] * 6)
robot.set_joint_impedance([3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0])
robot.set_cartesian_impedance([2000.0, 2000.0, 2000.0, 100.0, 100.0, 100.0])
identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1, 1.0]
robot.set_EE(identity)
robot.set_K(identity)
robot.set_load(0.2, [0.0, 0.0, 0.02], [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3])
state = robot.read_once()
seen["load"] = state.m_load
robot.set_load(0.0, [0.0, 0.0, 0.0], [0.0] * 9)

before = robot.read_once().q
torques(1000, lambda tick, state: [-4.0 * dq + (2.0 * math.sin(0.01 * tick) if j == 0 else 0.0) for j, dq in enumerate(state.dq)])
seen["torque"] = robot.read_once().q[0] - before[0]

before = robot.read_once().q
joints(1000, lambda tick, start: [q + (0.1 * (1.0 - math.cos(math.pi * tick / 1000)) if j == 3 else 0.0) for j, q in enumerate(start)])
seen["joint"] = robot.read_once().q[3] - before[3]

seen["jump"] = ends_with(lambda: torques(10, lambda tick, state: [40.0] * 7))
seen["mode"] = str(robot.read_once().robot_mode)
seen["refused"] = ends_with(lambda: torques(10, lambda tick, state: [0.0] * 7))
robot.automatic_error_recovery()
seen["recovered"] = str(robot.read_once().robot_mode)
robot.set_collision_behavior([0.5] * 7, [0.7] * 7, [90.0] * 6, [90.0] * 6)
seen["collision"] = ends_with(lambda: torques(400, lambda tick, state: [min(15.0, 0.5 * tick)] + [0.0] * 6))
robot.automatic_error_recovery()

model, state = robot.load_model(), robot.read_once()
seen["q"], seen["dq"] = list(state.q), list(state.dq)
seen["mass"] = list(model.mass(state))
seen["gravity"] = list(model.gravity(state))
seen["coriolis"] = list(model.coriolis(state))
seen["jacobian"] = list(model.zero_jacobian(state))

gripper = franka.Gripper(question["host"])
gripper.homing()
gripper.move(0.03, 0.1)
seen["width"] = gripper.read_once().width
print(json.dumps(seen))
