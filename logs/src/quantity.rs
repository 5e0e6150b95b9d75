//! The canonical columns: which physical quantity a column holds, in which unit, under which name.
//!
//! ```text
//! time | q_i  dq_i  tau_J_i | tau_J_d_i  tau_friction_i  tau_link_i  theta_i  dtheta_i  temperature_i | temperature_ambient | O_F_ext_0..5
//! ```
//!
//! i = 0..N-1 over the joints; the names are those of libfranka's `RobotState`, except `tau_friction_i`, `tau_link_i`
//! and the temperatures, which libfranka does not know. Names are exact: case matters.
//!
//! `tau_J_i` is the joint torque that a log always has: of a link-side sensor where the robot has only that, of the
//! motor current where the robot reports that too. `tau_link_i` appears only beside a motor-side `tau_J_i`; then
//! `tau_J_i − tau_link_i` is what the transmission takes: friction and rotor inertia.

use std::fmt;

/// The most joints a log may have. A larger index in a column name is taken as a name we do not understand.
pub(crate) const MAX_JOINTS: usize = 64;

/// Components of the external wrench: force x, y, z, then moment x, y, z.
const WRENCH_COMPONENTS: usize = 6;

/// What viewers call the components.
const WRENCH_LEAVES: [&str; WRENCH_COMPONENTS] = ["force/x", "force/y", "force/z", "moment/x", "moment/y", "moment/z"];

/// A physical quantity of a log; one column, one per joint, or six for the wrench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// `time` (s).
    Time,
    /// `q_i`: joint position (rad).
    Position,
    /// `dq_i`: joint velocity (rad/s).
    Velocity,
    /// `tau_J_i`: measured joint torque (Nm).
    Torque,
    /// `tau_J_d_i`: commanded joint torque (Nm).
    TorqueDesired,
    /// `tau_friction_i`: the part of the command that a friction compensator added (Nm).
    FrictionCompensation,
    /// `tau_link_i`: torque measured on the link side (Nm), beside a `tau_J_i` measured on the motor side.
    LinkTorque,
    /// `theta_i`: motor position through the gear (rad).
    MotorPosition,
    /// `dtheta_i`: motor velocity through the gear (rad/s).
    MotorVelocity,
    /// `temperature_i`: joint temperature (degC).
    Temperature,
    /// `temperature_ambient` (degC).
    TemperatureAmbient,
    /// `O_F_ext_k`: wrench the robot exerts on the environment, base frame, force (N) then moment (Nm).
    ExternalWrench,
}

impl Quantity {
    /// All quantities, in the order of the canonical columns.
    pub const ALL: [Self; 12] = [
        Self::Time,
        Self::Position,
        Self::Velocity,
        Self::Torque,
        Self::TorqueDesired,
        Self::FrictionCompensation,
        Self::LinkTorque,
        Self::MotorPosition,
        Self::MotorVelocity,
        Self::Temperature,
        Self::TemperatureAmbient,
        Self::ExternalWrench,
    ];

    /// Whether every log must have it.
    #[must_use]
    pub fn is_required(self) -> bool {
        matches!(self, Self::Time | Self::Position | Self::Velocity | Self::Torque)
    }

    /// Whether it has one column per joint.
    #[must_use]
    pub fn is_per_joint(self) -> bool {
        !matches!(self, Self::Time | Self::TemperatureAmbient | Self::ExternalWrench)
    }

    /// Unit of its columns.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Position | Self::MotorPosition => "rad",
            Self::Velocity | Self::MotorVelocity => "rad/s",
            Self::Torque | Self::TorqueDesired | Self::FrictionCompensation | Self::LinkTorque => "Nm",
            Self::Temperature | Self::TemperatureAmbient => "degC",
            Self::ExternalWrench => "N, Nm",
        }
    }

    /// How many columns it has on a robot with `joints` joints.
    #[must_use]
    pub fn column_count(self, joints: usize) -> usize {
        match self {
            Self::Time | Self::TemperatureAmbient => 1,
            Self::ExternalWrench => WRENCH_COMPONENTS,
            _ => joints,
        }
    }

    /// Name of its column `index`.
    #[must_use]
    pub fn column_name(self, index: usize) -> String {
        if self.is_single() { self.stem().to_owned() } else { format!("{}{index}", self.stem()) }
    }

    /// The name that viewers make a tree of: `/joint_3/q`, `/O_F_ext/force/x`, `/temperature_ambient`; `time` stays. A name
    /// that is not canonical stays too.
    #[must_use]
    pub fn tree_name(column: &str) -> String {
        match Self::from_canonical_name(column) {
            None | Some((Self::Time, _)) => column.to_owned(),
            Some((Self::ExternalWrench, index)) => {
                format!("/{}/{}", Self::ExternalWrench.label(), WRENCH_LEAVES[index])
            }
            Some((Self::TemperatureAmbient, _)) => format!("/{column}"),
            Some((quantity, joint)) => format!("/joint_{joint}/{}", quantity.label()),
        }
    }

    /// The quantity and index that a column name stands for, canonical or in the form of a tree; `None` for other names.
    #[must_use]
    pub fn from_column_name(name: &str) -> Option<(Self, usize)> {
        let Some(path) = name.strip_prefix('/') else { return Self::from_canonical_name(name) };
        if let Some((joint, label)) = path.strip_prefix("joint_").and_then(|rest| rest.split_once('/')) {
            return Self::from_canonical_name(&format!("{label}_{joint}"))
                .filter(|(quantity, _)| quantity.is_per_joint());
        }
        if let Some(leaf) = path.strip_prefix(Self::ExternalWrench.label()).and_then(|rest| rest.strip_prefix('/')) {
            return Some((Self::ExternalWrench, WRENCH_LEAVES.iter().position(|name| *name == leaf)?));
        }
        Self::from_canonical_name(path).filter(|(quantity, _)| *quantity == Self::TemperatureAmbient)
    }

    /// The name without index: `q`, `tau_J`, `O_F_ext`, `time`.
    #[must_use]
    pub fn label(self) -> &'static str {
        self.stem().trim_end_matches('_')
    }

    /// The quantity of a canonical column name and the index in it; `None` of any other name.
    #[must_use]
    pub fn from_canonical_name(name: &str) -> Option<(Self, usize)> {
        Self::ALL.into_iter().find_map(|quantity| {
            let rest = name.strip_prefix(quantity.stem())?;
            if quantity.is_single() {
                return rest.is_empty().then_some((quantity, 0));
            }
            let digits = !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit());
            let canonical = digits && (rest == "0" || !rest.starts_with('0'));
            let index = if canonical { rest.parse().ok()? } else { return None };
            let limit = quantity.column_count(MAX_JOINTS);
            (index < limit).then_some((quantity, index))
        })
    }

    fn is_single(self) -> bool {
        matches!(self, Self::Time | Self::TemperatureAmbient)
    }

    /// The name without its index.
    fn stem(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Position => "q_",
            Self::Velocity => "dq_",
            Self::Torque => "tau_J_",
            Self::TorqueDesired => "tau_J_d_",
            Self::FrictionCompensation => "tau_friction_",
            Self::LinkTorque => "tau_link_",
            Self::MotorPosition => "theta_",
            Self::MotorVelocity => "dtheta_",
            Self::Temperature => "temperature_",
            Self::TemperatureAmbient => "temperature_ambient",
            Self::ExternalWrench => "O_F_ext_",
        }
    }
}

impl fmt::Display for Quantity {
    /// `time`, `q_i`, `O_F_ext_i`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let index = if self.is_single() { "" } else { "i" };
        write!(f, "{}{index}", self.stem())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_quantities_are_inverse() {
        for quantity in Quantity::ALL {
            for index in 0..quantity.column_count(7) {
                let name = quantity.column_name(index);
                assert_eq!(Quantity::from_column_name(&name), Some((quantity, index)));
                assert_eq!(Quantity::from_column_name(&Quantity::tree_name(&name)), Some((quantity, index)));
            }
        }
    }

    #[test]
    fn near_misses_are_not_canonical() {
        assert_eq!(Quantity::tree_name("tau_J_d_3"), "/joint_3/tau_J_d");
        assert_eq!(Quantity::tree_name("O_F_ext_4"), "/O_F_ext/moment/y");
        assert_eq!((Quantity::tree_name("time"), Quantity::tree_name("note")), ("time".into(), "note".into()));
        for name in
            ["/time", "/q_0", "/joint_0", "/joint_0/x", "/joint_01/q", "/joint_0/O_F_ext", "/O_F_ext/force", "//q_0"]
        {
            assert_eq!(Quantity::from_column_name(name), None, "{name}");
        }
        for name in
            ["", "Time", "q_", "q_-1", "q_01", "q_+1", "q0", "tau_j_0", "O_F_ext_6", "q_64", "q_99999999999999999999"]
        {
            assert_eq!(Quantity::from_column_name(name), None, "{name}");
        }
    }
}
