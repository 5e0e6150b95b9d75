//! Which entry of a message is which joint of the arm.

use nalgebra::SVector;
use tribo_logs::JointState;

use crate::Unusable;

/// The joints of an arm by name, base to tool; the order in a message may be any, other joints beside them are passed over.
///
/// ```text
/// names given                 each has to be in a message
/// none given                  the names that a first message has for an arm of N joints (by number, or Universal Robots' words)
/// messages without names      the first N entries
/// ```
#[derive(Clone, Debug)]
pub struct ArmJoints<const N: usize> {
    names: Option<[String; N]>,
    /// The names of the last message that had them all, and where they were.
    seen: Option<(Vec<String>, [usize; N])>,
}

impl<const N: usize> ArmJoints<N> {
    /// Joints of these names, or of those that a first message has.
    pub fn new(names: Option<[String; N]>) -> Self {
        Self { names, seen: None }
    }

    /// The names, base to tool, once they are known.
    pub fn names(&self) -> Option<&[String; N]> {
        self.names.as_ref()
    }

    /// Which entry is which joint.
    ///
    /// # Errors
    /// [`Unusable::NoArm`] with the names that there are.
    pub fn entries(&mut self, message: &JointState) -> Result<[usize; N], Unusable> {
        // Every message of a driver has the same names.
        if let Some((names, entries)) = &self.seen
            && *names == message.names
        {
            return Ok(*entries);
        }
        let entries = if message.names.is_empty() { self.nameless(message)? } else { self.named(message)? };
        self.seen = Some((message.names.clone(), entries));
        Ok(entries)
    }

    fn nameless(&self, message: &JointState) -> Result<[usize; N], Unusable> {
        if message.position.len() == N {
            return Ok(std::array::from_fn(|j| j));
        }
        let found = format!("without names, {} of them", message.position.len());
        Err(Unusable::NoArm { found, missing: format!("an arm's {N}") })
    }

    fn named(&mut self, message: &JointState) -> Result<[usize; N], Unusable> {
        let no_arm = |missing: String| Unusable::NoArm { found: shown(&message.names), missing };
        let names = match &self.names {
            Some(names) => names.clone(),
            None => <[String; N]>::try_from(message.arm_joints()).map_err(|joints| {
                no_arm(format!("an arm of {N} joints ({} are no tool's); --joints names them", joints.len()))
            })?,
        };
        let place = |name: &String| message.names.iter().position(|found| found == name);
        let missing: Vec<String> = names.iter().filter(|name| place(name).is_none()).cloned().collect();
        if !missing.is_empty() {
            return Err(no_arm(shown(&missing)));
        }
        let entries = std::array::from_fn(|j| place(&names[j]).unwrap_or(0));
        self.names = Some(names);
        Ok(entries)
    }
}

/// The values of a list in the order of the joints, all finite.
pub(crate) fn picked<const N: usize>(
    message: &JointState,
    list: &'static str,
    values: &[f64],
    entries: &[usize; N],
) -> Result<SVector<f64, N>, Unusable> {
    let expected = if message.names.is_empty() { N } else { message.names.len() };
    if values.len() != expected {
        return Err(Unusable::Entries { list, found: values.len(), expected });
    }
    let picked: SVector<f64, N> = SVector::from_fn(|j, _| values[entries[j]]);
    match picked.iter().position(|value| !value.is_finite()) {
        Some(j) => {
            let joint = message.names.get(entries[j]).map_or_else(|| format!("joint {j}"), |name| visible(name));
            Err(Unusable::NotFinite { list, joint })
        }
        None => Ok(picked),
    }
}

/// The most names that an error shows.
const MOST_SHOWN: usize = 24;

/// Names from the network, for a terminal.
fn shown(names: &[String]) -> String {
    let more = if names.len() > MOST_SHOWN { ", …" } else { "" };
    names.iter().take(MOST_SHOWN).map(|name| visible(name)).collect::<Vec<_>>().join(", ") + more
}

fn visible(name: &str) -> String {
    name.chars().take(64).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(names: &[&str]) -> JointState {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let position = (0..names.len()).map(|k| k as f64).collect();
        JointState { names, position, ..JointState::default() }
    }

    #[test]
    fn the_order_is_that_of_the_arm_whatever_the_message_has() {
        let mixed = message(&["finger_joint1", "arm_joint2", "arm_joint1"]);
        let mut joints = ArmJoints::<2>::new(None);
        let entries = joints.entries(&mixed).unwrap();
        assert_eq!(entries, [2, 1]);
        assert_eq!(joints.names().unwrap(), &["arm_joint1", "arm_joint2"]);
        assert_eq!(picked(&mixed, "position", &mixed.position, &entries).unwrap().as_slice(), [2.0, 1.0]);
        // The arm stays the one it was first, wherever its joints are.
        assert_eq!(joints.entries(&message(&["arm_joint1", "x", "arm_joint2"])).unwrap(), [0, 2]);
        let mut given = ArmJoints::<2>::new(Some(["b".into(), "a".into()]));
        assert_eq!(given.entries(&message(&["a", "wheel_3", "b"])).unwrap(), [2, 0]);
        assert_eq!(
            ArmJoints::<2>::new(None).entries(&JointState { position: vec![0.0; 2], ..JointState::default() }),
            Ok([0, 1])
        );
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut given = ArmJoints::<2>::new(Some(["b".into(), "a".into()]));
        let error = given.entries(&message(&["a", "c\u{1b}[31m"])).unwrap_err().to_string();
        assert_eq!(error, "has the joints a, c\u{fffd}[31m, which lack b");
        let error = ArmJoints::<2>::new(None).entries(&message(&["j1", "j2", "j3"])).unwrap_err().to_string();
        assert!(error.contains("j1, j2, j3") && error.contains("--joints"), "{error}");
        let state = JointState { effort: vec![1.0, f64::NAN], ..message(&["a", "b"]) };
        let error = picked(&state, "effort", &state.effort, &[0, 1]).unwrap_err().to_string();
        assert_eq!(error, "effort of b is not finite");
        assert!(picked::<2>(&state, "velocity", &[0.0], &[0, 1]).is_err());
    }
}
