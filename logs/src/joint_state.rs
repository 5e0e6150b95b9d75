//! `sensor_msgs/msg/JointState` as bytes: what a ROS 2 topic carries and a rosbag2 keeps.

use tribo_files::CdrWriter;

use crate::joint_order::arm_joints;
use crate::message_source::Source;
use crate::quantity::Quantity;

/// Its name in ROS 2.
pub(crate) const JOINT_STATE: &str = "sensor_msgs/msg/JointState";

/// Its fields, as recorders store them.
pub(crate) const JOINT_STATE_FIELDS: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
     ================================================================================\nMSG: std_msgs/Header\n\
     builtin_interfaces/Time stamp\nstring frame_id\n\
     ================================================================================\nMSG: builtin_interfaces/Time\n\
     int32 sec\nuint32 nanosec\n";

/// State of joints, one entry per joint and list; a list that a driver does not fill is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointState {
    /// `header.stamp`, since 1970 (ns); zero where the driver sets none.
    pub stamp_ns: u64,
    /// Names of the joints.
    pub names: Vec<String>,
    /// Positions (rad).
    pub position: Vec<f64>,
    /// Velocities [rad/s].
    pub velocity: Vec<f64>,
    /// Torques (Nm).
    pub effort: Vec<f64>,
}

impl JointState {
    /// The message in CDR, little endian, without a frame.
    pub fn to_cdr(&self) -> Vec<u8> {
        let mut cdr = CdrWriter::default();
        cdr.header(self.stamp_ns, "").texts(&self.names).f64s(&self.position).f64s(&self.velocity).f64s(&self.effort);
        cdr.finish()
    }

    /// Names of those joints that are an arm's, from base to tool: the names decide (number at the end, or Universal Robots' words), fingers
    /// and grippers are left out.
    pub fn arm_joints(&self) -> Vec<String> {
        arm_joints(&self.names)
    }
}

/// Reads messages in CDR of either byte order.
pub struct JointStateReader {
    source: Source,
}

impl JointStateReader {
    /// A reader; the error, of a definition that is not understood, never comes.
    ///
    /// # Errors
    /// None with the fields as they are.
    pub fn new() -> Result<Self, String> {
        Source::of_definition(JOINT_STATE, JOINT_STATE_FIELDS).map(|source| Self { source })
    }

    /// One message.
    ///
    /// # Errors
    /// Bytes that are no such message: the field, and what is wrong with it.
    pub fn read(&self, message: &[u8]) -> Result<JointState, String> {
        let sample = self.source.sample(message)?;
        let of = |quantity| sample.of(quantity).to_vec();
        Ok(JointState {
            stamp_ns: sample.stamp_ns.unwrap_or(0),
            position: of(Quantity::Position),
            velocity: of(Quantity::Velocity),
            effort: of(Quantity::Torque),
            names: sample.names,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> JointState {
        JointState {
            stamp_ns: 1_700_000_000_123_456_789,
            names: vec!["finger_1".into(), "joint_2".into(), "joint_1".into()],
            position: vec![0.1, 0.2, 0.3],
            velocity: Vec::new(),
            effort: vec![-1.0, f64::NAN, 1e300],
        }
    }

    /// The reader of logs, which is older, reads what is written, to the bit.
    #[test]
    fn what_is_written_is_read() {
        let (reader, state) = (JointStateReader::new().unwrap(), state());
        let read = reader.read(&state.to_cdr()).unwrap();
        assert_eq!((read.stamp_ns, &read.names, &read.position), (state.stamp_ns, &state.names, &state.position));
        assert!(read.velocity.is_empty() && read.effort[1].is_nan() && read.effort[2] == 1e300);
        assert_eq!(read.arm_joints(), ["joint_1", "joint_2"]);
    }

    /// Bytes laid out by hand: stamp 2 s + 3 ns, frame "b", one joint "j" at 1.5 rad.
    #[test]
    fn the_bytes_are_those_of_the_standard() {
        let mut bytes =
            b"\0\x01\0\0\x02\0\0\0\x03\0\0\0\x02\0\0\0b\0\0\0\x01\0\0\0\x02\0\0\0j\0\0\0\x01\0\0\0".to_vec();
        bytes.extend_from_slice(&1.5_f64.to_le_bytes());
        bytes.extend_from_slice(&[0; 8]);
        let read = JointStateReader::new().unwrap().read(&bytes).unwrap();
        assert_eq!(
            (read.stamp_ns, &read.names[..], &read.position[..]),
            (2_000_000_003, &["j".to_owned()][..], &[1.5][..])
        );
        let mut cdr = CdrWriter::default();
        cdr.header(2_000_000_003, "b").texts(&read.names).f64s(&read.position).f64s(&[]).f64s(&[]);
        assert_eq!(cdr.finish(), bytes);
    }

    #[test]
    fn every_cut_is_an_error() {
        let (reader, whole) = (JointStateReader::new().unwrap(), state().to_cdr());
        for length in 0..whole.len() {
            assert!(reader.read(&whole[..length]).is_err(), "{length}");
        }
    }
}
