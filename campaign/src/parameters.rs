//! The parameters a campaign tunes.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};
use tribo_bayesopt::{BayesoptError, Domain};
use tribo_friction::law::{CoulombViscous, GazSigmoid, Stribeck};
use tribo_friction::{FrictionModel, JointFriction};

use crate::strategy_name::StrategyName;

/// Friction law of the compensator that is tuned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TunedLaw {
    /// Two parameters per joint, roveda2022 eq. (27).
    #[default]
    CoulombViscous,
    /// Five parameters per joint, roveda2022 eq. (28).
    Stribeck,
    /// The sigmoid of gaz2019, three parameters per joint; the published constants are the baseline `gaz`.
    GazSigmoid,
}

/// Which box the parameters live in: the paper's bounds read in two ways (its section 5.4 contradicts its eqs. 27–28), or the arm's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bounds {
    /// By index, as printed: Fv ≤ 5 Nm s/rad, Fc ≤ 2.5 Nm; Fv, Fc, dF ≤ 1.5, 1/vs ≤ 10 s/rad, shape ≤ 2.5.
    Literal,
    /// As wide as the arm is strong: Fc up to a quarter of the torque limit of each joint (Nm), other torques in the proportion of the
    /// literal box, and nowhere narrower than that.
    TorqueLimits,
    /// By unit: Fc ≤ 5 Nm, Fv ≤ 2.5 Nm s/rad; Fc, dF ≤ 1.5 Nm, vs ≤ 1.5 rad/s, Fv ≤ 10 Nm s/rad, shape in 0.5–2.5.
    UnitConsistent,
}

/// Share of a joint's torque limit that its dry friction may reach: geared joints of arms lose 5 to 15 % of it.
const SHARE_OF_LIMIT: f64 = 0.25;

impl Bounds {
    /// The box of a campaign that was told nothing: least squares does not mind how wide it is, a search that knows J alone does.
    pub fn default_of(strategy: StrategyName) -> Self {
        if strategy == StrategyName::GreyBox { Self::TorqueLimits } else { Self::Literal }
    }

    /// How many times as wide in torque as that of a Panda's joint the box of each joint is, of an arm whose friction is so many times a
    /// Panda's; torque limits in Nm.
    pub(crate) fn scale<const N: usize>(
        self,
        friction_times_panda: [f64; N],
        tau_max_nm: &SVector<f64, N>,
    ) -> Vec<f64> {
        let joint = |(times, most_nm): (f64, &f64)| match self {
            Self::TorqueLimits => times.max(SHARE_OF_LIMIT * most_nm / LITERAL_COULOMB_NM),
            Self::Literal | Self::UnitConsistent => times,
        };
        friction_times_panda.into_iter().zip(tau_max_nm).map(joint).collect()
    }
}

/// Largest dry friction of the paper's box (Nm).
const LITERAL_COULOMB_NM: f64 = 2.5;

/// One tuned parameter: its name in files and its bounds.
type Entry = (&'static str, f64, f64);

/// The space of one campaign: a law, its box, N joints; joint by joint, in the order of the paper's indices.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSpace {
    /// The law.
    pub law: TunedLaw,
    /// The box, of joints as large as a Panda's.
    pub bounds: Bounds,
    /// How many times as wide as that the box of each joint is in torque.
    pub box_scale: Vec<f64>,
}

impl ParameterSpace {
    /// Parameters of one joint as large as a Panda's: (name, lower, upper).
    fn of_joint(&self) -> &'static [Entry] {
        match (self.law, self.bounds) {
            (TunedLaw::CoulombViscous, Bounds::Literal | Bounds::TorqueLimits) => {
                &[("viscous_nm_s_per_rad", 0.0, 5.0), ("coulomb_nm", 0.0, LITERAL_COULOMB_NM)]
            }
            (TunedLaw::CoulombViscous, Bounds::UnitConsistent) => {
                &[("viscous_nm_s_per_rad", 0.0, 2.5), ("coulomb_nm", 0.0, 5.0)]
            }
            (TunedLaw::Stribeck, Bounds::Literal | Bounds::TorqueLimits) => &[
                ("viscous_nm_s_per_rad", 0.0, 1.5),
                ("coulomb_nm", 0.0, 1.5),
                ("breakaway_minus_coulomb_nm", 0.0, 1.5),
                ("inverse_stribeck_velocity_s_per_rad", 0.0, 10.0),
                ("shape", 0.0, 2.5),
            ],
            // A Stribeck velocity of zero would be no curve at all: below 0.02 rad/s it is narrower than the sensor's noise.
            (TunedLaw::Stribeck, Bounds::UnitConsistent) => &[
                ("viscous_nm_s_per_rad", 0.0, 10.0),
                ("coulomb_nm", 0.0, 1.5),
                ("breakaway_minus_coulomb_nm", 0.0, 1.5),
                ("stribeck_velocity_rad_s", 0.02, 1.5),
                ("shape", 0.5, 2.5),
            ],
            (TunedLaw::GazSigmoid, _) => {
                &[("phi1_nm", 0.0, 2.5), ("phi2_s_per_rad", 0.0, 30.0), ("phi3_rad_s", -0.1, 0.1)]
            }
        }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.box_scale.len()
    }

    /// Number of parameters of one joint.
    pub fn parameters_per_joint(&self) -> usize {
        self.of_joint().len()
    }

    /// Names of the parameters of one joint.
    pub fn names_of_joint(&self) -> impl Iterator<Item = &'static str> + use<> {
        self.of_joint().iter().map(|entry| entry.0)
    }

    /// All parameters, joint by joint: (name, lower, upper).
    pub fn entries(&self) -> Vec<Entry> {
        let scaled = |scale: f64| {
            move |&(name, low, high): &Entry| {
                if is_torque(name) { (name, scale * low, scale * high) } else { (name, low, high) }
            }
        };
        self.box_scale.iter().flat_map(|scale| self.of_joint().iter().map(scaled(*scale))).collect()
    }

    /// Number of parameters of all joints.
    pub fn dimension(&self) -> usize {
        self.joints() * self.parameters_per_joint()
    }

    /// Names `joint_0.coulomb_nm` … of all parameters.
    pub fn names(&self) -> Vec<String> {
        let joint = |j: usize| self.names_of_joint().map(move |name| format!("joint_{j}.{name}"));
        (0..self.joints()).flat_map(joint).collect()
    }

    /// The box as the optimiser's domain.
    pub fn domain(&self) -> Result<Domain, BayesoptError> {
        let (lower, upper) = self.entries().into_iter().map(|entry| (entry.1, entry.2)).unzip();
        Domain::new(self.names(), lower, upper)
    }

    /// No compensation: every torque zero (speeds and shapes at the middle of their ranges).
    pub fn zero(&self) -> Vec<f64> {
        let value = |entry: Entry| match entry.0 {
            "inverse_stribeck_velocity_s_per_rad" | "stribeck_velocity_rad_s" | "shape" | "phi2_s_per_rad" => {
                0.5 * (entry.1 + entry.2)
            }
            _ => 0.0,
        };
        self.entries().into_iter().map(value).collect()
    }

    /// The parameters of a vector of another law that this one has too; all others as without compensation.
    pub fn embedded(&self, other: &Self, theta: &[f64]) -> Vec<f64> {
        let (names, mut embedded) = (other.names(), self.zero());
        for (value, name) in embedded.iter_mut().zip(self.names()) {
            if let Some(k) = names.iter().position(|known| *known == name) {
                *value = theta[k];
            }
        }
        embedded
    }

    /// A sentence for each torque parameter that lies at the upper end of its box: the arm may have more friction than it can say.
    pub fn at_bounds(&self, theta: &[f64]) -> Vec<String> {
        let per_joint = self.parameters_per_joint();
        let entries = self.entries().into_iter().zip(theta).enumerate();
        let reached =
            entries.filter(|(_, ((name, _, high), value))| is_torque(name) && **value >= *high * (1.0 - 1e-9));
        let sentence = |(k, ((name, _, high), _)): (usize, (Entry, &f64))| {
            let joint = k / per_joint;
            let widen = if self.bounds == Bounds::TorqueLimits { "" } else { " (--bounds torque_limits widens it)" };
            format!("joint {joint}: {name} is at its bound of {high:.3}, so the friction may be larger{widen}")
        };
        reached.map(sentence).collect()
    }

    /// Multiplies every torque of a joint in a parameter vector; speeds and shapes stay.
    pub fn scale_torques(&self, theta: &mut [f64], joint: usize, factor: f64) {
        let k = self.parameters_per_joint();
        for (value, name) in theta.iter_mut().skip(joint * k).zip(self.names_of_joint()) {
            if is_torque(name) {
                *value *= factor;
            }
        }
    }

    /// The friction model of a parameter vector of length [`Self::dimension`].
    pub fn friction<const N: usize>(&self, theta: &[f64]) -> FrictionModel<N> {
        FrictionModel { joints: std::array::from_fn(|j| self.law_of(theta, j)) }
    }

    /// The friction law of every joint in a parameter vector.
    pub fn joint_laws(&self, theta: &[f64]) -> Vec<JointFriction> {
        (0..self.joints()).map(|j| self.law_of(theta, j)).collect()
    }

    fn law_of(&self, theta: &[f64], joint: usize) -> JointFriction {
        let k = self.parameters_per_joint();
        self.joint(theta.get(joint * k..(joint + 1) * k).unwrap_or(&[]))
    }

    fn joint(&self, theta: &[f64]) -> JointFriction {
        let at = |i: usize| theta.get(i).copied().unwrap_or(0.0);
        match self.law {
            TunedLaw::CoulombViscous => CoulombViscous { viscous_nm_s_per_rad: at(0), coulomb_nm: at(1) }.into(),
            TunedLaw::Stribeck => Stribeck {
                viscous_nm_s_per_rad: at(0),
                coulomb_nm: at(1),
                breakaway_minus_coulomb_nm: at(2),
                inverse_stribeck_velocity_s_per_rad: match self.bounds {
                    Bounds::Literal | Bounds::TorqueLimits => at(3),
                    Bounds::UnitConsistent => 1.0 / at(3),
                },
                shape: at(4),
            }
            .into(),
            TunedLaw::GazSigmoid => GazSigmoid { phi1_nm: at(0), phi2_s_per_rad: at(1), phi3_rad_s: at(2) }.into(),
        }
    }

    /// The parameter vector that comes closest to a friction model inside the box.
    pub fn theta<const N: usize>(&self, friction: &FrictionModel<N>) -> Vec<f64> {
        let (entries, unbounded) = (self.entries(), self.unbounded(friction));
        unbounded.into_iter().zip(entries).map(|(value, (_, low, high))| value.clamp(low, high)).collect()
    }

    /// The parameter vector that comes closest to a friction model, be it inside the box or not.
    pub fn unbounded<const N: usize>(&self, friction: &FrictionModel<N>) -> Vec<f64> {
        let (zero, k) = (self.zero(), self.parameters_per_joint());
        let joint = |j: usize| {
            let (coulomb, viscous, stribeck) = match friction.joints[j] {
                JointFriction::CoulombViscous(law) => (law.coulomb_nm, law.viscous_nm_s_per_rad, None),
                JointFriction::Stribeck(law) => (law.coulomb_nm, law.viscous_nm_s_per_rad, Some(law)),
                JointFriction::Lugre(law) => (law.coulomb_nm, law.viscous_nm_s_per_rad, None),
                JointFriction::Asymmetric(law) => (
                    0.5 * (law.coulomb_positive_nm + law.coulomb_negative_nm),
                    0.5 * (law.viscous_positive_nm_s_per_rad + law.viscous_negative_nm_s_per_rad),
                    None,
                ),
                JointFriction::GazSigmoid(_) => (0.0, friction.joints[j].set_valued(0.0).viscous_nm_s_per_rad, None),
            };
            match (self.law, stribeck) {
                (TunedLaw::GazSigmoid, _) => match friction.joints[j] {
                    JointFriction::GazSigmoid(law) => vec![law.phi1_nm, law.phi2_s_per_rad, law.phi3_rad_s],
                    _ => zero[j * k..(j + 1) * k].to_vec(),
                },
                (TunedLaw::CoulombViscous, _) => vec![viscous, coulomb],
                (TunedLaw::Stribeck, None) => vec![viscous, coulomb, 0.0, zero[j * k + 3], zero[j * k + 4]],
                (TunedLaw::Stribeck, Some(law)) => {
                    let inverse = law.inverse_stribeck_velocity_s_per_rad;
                    let speed = match self.bounds {
                        Bounds::Literal | Bounds::TorqueLimits => inverse,
                        Bounds::UnitConsistent => 1.0 / inverse,
                    };
                    vec![viscous, coulomb, law.breakaway_minus_coulomb_nm, speed, law.shape]
                }
            }
        };
        (0..self.joints()).flat_map(joint).collect()
    }
}

/// Whether the torque of a law is proportional to this parameter, the others of its kind together.
fn is_torque(name: &str) -> bool {
    matches!(name, "viscous_nm_s_per_rad" | "coulomb_nm" | "breakaway_minus_coulomb_nm" | "phi1_nm")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_and_models_are_inverse_inside_the_box() {
        for law in [TunedLaw::CoulombViscous, TunedLaw::Stribeck] {
            for bounds in [Bounds::Literal, Bounds::UnitConsistent, Bounds::TorqueLimits] {
                let space = ParameterSpace { law, bounds, box_scale: vec![1.0, 1.0, 1.0, 1.5, 1.0, 1.0, 1.0] };
                let domain = space.domain().unwrap();
                let unit: Vec<f64> = (0..space.dimension()).map(|i| 0.2 + 0.6 * ((i * 7) % 11) as f64 / 11.0).collect();
                let theta = domain.from_unit(&unit).unwrap();
                let back = space.theta(&space.friction::<7>(&theta));
                for (a, b) in theta.iter().zip(&back) {
                    assert!((a - b).abs() < 1e-12);
                }
                assert_eq!(space.friction::<7>(&space.zero()).torque(&SVector::repeat(0.3), 0.001).amax(), 0.0);
            }
        }
    }

    /// A box in torque goes with the friction of the arm, that of the torque limits is never narrower than its share of them.
    #[test]
    fn the_box_goes_with_the_arm() {
        let tau_max_nm = SVector::<f64, 2>::new(87.0, 330.0);
        assert_eq!(Bounds::Literal.scale([1.0, 6.0], &tau_max_nm), [1.0, 6.0]);
        assert_eq!(Bounds::UnitConsistent.scale([1.0, 6.0], &tau_max_nm), [1.0, 6.0]);
        let scale = Bounds::TorqueLimits.scale([1.0, 40.0], &tau_max_nm);
        assert!((LITERAL_COULOMB_NM * scale[0] - SHARE_OF_LIMIT * 87.0).abs() < 1e-12 && scale[0] > 1.0, "{scale:?}");
        assert_eq!(scale[1], 40.0, "a quarter of 330 Nm is less than forty times the paper's box");
        let space =
            ParameterSpace { law: TunedLaw::CoulombViscous, bounds: Bounds::Literal, box_scale: vec![1.0, 6.0] };
        let largest = space.friction::<2>(&space.domain().unwrap().from_unit(&[1.0; 4]).unwrap());
        let [light, heavy] = [0, 1].map(|j| largest.torque(&SVector::repeat(1.0), 1e-3)[j]);
        assert!((heavy / light - 6.0).abs() < 1e-9, "{light} {heavy}");
    }
}
