//! The `friction` section shared by model files and tuned parameters.

use serde::{Deserialize, Serialize};
use tribo_friction::law::{Asymmetric, CoulombViscous, GazSigmoid, Lugre, Stribeck};
use tribo_friction::{FrictionModel, JointFriction};

use crate::{FieldError, SIGN_SMOOTHING_RAD_S};

/// Name of a friction law in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LawName {
    /// Fv qd + Fc sign(qd).
    CoulombViscous,
    /// Coulomb, viscous and Stribeck.
    Stribeck,
    /// The sigmoid of gaz2019.
    GazSigmoid,
    /// Coulomb and viscous by direction.
    Asymmetric,
    /// Bristles.
    Lugre,
}

/// `friction: {law, smoothing_rad_s, sticks, joints: [{…}]}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionSection {
    /// The law of every joint.
    pub law: LawName,
    /// Width of tanh(qd/smoothing) in place of the sign [rad/s].
    #[serde(default = "default_smoothing")]
    pub smoothing_rad_s: f64,
    /// Whether a joint that stops for a moment sticks until the motor asks for more than its friction: on logs that friction is then a straight line
    /// in time over the stop. Simulated joints always stick.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sticks: bool,
    /// Parameters, one entry per joint.
    pub joints: Vec<JointParameters>,
}

fn default_smoothing() -> f64 {
    SIGN_SMOOTHING_RAD_S
}

macro_rules! joint_parameters {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        /// Parameters of one joint; which are needed depends on the law.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct JointParameters {
            $($(#[$doc])* #[serde(default, skip_serializing_if = "Option::is_none")] pub $name: Option<f64>,)+
        }

        impl JointParameters {
            /// The parameters that are given, by name.
            pub fn given(&self) -> Vec<(&'static str, f64)> {
                [$((stringify!($name), self.$name)),+]
                    .into_iter()
                    .filter_map(|(name, value)| value.map(|value| (name, value)))
                    .collect()
            }
        }
    };
}

joint_parameters! {
    /// Coulomb friction Fc (Nm).
    coulomb_nm,
    /// Viscous friction Fv [Nm s/rad].
    viscous_nm_s_per_rad,
    /// Breakaway torque less Coulomb friction (Nm).
    breakaway_minus_coulomb_nm,
    /// Inverse Stribeck velocity [s/rad].
    inverse_stribeck_velocity_s_per_rad,
    /// Stribeck velocity [rad/s], in place of its inverse.
    stribeck_velocity_rad_s,
    /// Shape exponent of the Stribeck curve [-].
    shape,
    /// Height of the sigmoid (Nm).
    phi1_nm,
    /// Steepness of the sigmoid [s/rad].
    phi2_s_per_rad,
    /// Shift of the sigmoid [rad/s].
    phi3_rad_s,
    /// Coulomb friction forwards (Nm).
    coulomb_positive_nm,
    /// Coulomb friction backwards (Nm).
    coulomb_negative_nm,
    /// Viscous friction forwards [Nm s/rad].
    viscous_positive_nm_s_per_rad,
    /// Viscous friction backwards [Nm s/rad].
    viscous_negative_nm_s_per_rad,
    /// Presliding distance (rad).
    presliding_distance_rad,
}

impl FrictionSection {
    /// No friction, joint by joint.
    pub(crate) fn none(joints: usize) -> Self {
        let joint = JointParameters::of(&CoulombViscous::default().into());
        Self {
            law: LawName::CoulombViscous,
            smoothing_rad_s: SIGN_SMOOTHING_RAD_S,
            sticks: false,
            joints: vec![joint; joints],
        }
    }

    /// The section that describes `model`; all joints must follow one law (the first joint's law names it).
    pub fn of<const N: usize>(model: &FrictionModel<N>, smoothing_rad_s: f64) -> Self {
        let law = match model.joints[0] {
            JointFriction::CoulombViscous(_) => LawName::CoulombViscous,
            JointFriction::Stribeck(_) => LawName::Stribeck,
            JointFriction::GazSigmoid(_) => LawName::GazSigmoid,
            JointFriction::Asymmetric(_) => LawName::Asymmetric,
            JointFriction::Lugre(_) => LawName::Lugre,
        };
        Self { law, smoothing_rad_s, sticks: false, joints: model.joints.iter().map(JointParameters::of).collect() }
    }

    /// The friction model; `field` prefixes the path in errors.
    #[inline(never)]
    pub fn to_model<const N: usize>(&self, field: &str) -> Result<FrictionModel<N>, FieldError> {
        FieldError::check(&format!("{field}.smoothing_rad_s"), self.smoothing_rad_s, 0.0, 1.0)?;
        if self.joints.len() != N {
            let allowed = format!("{N} entries, one per joint");
            return Err(FieldError::new(format!("{field}.joints"), format!("{} entries", self.joints.len()), allowed));
        }
        let mut joints = [CoulombViscous::default().into(); N];
        for (j, parameters) in self.joints.iter().enumerate() {
            joints[j] = parameters.law(self.law, &format!("{field}.joints[{j}]"))?;
        }
        Ok(FrictionModel { joints })
    }
}

impl JointParameters {
    /// The parameters of one joint's law.
    pub fn of(joint: &JointFriction) -> Self {
        let none = Self::default();
        match *joint {
            JointFriction::CoulombViscous(law) => {
                Self { coulomb_nm: Some(law.coulomb_nm), viscous_nm_s_per_rad: Some(law.viscous_nm_s_per_rad), ..none }
            }
            JointFriction::Stribeck(law) => Self {
                coulomb_nm: Some(law.coulomb_nm),
                viscous_nm_s_per_rad: Some(law.viscous_nm_s_per_rad),
                breakaway_minus_coulomb_nm: Some(law.breakaway_minus_coulomb_nm),
                inverse_stribeck_velocity_s_per_rad: Some(law.inverse_stribeck_velocity_s_per_rad),
                shape: Some(law.shape),
                ..none
            },
            JointFriction::GazSigmoid(law) => Self {
                phi1_nm: Some(law.phi1_nm),
                phi2_s_per_rad: Some(law.phi2_s_per_rad),
                phi3_rad_s: Some(law.phi3_rad_s),
                ..none
            },
            JointFriction::Asymmetric(law) => Self {
                coulomb_positive_nm: Some(law.coulomb_positive_nm),
                coulomb_negative_nm: Some(law.coulomb_negative_nm),
                viscous_positive_nm_s_per_rad: Some(law.viscous_positive_nm_s_per_rad),
                viscous_negative_nm_s_per_rad: Some(law.viscous_negative_nm_s_per_rad),
                ..none
            },
            JointFriction::Lugre(law) => Self {
                coulomb_nm: Some(law.coulomb_nm),
                viscous_nm_s_per_rad: Some(law.viscous_nm_s_per_rad),
                presliding_distance_rad: Some(law.presliding_distance_rad),
                ..none
            },
        }
    }

    fn law(&self, name: LawName, field: &str) -> Result<JointFriction, FieldError> {
        let mut used = Vec::new();
        let mut need = |key: &'static str, value: Option<f64>, low: f64, high: f64| {
            used.push(key);
            let path = format!("{field}.{key}");
            let value = value.ok_or_else(|| FieldError::new(&path, "missing", format!("{low} to {high}")))?;
            FieldError::check(&path, value, low, high).map(|()| value)
        };
        // A joint torque beyond 1000 Nm or a slope beyond 1e4 is a slip of the unit, not a robot of this kind.
        const TORQUE: f64 = 1e3;
        const SLOPE: f64 = 1e4;
        let law = match name {
            LawName::CoulombViscous => CoulombViscous {
                coulomb_nm: need("coulomb_nm", self.coulomb_nm, 0.0, TORQUE)?,
                viscous_nm_s_per_rad: need("viscous_nm_s_per_rad", self.viscous_nm_s_per_rad, 0.0, SLOPE)?,
            }
            .into(),
            LawName::Stribeck => Stribeck {
                coulomb_nm: need("coulomb_nm", self.coulomb_nm, 0.0, TORQUE)?,
                viscous_nm_s_per_rad: need("viscous_nm_s_per_rad", self.viscous_nm_s_per_rad, 0.0, SLOPE)?,
                breakaway_minus_coulomb_nm: need(
                    "breakaway_minus_coulomb_nm",
                    self.breakaway_minus_coulomb_nm,
                    0.0,
                    TORQUE,
                )?,
                inverse_stribeck_velocity_s_per_rad: match self.stribeck_velocity_rad_s {
                    Some(_) if self.inverse_stribeck_velocity_s_per_rad.is_none() => {
                        1.0 / need("stribeck_velocity_rad_s", self.stribeck_velocity_rad_s, 1e-6, 1e3)?
                    }
                    _ => {
                        need("inverse_stribeck_velocity_s_per_rad", self.inverse_stribeck_velocity_s_per_rad, 0.0, 1e6)?
                    }
                },
                shape: need("shape", self.shape, 0.0, 10.0)?,
            }
            .into(),
            LawName::GazSigmoid => GazSigmoid {
                phi1_nm: need("phi1_nm", self.phi1_nm, 0.0, TORQUE)?,
                phi2_s_per_rad: need("phi2_s_per_rad", self.phi2_s_per_rad, 0.0, SLOPE)?,
                phi3_rad_s: need("phi3_rad_s", self.phi3_rad_s, -10.0, 10.0)?,
            }
            .into(),
            LawName::Asymmetric => Asymmetric {
                coulomb_positive_nm: need("coulomb_positive_nm", self.coulomb_positive_nm, 0.0, TORQUE)?,
                coulomb_negative_nm: need("coulomb_negative_nm", self.coulomb_negative_nm, 0.0, TORQUE)?,
                viscous_positive_nm_s_per_rad: need(
                    "viscous_positive_nm_s_per_rad",
                    self.viscous_positive_nm_s_per_rad,
                    0.0,
                    SLOPE,
                )?,
                viscous_negative_nm_s_per_rad: need(
                    "viscous_negative_nm_s_per_rad",
                    self.viscous_negative_nm_s_per_rad,
                    0.0,
                    SLOPE,
                )?,
            }
            .into(),
            LawName::Lugre => Lugre {
                coulomb_nm: need("coulomb_nm", self.coulomb_nm, 1e-9, TORQUE)?,
                viscous_nm_s_per_rad: need("viscous_nm_s_per_rad", self.viscous_nm_s_per_rad, 0.0, SLOPE)?,
                presliding_distance_rad: need("presliding_distance_rad", self.presliding_distance_rad, 1e-7, 0.1)?,
            }
            .into(),
        };
        match self.given().into_iter().find(|(key, _)| !used.contains(key)) {
            Some((key, value)) => {
                let allowed = format!("not a parameter of this law; its parameters are {}", used.join(", "));
                Err(FieldError::new(format!("{field}.{key}"), value, allowed))
            }
            None => Ok(law),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_survives_the_round_trip() {
        let laws: [JointFriction; 3] = [
            Stribeck {
                coulomb_nm: 0.5,
                viscous_nm_s_per_rad: 1.0,
                breakaway_minus_coulomb_nm: 0.3,
                inverse_stribeck_velocity_s_per_rad: 8.0,
                shape: 1.6,
            }
            .into(),
            GazSigmoid { phi1_nm: 0.5, phi2_s_per_rad: 5.0, phi3_rad_s: -0.04 }.into(),
            Lugre { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0, presliding_distance_rad: 5e-4 }.into(),
        ];
        for law in laws {
            let model = FrictionModel::<7>::uniform(law);
            let section = FrictionSection::of(&model, 0.005);
            let text = crate::to_yaml(&section).unwrap();
            let back: FrictionSection = serde_saphyr::from_str(&text).unwrap();
            assert_eq!(back.to_model::<7>("friction").unwrap(), model);
        }
    }

    #[test]
    fn errors_name_the_joint_and_the_parameter() {
        let mut section = FrictionSection::of(
            &FrictionModel::<7>::uniform(CoulombViscous { coulomb_nm: 0.5, viscous_nm_s_per_rad: 1.0 }.into()),
            0.005,
        );
        section.joints[2].coulomb_nm = Some(-0.5);
        assert_eq!(section.to_model::<7>("friction").unwrap_err().field, "friction.joints[2].coulomb_nm");
        section.joints[2].coulomb_nm = Some(0.5);
        section.joints[4].shape = Some(1.0);
        assert_eq!(section.to_model::<7>("friction").unwrap_err().field, "friction.joints[4].shape");
        section.joints.pop();
        assert_eq!(section.to_model::<7>("friction").unwrap_err().field, "friction.joints");
    }
}
