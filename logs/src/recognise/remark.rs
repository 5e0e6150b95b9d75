//! One thing that is, or may be, wrong with a log.

use std::fmt;

/// How sure it is that nothing computed from the log as it is can be right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Severity {
    /// It may be right; the user has to look.
    Warn,
    /// It is wrong if the model is a good one: a trial of a campaign, which runs on that model, is refused, a diagnosis, which asks what the model
    /// lacks, is not.
    Suspect,
    /// It cannot be right.
    Refuse,
}

/// What the log is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Use {
    /// Another file with the same numbers: nothing is judged by them.
    Conversion,
    /// A diagnosis: positions and torques, no `dq`.
    Diagnosis,
    /// The wrench along the log: `dq` too.
    Wrench,
    /// The trial of a campaign: `dq` too, and an arm that moved.
    Trial,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// Time stamps in another unit than seconds, or too far apart for an arm.
    Clock,
    /// Positions in degrees.
    Degrees,
    /// A position that stands still while the joint moves.
    FrozenEncoder,
    /// `dq` has the opposite sign of the derivative of q.
    VelocitySign,
    /// `dq` is another multiple of the derivative of q than 1.
    VelocityScale,
    /// `dq` comes later or earlier than the derivative of q.
    VelocityDelay,
    /// `dq` has nothing to do with the derivative of q.
    VelocityOther,
    /// Positions or torques that are noise for the most part.
    Noise,
    /// Nothing moves, or a joint does not move both ways.
    Standstill,
    /// The torque has the opposite sign.
    TorqueSign,
    /// The position (with its velocity) has the opposite sign.
    PositionSign,
    /// Position and torque have the opposite sign: the joint's axis points the other way.
    AxisSign,
    /// Torque or position, nobody can tell which, has the opposite sign.
    TorqueOrPositionSign,
    /// Columns of two or more joints stand in each other's place.
    JointOrder,
    /// Torques in another unit than Nm, or far from the model by a factor.
    TorqueUnit,
    /// The torques lack the weight of the arm.
    GravityMissing,
    /// Gravity points elsewhere than in the model.
    GravityDirection,
    /// The torques are of the other side of the gears.
    TorqueSide,
    /// Another arm than the model's.
    OtherRobot,
    /// Torques that have nothing to do with the motion.
    TorqueUnexplained,
    /// Samples that no joint of the arm gives.
    Impossible,
}

impl Fault {
    /// Its name in JSON documents.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clock => "clock",
            Self::Degrees => "degrees",
            Self::FrozenEncoder => "frozen_encoder",
            Self::VelocitySign => "velocity_sign",
            Self::VelocityScale => "velocity_scale",
            Self::VelocityDelay => "velocity_delay",
            Self::VelocityOther => "velocity_other",
            Self::Noise => "noise",
            Self::Standstill => "standstill",
            Self::TorqueSign => "torque_sign",
            Self::PositionSign => "position_sign",
            Self::AxisSign => "axis_sign",
            Self::TorqueOrPositionSign => "torque_or_position_sign",
            Self::JointOrder => "joint_order",
            Self::TorqueUnit => "torque_unit",
            Self::GravityMissing => "gravity_missing",
            Self::GravityDirection => "gravity_direction",
            Self::TorqueSide => "torque_side",
            Self::OtherRobot => "other_robot",
            Self::TorqueUnexplained => "torque_unexplained",
            Self::Impossible => "impossible_samples",
        }
    }

    /// Whether it spoils a trial alone: a standing arm has a wrench, and a diagnosis says what it is that the model does not explain.
    fn is_of_the_trial(self) -> bool {
        matches!(self, Self::Standstill | Self::TorqueUnexplained)
    }

    /// Whether it lies in `dq` alone.
    fn of_velocity(self) -> bool {
        matches!(self, Self::VelocitySign | Self::VelocityScale | Self::VelocityDelay | Self::VelocityOther)
    }
}

/// A judgement on a log: what, of which joints, the evidence, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// What is wrong.
    pub fault: Fault,
    /// How sure that is.
    pub severity: Severity,
    /// The joints it is about, from 0; empty where it is the whole log.
    pub joints: Vec<usize>,
    /// The evidence: a sentence with its figure.
    pub evidence: String,
    /// What to do.
    pub remedy: String,
}

impl Remark {
    /// A remark that refuses.
    #[must_use]
    pub fn refuse(fault: Fault, joints: Vec<usize>, evidence: String, remedy: String) -> Self {
        Self { fault, severity: Severity::Refuse, joints, evidence, remedy }
    }

    /// A remark that warns.
    #[must_use]
    pub fn warn(fault: Fault, joints: Vec<usize>, evidence: String, remedy: String) -> Self {
        Self { fault, severity: Severity::Warn, joints, evidence, remedy }
    }

    /// Whether a log with this remark cannot be used for that.
    ///
    /// | use | refused for |
    /// |---|---|
    /// | conversion | nothing |
    /// | diagnosis | whatever is surely wrong with time, positions, torques |
    /// | wrench | that, and `dq` |
    /// | trial | that, an arm that did not move, and torques that say nothing of the motion |
    #[must_use]
    pub fn refuses(&self, wanted: Use) -> bool {
        let matters = match wanted {
            Use::Conversion => false,
            Use::Diagnosis => !self.fault.of_velocity() && !self.fault.is_of_the_trial(),
            Use::Wrench => !self.fault.is_of_the_trial(),
            Use::Trial => true,
        };
        matters
            && match self.severity {
                Severity::Warn => false,
                Severity::Suspect => wanted == Use::Trial,
                Severity::Refuse => true,
            }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.evidence, self.remedy)
    }
}

/// Why the log called `name` cannot be used for that, one line per reason; `None` where it can.
#[must_use]
pub fn refusal(name: &str, remarks: &[Remark], wanted: Use) -> Option<String> {
    let reasons = remarks.iter().filter(|remark| remark.refuses(wanted));
    let reasons: Vec<String> = reasons.map(|remark| format!("{name}: {}: {remark}", remark.fault.name())).collect();
    (!reasons.is_empty()).then(|| reasons.join("\n"))
}

/// What there is to say of the log called `name`, line by line.
pub fn said(name: &str, remarks: &[Remark]) -> impl Iterator<Item = String> {
    remarks.iter().map(move |remark| format!("{name}: {remark}"))
}

/// `joint 3`, `joints 1 and 3`, `joints 0, 1 and 3`.
#[must_use]
pub fn joints_named(joints: &[usize]) -> String {
    match joints {
        [] => "no joint".to_owned(),
        [one] => format!("joint {one}"),
        [most @ .., last] => {
            format!("joints {} and {last}", most.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_refuses_depends_on_the_use() {
        let of = |fault| Remark::refuse(fault, vec![1, 3], "a".to_owned(), "b".to_owned());
        let uses = [Use::Conversion, Use::Diagnosis, Use::Wrench, Use::Trial];
        assert_eq!(uses.map(|wanted| of(Fault::Clock).refuses(wanted)), [false, true, true, true]);
        assert_eq!(uses.map(|wanted| of(Fault::VelocitySign).refuses(wanted)), [false, false, true, true]);
        assert_eq!(uses.map(|wanted| of(Fault::Standstill).refuses(wanted)), [false, false, false, true]);
        assert!(!Remark { severity: Severity::Warn, ..of(Fault::Clock) }.refuses(Use::Trial));
        let suspect = Remark { severity: Severity::Suspect, ..of(Fault::TorqueSign) };
        assert_eq!(uses.map(|wanted| suspect.refuses(wanted)), [false, false, false, true]);
        assert_eq!(of(Fault::Clock).to_string(), "a; b");
        let both = [of(Fault::VelocitySign), of(Fault::Standstill)];
        assert_eq!(refusal("l.csv", &both, Use::Wrench).unwrap(), "l.csv: velocity_sign: a; b");
        assert_eq!(refusal("l.csv", &both, Use::Trial).unwrap().lines().count(), 2);
        assert_eq!(refusal("l.csv", &both, Use::Conversion), None);
        assert_eq!(said("l.csv", &both).collect::<Vec<_>>(), ["l.csv: a; b"; 2]);
        assert_eq!(
            [&[2][..], &[1, 3], &[0, 1, 3]].map(joints_named),
            ["joint 2", "joints 1 and 3", "joints 0, 1 and 3"]
        );
    }
}
