//! One channel of an MCAP file as a source of log rows: which of its fields are which quantity, and one message as numbers.
//!
//! ```text
//! q         measured_joint_state.position, q, position          tau_J     measured_joint_state.effort, tau_J, tau_j, effort
//! dq        measured_joint_state.velocity, dq, velocity         tau_J_d   desired_joint_state.effort, tau_J_d, tau_j_d
//! theta     measured_joint_motor_state.position, theta          O_F_ext   o_f_ext_hat_k.wrench.{force, torque}.{x, y, z},
//! dtheta    measured_joint_motor_state.velocity, dtheta                   O_F_ext, o_f_ext_hat_k, O_F_ext_hat_K
//! tau_link, temperature, temperature_ambient: under these names
//! ```
//!
//! The first path that a message has counts. That is `franka_msgs/FrankaRobotState` of any version, the flat
//! `franka_msgs/FrankaState` before it, `sensor_msgs/JointState`, and JSON objects with arrays under our names or with our
//! canonical columns (`q_0`). Three clocks: `time` (s), `header.stamp`, and the stamp of the recorder.

use serde_json::Value;
use tribo_files::ros2_layout::{Node, bind, expand};
use tribo_files::{Cdr, Slot};

use crate::quantity::{MAX_JOINTS, Quantity};

/// The quantities and where they may be; a path with several leaves is written once for each.
const PATHS: [(Quantity, &[&[&str]]); 11] = [
    (Quantity::Position, &[&["measured_joint_state.position"], &["q"], &["position"]]),
    (Quantity::Velocity, &[&["measured_joint_state.velocity"], &["dq"], &["velocity"]]),
    (Quantity::Torque, &[&["measured_joint_state.effort"], &["tau_J"], &["tau_j"], &["effort"]]),
    (Quantity::TorqueDesired, &[&["desired_joint_state.effort"], &["tau_J_d"], &["tau_j_d"]]),
    (Quantity::FrictionCompensation, &[&["tau_friction"]]),
    (Quantity::LinkTorque, &[&["tau_link"]]),
    (Quantity::MotorPosition, &[&["measured_joint_motor_state.position"], &["theta"]]),
    (Quantity::MotorVelocity, &[&["measured_joint_motor_state.velocity"], &["dtheta"]]),
    (Quantity::Temperature, &[&["temperature"]]),
    (Quantity::TemperatureAmbient, &[&["temperature_ambient"]]),
    (
        Quantity::ExternalWrench,
        &[
            &[
                "o_f_ext_hat_k.wrench.force.x",
                "o_f_ext_hat_k.wrench.force.y",
                "o_f_ext_hat_k.wrench.force.z",
                "o_f_ext_hat_k.wrench.torque.x",
                "o_f_ext_hat_k.wrench.torque.y",
                "o_f_ext_hat_k.wrench.torque.z",
            ],
            &["O_F_ext"],
            &["o_f_ext_hat_k"],
            &["O_F_ext_hat_K"],
        ],
    ),
];

/// Where names of joints and stamps are.
const NAMES: [&str; 2] = ["measured_joint_state.name", "name"];
const STAMP: [&str; 2] = ["header.stamp.sec", "header.stamp.nanosec"];
const TIME: &str = "time";

/// Slots after those of the quantities.
const NAME_SLOT: usize = PATHS.len();
const SEC_SLOT: usize = NAME_SLOT + 1;
const NANOSEC_SLOT: usize = NAME_SLOT + 2;
const TIME_SLOT: usize = NAME_SLOT + 3;
const SLOTS: usize = NAME_SLOT + 4;

/// One message.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Sample {
    /// Names of the joints, in the order of the entries; empty where the message has none.
    pub names: Vec<String>,
    /// `time` of the message (s).
    pub time_s: Option<f64>,
    /// `header.stamp` (ns).
    pub stamp_ns: Option<u64>,
    /// The entries of each quantity that the message has.
    pub values: Vec<(Quantity, Vec<f64>)>,
}

impl Sample {
    /// The entries of a quantity; empty where the message lacks it.
    pub fn of(&self, quantity: Quantity) -> &[f64] {
        self.values.iter().find(|(found, _)| *found == quantity).map_or(&[], |(_, values)| values)
    }

    /// The message without what only some messages of its kind carry: empty arrays.
    fn of_slots(slots: &mut [Slot]) -> Self {
        let number = |slot: usize| slots[slot].numbers.first().copied();
        let stamp_ns = number(SEC_SLOT).zip(number(NANOSEC_SLOT)).map(|(sec, nanosec)| {
            // Exact: seconds and nanoseconds are 32 bits each. A stamp before 1970 is none.
            (sec.max(0.0) as u64) * 1_000_000_000 + nanosec as u64
        });
        let time_s = number(TIME_SLOT);
        let mut values = Vec::new();
        for ((quantity, _), slot) in PATHS.iter().zip(slots.iter_mut()) {
            if !slot.numbers.is_empty() {
                values.push((*quantity, std::mem::take(&mut slot.numbers)));
            }
        }
        Self { names: std::mem::take(&mut slots[NAME_SLOT].texts), time_s, stamp_ns, values }
    }
}

/// How messages of one channel are read.
pub(crate) enum Source {
    /// Bytes in the order of a definition.
    Cdr(Vec<Node>),
    /// Text.
    Json,
}

impl Source {
    /// How messages of an encoding are read, or why they are not; the definition is name, encoding and text.
    pub fn of(message_encoding: &str, definition: Option<(&str, &str, &[u8])>) -> Result<Self, String> {
        match (message_encoding, definition) {
            ("json", _) => Ok(Self::Json),
            ("cdr", Some((name, "ros2msg", text))) => Self::of_definition(name, &String::from_utf8_lossy(text)),
            (message, definition) => {
                let schema = definition.map_or("", |(_, encoding, _)| encoding);
                Err(format!("has encoding `{message}` with schema `{schema}`"))
            }
        }
    }

    /// How messages in CDR of this definition (`ros2msg`) are read, or why they are not.
    pub fn of_definition(name: &str, definition: &str) -> Result<Self, String> {
        let mut nodes = expand(name, definition)?;
        let bound: Vec<Quantity> = bind_all(&mut nodes);
        match Quantity::ALL.into_iter().find(|q| q.is_required() && *q != Quantity::Time && !bound.contains(q)) {
            None => Ok(Self::Cdr(nodes)),
            Some(lacking) => Err(format!("has no field for {lacking}")),
        }
    }

    /// One message as numbers.
    pub fn sample(&self, message: &[u8]) -> Result<Sample, String> {
        match self {
            Self::Cdr(nodes) => {
                let mut slots = vec![Slot::default(); SLOTS];
                Cdr::new(message)?.read(nodes, &mut slots)?;
                Ok(Sample::of_slots(&mut slots))
            }
            Self::Json => {
                let object: Value = serde_json::from_slice(message).map_err(|error| format!("is no JSON: {error}"))?;
                Ok(Sample::of_slots(&mut slots_of(&object)))
            }
        }
    }
}

/// Gives every field that is read its slot; the quantities found.
fn bind_all(nodes: &mut [Node]) -> Vec<Quantity> {
    let mut found = Vec::new();
    for (slot, (quantity, places)) in PATHS.iter().enumerate() {
        if places.iter().any(|paths| paths.iter().filter(|path| bind(nodes, path, slot)).count() == paths.len()) {
            found.push(*quantity);
        }
    }
    for path in NAMES {
        if bind(nodes, path, NAME_SLOT) {
            break;
        }
    }
    for (path, slot) in [(STAMP[0], SEC_SLOT), (STAMP[1], NANOSEC_SLOT), (TIME, TIME_SLOT)] {
        bind(nodes, path, slot);
    }
    found
}

/// The slots of a JSON object.
fn slots_of(object: &Value) -> Vec<Slot> {
    let at = |path: &str| path.split('.').try_fold(object, |value, name| value.get(name));
    let mut slots = vec![Slot::default(); SLOTS];
    for ((quantity, places), slot) in PATHS.iter().zip(&mut slots) {
        let found =
            places.iter().map(|paths| paths.iter().filter_map(|path| at(path)).flat_map(numbers).collect::<Vec<f64>>());
        slot.numbers = found.into_iter().find(|numbers| !numbers.is_empty()).unwrap_or_default();
        if slot.numbers.is_empty() {
            let columns = (0..quantity.column_count(MAX_JOINTS)).map(|index| quantity.column_name(index));
            slot.numbers = columns.map_while(|name| object.get(&name)?.as_f64()).collect();
        }
    }
    let texts = |value: &Value| -> Vec<String> {
        value.as_array().into_iter().flatten().filter_map(|text| text.as_str().map(str::to_owned)).collect()
    };
    slots[NAME_SLOT].texts = NAMES.iter().find_map(|path| at(path)).map(texts).unwrap_or_default();
    for (path, slot) in [(STAMP[0], SEC_SLOT), (STAMP[1], NANOSEC_SLOT), (TIME, TIME_SLOT)] {
        slots[slot].numbers.extend(at(path).and_then(Value::as_f64));
    }
    slots
}

/// The numbers of a scalar or an array; an entry that is no number is not a number (`null` is how JSON writes NaN).
fn numbers(value: &Value) -> Vec<f64> {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    match value {
        Value::Array(values) => values.iter().map(number).collect(),
        Value::Number(_) => vec![number(value)],
        _ => Vec::new(),
    }
}
