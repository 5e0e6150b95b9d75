"""A robot driver and a user of its wrench on ROS 2 topics, on Cyclone DDS, the library under rmw_cyclonedds.

ros2_peer.py publish QUESTION    sends the rows of a canonical CSV as joint states, at the times of their stamps; prints what it sent
ros2_peer.py hear QUESTION       keeps wrenches, covariances and diagnostics until none comes any more; prints them

QUESTION is a JSON file: csv, rows, rate_hz, ready (a file that `hear` makes once it is connected), effort (false: none), velocity (false: none),
names (of the seven joints), extra (false: no fingers), added_nm (a torque that is added to the effort),
told (whether it is told on /tau_friction). Topics are those of `tribo listen` by default.
"""

import csv, json, os, sys, time
from dataclasses import dataclass

from cyclonedds.core import Listener, Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, byte, float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class Time_(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header_(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time_
    frame_id: str


@dataclass
class JointState_(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header_
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
class Vector3_(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Wrench_(IdlStruct, typename="geometry_msgs::msg::dds_::Wrench_"):
    force: Vector3_
    torque: Vector3_


@dataclass
class WrenchStamped_(IdlStruct, typename="geometry_msgs::msg::dds_::WrenchStamped_"):
    header: Header_
    wrench: Wrench_


@dataclass
class MultiArrayDimension_(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayDimension_"):
    label: str
    size: uint32
    stride: uint32


@dataclass
class MultiArrayLayout_(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayLayout_"):
    dim: sequence[MultiArrayDimension_]
    data_offset: uint32


@dataclass
class Float64MultiArray_(IdlStruct, typename="std_msgs::msg::dds_::Float64MultiArray_"):
    layout: MultiArrayLayout_
    data: sequence[float64]


@dataclass
class KeyValue_(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus_(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: byte
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue_]


@dataclass
class DiagnosticArray_(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header_
    status: sequence[DiagnosticStatus_]


RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(50_000), Policy.Durability.Volatile)
NS = 1_000_000_000
# A subscriber waits for this long after the last message.
PATIENCE_S = 3.0
CONNECTED_WITHIN_S = 120.0


def until(happened, what):
    end = time.monotonic() + CONNECTED_WITHIN_S
    while not happened():
        if time.monotonic() > end:
            sys.exit(f"never happened: {what}")
        time.sleep(0.01)


def publish(question):
    with open(question["csv"]) as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)][: question["rows"]]
    names, extra = question["names"], question["extra"]
    # As drivers do: in an order of their own, with joints beside them that are no arm's.
    order = list(range(len(names)))[::-1] if extra else list(range(len(names)))
    listed = (["a_finger_joint1"] if extra else []) + [names[j] for j in order]
    def entries(row, column):
        return ([0.02] if extra else []) + [row[f"{column}_{j}"] for j in order]

    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    monitor = DataReader(participant, Topic(participant, "rt/diagnostics", DiagnosticArray_), qos=RELIABLE)
    seen = {}

    # A writer may know of its reader before the reader knows of it, and what is written until then is lost.
    def listener_says(key, expected):
        for message in monitor.take(N=1000):
            for status in message.status:
                seen.update({pair.key: pair.value for pair in status.values})
        return seen.get(key) == expected

    writer = DataWriter(participant, Topic(participant, "rt/joint_states", JointState_), qos=RELIABLE)
    until(lambda: listener_says("publishers of joint states", "1"), "a subscriber of /joint_states")
    if question["ready"]:
        until(lambda: os.path.exists(question["ready"]), "a hearer of /wrench")
    added_nm = question.get("added_nm", 0.0)
    if question.get("told"):
        compensation = DataWriter(participant, Topic(participant, "rt/tau_friction", JointState_), qos=RELIABLE)
        until(lambda: listener_says("publishers of the compensation", "1"), "a subscriber of /tau_friction")
        compensation.write(JointState_(Header_(Time_(0, 0), ""), names, [], [], [added_nm] * len(names)))
        until(lambda: listener_says("compensation", "has come"), "a compensation that is heard")
    period_ns = round(NS / question["rate_hz"])
    start_ns = time.time_ns() + NS // 10
    late_ns = 0
    for k, row in enumerate(rows):
        stamp_ns = start_ns + k * period_ns
        wait_ns = stamp_ns - time.time_ns()
        if wait_ns > 0:
            time.sleep(wait_ns / NS)
        late_ns = max(late_ns, time.time_ns() - stamp_ns)
        writer.write(JointState_(
            Header_(Time_(stamp_ns // NS, stamp_ns % NS), ""), listed, entries(row, "q"),
            entries(row, "dq") if question["velocity"] else [], [tau + added_nm for tau in entries(row, "tau_J")] if question["effort"] else [],
        ))
    time.sleep(1.0)
    print(json.dumps({"sent": len(rows), "first_ns": start_ns, "latest_ms": late_ns / 1e6}))


def hear(question):
    heard, last = {"wrench": [], "covariance": [], "diagnostics": []}, [None]

    class Ear(Listener):
        def __init__(self, keep):
            super().__init__()
            self.keep = keep

        def on_data_available(self, reader):
            now_ns, last[0] = time.time_ns(), time.monotonic()
            for message in reader.take(N=1000):
                self.keep(message, now_ns)

    def stamp(header):
        return header.stamp.sec * NS + header.stamp.nanosec

    def wrench(message, now_ns):
        force, torque = message.wrench.force, message.wrench.torque
        values = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
        heard["wrench"].append([stamp(message.header), message.header.frame_id, values, now_ns])

    def covariance(message, now_ns):
        dimensions = [[dim.label, dim.size, dim.stride] for dim in message.layout.dim]
        heard["covariance"].append([dimensions, list(message.data)])

    def diagnostics(message, now_ns):
        for status in message.status:
            values = {pair.key: pair.value for pair in status.values}
            heard["diagnostics"].append({"level": status.level, "name": status.name, "message": status.message, "values": values})

    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    topics = [("rt/wrench", WrenchStamped_, wrench), ("rt/wrench/covariance", Float64MultiArray_, covariance),
              ("rt/diagnostics", DiagnosticArray_, diagnostics)]
    _readers = [DataReader(participant, Topic(participant, name, kind), qos=RELIABLE, listener=Ear(keep)) for name, kind, keep in topics]
    # The last reader hears, so the listener knows of those before it.
    until(lambda: heard["diagnostics"], "diagnostics")
    open(question["ready"], "w").close()
    # Diagnostics go on for as long as somebody listens; wrenches end with the joint states.
    until(lambda: heard["wrench"], "a wrench")
    count = -1
    while count != len(heard["wrench"]):
        count = len(heard["wrench"])
        time.sleep(PATIENCE_S)
    ages_ms = sorted((arrived - stamp_ns) / 1e6 for stamp_ns, _, _, arrived in heard["wrench"])
    heard["age_ms"] = {"p50": ages_ms[len(ages_ms) // 2], "p99": ages_ms[int(len(ages_ms) * 0.99)], "max": ages_ms[-1]}
    print(json.dumps(heard))


if __name__ == "__main__":
    with open(sys.argv[2]) as file:
        {"publish": publish, "hear": hear}[sys.argv[1]](json.load(file))
