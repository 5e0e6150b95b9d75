//! What is known of an arm before its log is read: the families of causes, how large each usually is, how rare.

use tribo_regression::CauseLabel;

use crate::joint_term::JointTerm;

/// Causes of one kind at all joints: one switch, one scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Constant torques.
    Offset,
    /// Dry and viscous friction.
    CoulombViscous,
    /// Friction that bends with speed.
    Curve,
    /// Dry friction that grows with the load.
    Load,
    /// Rotor inertia.
    Rotor,
    /// Dry friction that builds up over a distance.
    Presliding,
    /// Dry friction that leads the velocity.
    Lead,
    /// Torque over the joint angle.
    Ripple,
    /// Scale of the torque signals.
    Gain,
    /// Direction of gravity.
    Tilt,
    /// Lateness of the torque signals.
    Delay,
    /// Springs across joints.
    Spring,
    /// A body at the flange.
    Payload,
    /// Inertial parameters of the links.
    Links,
}

/// What is known of a family.
#[derive(Clone, Copy, Debug)]
pub struct FamilyPrior {
    /// Decimal logarithm of the odds that an arm shows it.
    pub log10_odds: f64,
    /// Largest scale that evidence may give it, over the usual one; 1 forbids more than usual.
    pub most_scale: f64,
    /// Whether evidence chooses its scale at all.
    pub scaled: bool,
    /// Whether every fit has it.
    pub always: bool,
    /// Whether no gear has it, but a simulator: a fit has it only where [`super::simulated`] says so.
    pub simulated: bool,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Offset,
        Self::CoulombViscous,
        Self::Curve,
        Self::Load,
        Self::Rotor,
        Self::Presliding,
        Self::Lead,
        Self::Ripple,
        Self::Gain,
        Self::Tilt,
        Self::Delay,
        Self::Spring,
        Self::Payload,
        Self::Links,
    ];

    /// The table. Odds are rough counts over published identifications; a factor of three in any scale changes the torque
    /// predicted for unseen motion by 2 % (kuka_lwr4, ur10_unisa, panda_gaz2019 and three robots held out).
    pub fn prior(self, link_side: bool) -> FamilyPrior {
        let usual = FamilyPrior { log10_odds: 0.0, most_scale: 3.0, scaled: true, always: false, simulated: false };
        match self {
            // Every sensor has an offset, every gear friction.
            Self::Offset | Self::CoulombViscous => FamilyPrior { always: true, ..usual },
            Self::Curve | Self::Load | Self::Rotor => FamilyPrior { log10_odds: -1.0, ..usual },
            Self::Lead => FamilyPrior { log10_odds: -6.0, simulated: true, ..usual },
            Self::Presliding | Self::Ripple | Self::Tilt | Self::Delay | Self::Payload => {
                FamilyPrior { log10_odds: -2.0, ..usual }
            }
            // The maker calibrates torque sensors; the constant of a motor's current is known to some percent.
            Self::Gain => FamilyPrior { log10_odds: -2.0, most_scale: if link_side { 1.0 } else { 3.0 }, ..usual },
            // Gravity over a small range looks like a spring, and is far commoner.
            Self::Spring => FamilyPrior { log10_odds: -6.0, most_scale: 1.0, ..usual },
            // Left to evidence the links' scale grows until they eat the payload.
            Self::Links => FamilyPrior { log10_odds: -1.0, scaled: false, ..usual },
        }
    }

    /// Those that a real arm may show.
    pub fn of_gears(link_side: bool) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |family| !family.prior(link_side).simulated)
    }

    /// The labels that findings of this family carry.
    pub fn labels(self) -> &'static [CauseLabel] {
        match self {
            Self::Offset => &[CauseLabel::TorqueOffset],
            Self::CoulombViscous => &[CauseLabel::Coulomb, CauseLabel::Viscous],
            Self::Curve => &[CauseLabel::FrictionCurve],
            Self::Load => &[CauseLabel::LoadFriction],
            Self::Rotor => &[CauseLabel::RotorInertia],
            Self::Presliding => &[CauseLabel::Presliding],
            Self::Lead => &[],
            Self::Ripple => &[CauseLabel::TorqueRipple],
            Self::Gain => &[CauseLabel::TorqueGain],
            Self::Tilt => &[CauseLabel::BaseTilt],
            Self::Delay => &[CauseLabel::TimeDelay],
            Self::Spring => &[CauseLabel::PositionSpring],
            Self::Payload => &[CauseLabel::Payload],
            Self::Links => &[CauseLabel::LinkInertial],
        }
    }
}

/// Widths of the friction curves over the joint's largest speed [-]: gears bend anywhere from creeping to full speed.
pub const CURVE_WIDTHS: [f64; 3] = [0.02, 0.08, 0.3];
/// Largest widths of the friction curves over the largest speed that the logs show [-]: a curve that is wider is a straight line to the logs,
/// and anything beyond them.
const WIDTHS_OVER_SHOWN: [f64; 3] = [0.1, 0.3, 0.6];
/// Dry friction at whose widths a leading friction is looked for, over the joint's torque [-]: from that of a strong base to that of a wrist of
/// a low-cost arm.
const LEAD_LOSS: [f64; 3] = [0.003, 0.015, 0.075];
/// Distances of presliding (rad): what harmonic drives show at the joint.
pub const PRESLIDING_RAD: [f64; 3] = [1e-3, 3e-3, 1e-2];
/// Largest number of waves per revolution of a joint's slowest ripple: a joint that moves less than a sixth of a turn has none.
pub(crate) const MOST_WAVES: usize = 6;
/// Scale of the links' pseudo-inertia: 3 % of mass, 3 % of a gyration radius of their centre of mass. CAD models are about
/// that good; see lee2020 for the metric.
pub(crate) const LINK_SCALE: f64 = 0.03;
/// Radius of gyration of a payload about its centre of mass (m).
pub(crate) const PAYLOAD_RADIUS_M: f64 = 0.05;
/// Distance of its centre of mass from the flange, one standard deviation (m).
const PAYLOAD_ARM_M: f64 = 0.05;

/// Stiffness of a hose or cable that every arm may have [Nm/rad].
const SPRING_NM_PER_RAD: f64 = 0.1;

/// What the sizes of usual effects go with.
#[derive(Clone, Debug)]
pub struct ArmScale {
    /// Largest torque of each joint (Nm).
    pub torque_nm: Vec<f64>,
    /// Largest speed of each joint [rad/s].
    pub speed_rad_s: Vec<f64>,
    /// Largest speed of each joint in the logs [rad/s]; of one that stands, a tenth of what it can.
    pub shown_speed_rad_s: Vec<f64>,
    /// Torque per speed of a physics engine's soft friction while it stops each joint [Nm s/rad].
    pub soft_damping_nm_s: Vec<f64>,
    /// Waves per revolution of the slowest ripple of each joint: the first whose length it covers.
    pub slowest_ripple: Vec<Option<usize>>,
    /// Mass that the arm is built to carry (kg).
    pub rated_payload_kg: f64,
    /// Whether torques are measured behind the gears.
    pub link_side: bool,
}

impl ArmScale {
    /// Standard deviations of the parameters of one joint, by [`JointTerm`].
    pub fn joint_sd(&self, joint: usize, term: JointTerm) -> f64 {
        use JointTerm as Term;
        let (torque, speed) = (self.torque_nm[joint], self.speed_rad_s[joint]);
        match term {
            Term::Offset => 0.01 * torque,
            Term::Coulomb => 0.05 * torque,
            // At half the speed as much as dry friction.
            Term::Viscous => 0.05 * torque / (0.5 * speed),
            Term::Curve(_) | Term::Presliding(_) => 0.02 * torque,
            Term::Lead(_) => 0.05 * torque,
            Term::Load => 0.05,
            // Up to .002 on an LWR4+; joints without any are common.
            Term::Sine(_) | Term::Cosine(_) => 1e-3 * torque,
            // Behind the gears no rotor is felt, but for what the sensor's own mass is.
            Term::Rotor => torque * if self.link_side { 5e-4 } else { 5e-3 },
            Term::Spring => (3e-3 * torque).max(SPRING_NM_PER_RAD),
        }
    }

    /// Widths of friction that leads the velocity [rad/s]: those at which the constraint of a physics engine reaches a usual dry friction; of
    /// a light joint they are wide.
    pub fn lead_width_rad_s(&self, joint: usize, k: usize) -> f64 {
        (LEAD_LOSS[k] * self.torque_nm[joint] / self.soft_damping_nm_s[joint]).min(self.speed_rad_s[joint])
    }

    /// Width of a friction curve of a joint [rad/s].
    pub fn curve_width_rad_s(&self, joint: usize, k: usize) -> f64 {
        f64::min(CURVE_WIDTHS[k] * self.speed_rad_s[joint], WIDTHS_OVER_SHOWN[k] * self.shown_speed_rad_s[joint])
    }

    /// Waves per revolution of a ripple of a joint.
    pub fn waves_per_rev(&self, joint: usize, ripple: usize) -> Option<f64> {
        self.slowest_ripple[joint].map(|slowest| (slowest + ripple) as f64)
    }

    /// Standard deviation of a torque signal's scale [-].
    pub fn gain_sd(&self) -> f64 {
        if self.link_side { 0.01 } else { 0.07 }
    }

    /// Standard deviation of a tilt (rad).
    pub const TILT_SD_RAD: f64 = 0.01;
    /// Standard deviation of a delay (s).
    pub const DELAY_SD_S: f64 = 5e-3;

    /// Standard deviations of a payload's mass (kg) and first moments about the flange [kg m].
    pub fn payload_sd(&self) -> [f64; 4] {
        let mass = 0.5 * self.rated_payload_kg;
        [mass, PAYLOAD_ARM_M * mass, PAYLOAD_ARM_M * mass, PAYLOAD_ARM_M * mass]
    }
}
