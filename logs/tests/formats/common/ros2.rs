//! A small recorder: messages of ROS 2 in CDR, written field by field as the standard has it, and MCAP files of them.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;

use mcap::{Channel, Compression, Message, Schema, WriteOptions};

/// Definitions as rosbag2 stores them.
pub const JOINT_STATE: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
    ================================================================================\n\
    MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// The fields of `franka_msgs/FrankaRobotState` up to the wrenches, its end, and a head that versions differ in.
pub fn franka_robot_state(head: &str) -> String {
    let line = "=".repeat(80);
    format!(
        "std_msgs/Header header\n{head}CollisionIndicators collision_indicators\n# measured\n\
         sensor_msgs/JointState measured_joint_state\nsensor_msgs/JointState desired_joint_state\n\
         sensor_msgs/JointState measured_joint_motor_state\nfloat64[7] ddq_d\nfloat64[7] dtau_j\n\
         sensor_msgs/JointState tau_ext_hat_filtered\nElbow elbow\ngeometry_msgs/WrenchStamped k_f_ext_hat_k\n\
         geometry_msgs/WrenchStamped o_f_ext_hat_k\nfloat64 time\nfloat64 control_command_success_rate\n\
         uint8 ROBOT_MODE_OTHER=0\nuint8 ROBOT_MODE_MOVE=2\nuint8 robot_mode\nErrors current_errors\n\
         {line}\nMSG: franka_msgs/CollisionIndicators\ngeometry_msgs/Vector3 is_cartesian_linear_collision\nfloat64[7] is_joint_collision\n\
         {line}\nMSG: franka_msgs/Elbow\nfloat64[2] position\n{line}\nMSG: franka_msgs/Errors\nbool joint_reflex\nbool other\n\
         {line}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n\
         {line}\nMSG: geometry_msgs/Wrench\nVector3 force\nVector3 torque\n\
         {line}\nMSG: geometry_msgs/WrenchStamped\nstd_msgs/Header header\nWrench wrench\n\
         {line}\nMSG: sensor_msgs/JointState\n{JOINT_STATE}"
    )
}

/// Bytes of one message, little endian.
pub struct Cdr(Vec<u8>);

impl Cdr {
    pub fn new() -> Self {
        Self(vec![0, 1, 0, 0])
    }

    fn aligned(mut self, bytes: &[u8]) -> Self {
        while !(self.0.len() - 4).is_multiple_of(bytes.len()) {
            self.0.push(0);
        }
        self.0.extend_from_slice(bytes);
        self
    }

    pub fn u8(self, value: u8) -> Self {
        self.aligned(&[value])
    }

    pub fn u32(self, value: u32) -> Self {
        self.aligned(&value.to_le_bytes())
    }

    pub fn f64s(self, values: &[f64]) -> Self {
        values.iter().fold(self, |cdr, value| cdr.aligned(&value.to_le_bytes()))
    }

    pub fn sequence(self, values: &[f64]) -> Self {
        self.u32(values.len() as u32).f64s(values)
    }

    pub fn text(self, text: &str) -> Self {
        let mut cdr = self.u32(text.len() as u32 + 1);
        cdr.0.extend_from_slice(text.as_bytes());
        cdr.0.push(0);
        cdr
    }

    pub fn header(self, stamp_ns: u64) -> Self {
        self.u32((stamp_ns / 1_000_000_000) as u32).u32((stamp_ns % 1_000_000_000) as u32).text("base")
    }

    pub fn joint_state(
        self,
        stamp_ns: u64,
        names: &[&str],
        position: &[f64],
        velocity: &[f64],
        effort: &[f64],
    ) -> Self {
        let cdr = self.header(stamp_ns).u32(names.len() as u32);
        let cdr = names.iter().fold(cdr, |cdr, name| cdr.text(name));
        cdr.sequence(position).sequence(velocity).sequence(effort)
    }

    pub fn bytes(self) -> Vec<u8> {
        self.0
    }
}

/// One message: topic, type, schema encoding, definition, message encoding, stamp of the recorder (ns), bytes.
pub struct Recorded {
    pub topic: String,
    pub kind: String,
    pub definition: String,
    pub json: bool,
    pub log_ns: u64,
    pub bytes: Vec<u8>,
}

impl Recorded {
    pub fn cdr(topic: &str, kind: &str, definition: &str, log_ns: u64, message: Cdr) -> Self {
        let (topic, kind, definition) = (topic.to_owned(), kind.to_owned(), definition.to_owned());
        Self { topic, kind, definition, json: false, log_ns, bytes: message.bytes() }
    }

    pub fn json(topic: &str, log_ns: u64, text: &str) -> Self {
        let (topic, kind, definition) = (topic.to_owned(), "my.Log".to_owned(), r#"{"type":"object"}"#.to_owned());
        Self { topic, kind, definition, json: true, log_ns, bytes: text.as_bytes().to_vec() }
    }
}

/// An MCAP file of the messages.
pub fn mcap_file(messages: &[Recorded], compression: Option<Compression>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WriteOptions::new().compression(compression).compression_threads(0).create(&mut bytes).unwrap();
    for (place, recorded) in messages.iter().enumerate() {
        let (encoding, message_encoding) = if recorded.json { ("jsonschema", "json") } else { ("ros2msg", "cdr") };
        let id = messages.iter().position(|other| other.topic == recorded.topic).unwrap() as u16;
        let schema = Schema {
            id: id + 1,
            name: recorded.kind.clone(),
            encoding: encoding.to_owned(),
            data: Cow::Borrowed(recorded.definition.as_bytes()),
        };
        let channel = Channel {
            id,
            topic: recorded.topic.clone(),
            schema: Some(Arc::new(schema)),
            message_encoding: message_encoding.to_owned(),
            metadata: BTreeMap::new(),
        };
        let message = Message {
            channel: Arc::new(channel),
            sequence: place as u32,
            log_time: recorded.log_ns,
            publish_time: recorded.log_ns,
            data: Cow::Borrowed(&recorded.bytes),
        };
        writer.write(&message).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}
