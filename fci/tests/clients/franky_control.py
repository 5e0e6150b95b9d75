"""Motions planned by franky against the server at question["host"]; prints what it saw."""
import json, sys
import franky

question = json.load(open(sys.argv[1]))
robot = franky.Robot(question["host"], realtime_config=franky.RealtimeConfig.Ignore, relative_dynamics_factor=0.2)
seen = {}
robot.recover_from_errors()
robot.set_collision_behavior(40.0, 60.0)
robot.set_load(0.0, [0.0, 0.0, 0.0], [0.0] * 9)
goal = [0.2, -0.7, 0.1, -2.2, 0.1, 1.6, 0.8]
robot.move(franky.JointMotion(goal))
seen["joint_error"] = max(abs(a - b) for a, b in zip(robot.state.q, goal))
start = robot.current_cartesian_state.pose.end_effector_pose.translation
robot.move(franky.CartesianMotion(franky.Affine([0.05, 0.0, 0.05]), franky.ReferenceType.Relative))
end = robot.current_cartesian_state.pose.end_effector_pose.translation
seen["moved"] = sum((b - a) ** 2 for a, b in zip(start, end)) ** 0.5
robot.move(franky.JointVelocityMotion([0.1, 0, 0, 0, 0, 0, 0], duration=franky.Duration(500)))
robot.move(franky.CartesianVelocityMotion(franky.Twist([0.05, 0, 0]), duration=franky.Duration(500)))
robot.move(franky.JointMotion(goal))
robot.set_collision_behavior(0.3, 60.0)
try:
    robot.move(franky.JointMotion([0.6, -0.4, 0.1, -2.0, 0.1, 1.6, 0.8]))
    seen["collision"] = ""
except franky.ControlException as error:
    seen["collision"] = str(error)
seen["has_errors"] = robot.has_errors
robot.recover_from_errors()
robot.set_collision_behavior(40.0, 60.0)
robot.move(franky.JointMotion(goal))
model, state = robot.model, robot.state
seen["q"] = [float(x) for x in state.q]
seen["mass"] = [float(x) for row in model.mass(state) for x in row]
seen["gravity"] = [float(x) for x in model.gravity(state)]
print(json.dumps(seen))
