//! What the names of columns say: quantity, measured or commanded, unit.
//!
//! ```text
//! words       actual_q_0 -> actual q 0      "Motor Torque [Nm]" -> motor torque, Nm      jointPos3 -> joint pos 3
//! quantity    by the field's words (position pos q …, velocity vel dq qd …, effort torque tau moment …, current, time t stamp …)
//! unit        in brackets at the end, or as a word: time_ms, pos_deg_1, timestamp_ns
//! ```

use super::unit::{Dimension, spelled};

/// What a column seems to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meaning {
    Time,
    /// Whole seconds, and the nanoseconds beside them.
    Seconds,
    Nanoseconds,
    Position,
    Velocity,
    Torque,
    Current,
    Temperature,
    /// Names of joints.
    Joint,
    Episode,
}

/// How a quantity came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Origin {
    /// The name says `actual`, `measured`.
    Measured,
    /// It says nothing.
    Plain,
    /// It says `target`, `desired`, `command`.
    Commanded,
}

const POSITION: &[&str] = &[
    "q",
    "pos",
    "position",
    "positions",
    "jpos",
    "qpos",
    "jointpos",
    "angle",
    "angles",
    "jointangle",
    "jointangles",
    "state",
];
const VELOCITY: &[&str] =
    &["dq", "qd", "qdot", "vel", "velocity", "velocities", "jvel", "qvel", "speed", "speeds", "omega", "jointvel"];
const TORQUE: &[&str] = &[
    "tau",
    "torque",
    "torques",
    "effort",
    "efforts",
    "eff",
    "moment",
    "moments",
    "trq",
    "jointtorque",
    "jointtorques",
];
const CURRENT: &[&str] = &["current", "currents", "cur", "curr", "amps", "ampere"];
const TIME: &[&str] = &["time", "t", "timestamp", "timestamps", "stamp", "stamps", "ts", "clock"];
const SECONDS: &[&str] = &["sec", "secs", "seconds"];
const NANOSECONDS: &[&str] = &["nanosec", "nsec", "nanosecs", "nsecs", "nanoseconds"];
const TEMPERATURE: &[&str] = &["temperature", "temperatures", "temp"];
const JOINT: &[&str] = &["name", "names", "joint", "joints", "jointname", "axis"];
const EPISODE: &[&str] = &["episode", "episodes"];
const MEASURED: &[&str] = &["actual", "measured", "meas", "act", "fbk", "feedback", "msr"];
const COMMANDED: &[&str] =
    &["target", "desired", "des", "d", "cmd", "command", "commanded", "ref", "reference", "setpoint", "goal", "action"];
/// Words of quantities that a log of joints is not made of.
const OTHER: &[&str] = &[
    "acc",
    "acceleration",
    "accel",
    "qdd",
    "ddq",
    "tcp",
    "ee",
    "eef",
    "cartesian",
    "tool",
    "ft",
    "wrench",
    "ext",
    "external",
    "voltage",
    "error",
    "err",
    "friction",
    "gravity",
    "motor",
    "robot",
    "safety",
    "index",
    "frame",
    "seq",
    "id",
    "task",
    "window",
    "limit",
];
/// Words of a tool's joints.
const TOOLS: &[&str] = &["finger", "gripper", "knuckle"];

/// Whether a column is of a tool.
pub(crate) fn is_tool(name: &str) -> bool {
    let lower = name.to_lowercase();
    TOOLS.iter().any(|tool| lower.contains(tool))
}

/// The name without a unit at its end, and that unit: `q1 [deg]`, `Time (ms)`.
pub(crate) fn without_unit(name: &str) -> (&str, Option<&'static str>) {
    let trimmed = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('<', '>'), ('/', ' ')] {
        let inside = if close == ' ' {
            // `speed / rpm`, as some drives export.
            trimmed.rsplit_once(" / ")
        } else {
            trimmed.strip_suffix(close).and_then(|start| start.rsplit_once(open))
        };
        if let Some((bare, unit)) = inside
            && let Some((unit, _)) = spelled(unit)
            && !bare.trim().is_empty()
        {
            return (bare.trim(), Some(unit));
        }
    }
    (trimmed, None)
}

/// The words of a name in lower case; digits stand for themselves.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before: Option<char> = None;
    for letter in name.chars() {
        let same = |last: char| {
            (last.is_alphabetic() && letter.is_alphabetic() && !(last.is_lowercase() && letter.is_uppercase()))
                || (last.is_ascii_digit() && letter.is_ascii_digit())
        };
        // mA, mNm: a prefix is no word.
        let milli = letter.is_uppercase() && before == Some('m') && words.last().is_some_and(|word| word == "m");
        match (milli || before.is_some_and(same), letter.is_alphanumeric()) {
            (true, true) => {
                if let Some(word) = words.last_mut() {
                    word.extend(letter.to_lowercase());
                }
            }
            (false, true) => words.push(letter.to_lowercase().collect()),
            (_, false) => {}
        }
        before = Some(letter);
    }
    words
}

/// What a column seems to hold, and how it came about; `None` where its name says nothing that is understood.
pub(crate) fn meaning(name: &str) -> Option<(Meaning, Origin)> {
    let (bare, _) = without_unit(name);
    let words = words(bare);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    // The unit as a word is none of the name.
    let meaning = if has(EPISODE) {
        Meaning::Episode
    } else if has(NANOSECONDS) && (has(&["stamp", "header"]) || words.len() == 1) {
        Meaning::Nanoseconds
    } else if has(SECONDS) && (has(&["stamp", "header"]) || words.len() == 1) {
        Meaning::Seconds
    } else if has(OTHER) {
        return None;
    } else if has(CURRENT) {
        Meaning::Current
    } else if has(VELOCITY) || (has(&["d"]) && has(&["q"]) && words.first().is_some_and(|word| word == "d")) {
        Meaning::Velocity
    } else if has(TORQUE) {
        Meaning::Torque
    } else if has(TEMPERATURE) {
        Meaning::Temperature
    } else if has(POSITION) && !(has(&["state"]) && words.len() == 1) {
        Meaning::Position
    } else if has(TIME) {
        Meaning::Time
    } else if has(JOINT) {
        Meaning::Joint
    } else {
        return None;
    };
    // `d` is desired behind its quantity (tau_d, q_d_1), and never the first word.
    let commanded =
        words.iter().enumerate().any(|(at, word)| COMMANDED.contains(&word.as_str()) && (word != "d" || at > 0));
    let origin = match (commanded, has(MEASURED)) {
        (true, _) => Origin::Commanded,
        (false, true) => Origin::Measured,
        (false, false) => Origin::Plain,
    };
    Some((meaning, origin))
}

/// The unit that a name says, for a quantity of this dimension.
pub(crate) fn unit_in(name: &str, dimension: Dimension) -> Option<&'static str> {
    let (bare, unit) = without_unit(name);
    if unit.is_some() {
        return unit;
    }
    let words = words(bare);
    let fits = |word: &String| -> Option<&'static str> {
        let (unit, measured) = spelled(word)?;
        match (dimension, measured, unit) {
            // A single letter is no unit: q_a, t_c.
            _ if word.len() == 1 && unit != "s" => None,
            (Dimension::AngularVelocity, Dimension::Angle, "deg") => Some("deg/s"),
            (Dimension::AngularVelocity, Dimension::Angle, "rad") => Some("rad/s"),
            (Dimension::Torque, Dimension::Current, _) => Some(unit),
            _ if measured == dimension => Some(unit),
            _ => None,
        }
    };
    words.iter().rev().find_map(fits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_other_programs_are_understood() {
        use Meaning::*;
        use Origin::*;
        for (name, expected) in [
            ("actual_q_0", Some((Position, Measured))),
            ("target_qd_3", Some((Velocity, Commanded))),
            ("actual_current_0", Some((Current, Measured))),
            ("target_moment_5", Some((Torque, Commanded))),
            ("/joint_states/panda_joint1/position", Some((Position, Plain))),
            ("jointPos3", Some((Position, Plain))),
            ("Joint Torque 2 [Nm]", Some((Torque, Plain))),
            ("observation.state[4]", Some((Position, Plain))),
            ("action[4]", None),
            ("tau_d_1", Some((Torque, Commanded))),
            ("dq_1", Some((Velocity, Plain))),
            ("%time", Some((Time, Plain))),
            ("__time", Some((Time, Plain))),
            ("header.stamp.sec", Some((Seconds, Plain))),
            ("header.stamp.nanosec", Some((Nanoseconds, Plain))),
            ("timestamp_ns", Some((Time, Plain))),
            ("time_sec", Some((Time, Plain))),
            ("actual_TCP_force_0", None),
            ("frame_index", None),
            ("episode_index", Some((Episode, Plain))),
            ("field.name0", Some((Joint, Plain))),
            ("note", None),
        ] {
            assert_eq!(meaning(name), expected, "{name}");
        }
        assert_eq!(without_unit("Time (ms)"), ("Time", Some("ms")));
        assert_eq!(without_unit("position[0]"), ("position[0]", None));
        assert_eq!(unit_in("pos_deg_1", Dimension::Angle), Some("deg"));
        assert_eq!(unit_in("vel_deg_s_1", Dimension::AngularVelocity), Some("deg/s"));
        assert_eq!(unit_in("timestamp_ns", Dimension::Time), Some("ns"));
        assert_eq!(unit_in("current_3_mA", Dimension::Torque), Some("mA"));
        assert_eq!(unit_in("t", Dimension::Time), None);
    }
}
