//! How right the nominal model is but for what is hidden.

use nalgebra::{SVector, Vector3};
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_regression::Nominal;
use tribo_robot::{Arm, presets};
use tribo_sim::{Effect, SoftFriction, Truth};

use super::chance::Chance;

/// Error of a link's mass, inertia, and centre of mass over its gyration radius, least and largest [-].
const LINK_ERROR: [f64; 2] = [0.03, 0.05];
/// Largest error of friction [-].
const FRICTION_ERROR: f64 = 0.2;
/// Largest torque offset over a joint's torque limit [-].
const OFFSET: f64 = 0.006;

/// Where the nominal model comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum World {
    /// Out of an identification: the truth is the nominal model and what is hidden.
    #[default]
    Identified,
    /// Out of a CAD file, of a robot in another physics engine: every link, friction and offset is wrong by a little, and dry friction is
    /// [`SoftFriction`].
    WrongEverywhere,
}

/// The arm under the hidden causes.
#[derive(Clone, Debug)]
pub struct Reality {
    /// Arm and friction laws.
    pub truth: Truth<7>,
    /// Dry friction in their place.
    pub soft: Option<SoftFriction<7>>,
    /// What the nominal model lacks of dry friction, viscous friction and offsets, joint by joint (Nm, Nm s/rad, Nm).
    pub lacks: [SVector<f64, 7>; 3],
}

impl Reality {
    /// The nominal model itself.
    pub(super) fn of_nominal(nominal: &Nominal<7>) -> Self {
        let truth = Truth::new(nominal.arm.clone(), nominal.friction);
        Self { truth, soft: None, lacks: [SVector::zeros(); 3] }
    }

    /// Another arm of the same kind; `soft` chooses the engine's dry friction over the smooth sign.
    pub(super) fn beside(nominal: &Nominal<7>, soft: bool, chance: &mut Chance) -> Self {
        let arm = other_links(&nominal.arm, chance);
        let mut other = |of: f64| of * (1.0 + chance.between(-FRICTION_ERROR, FRICTION_ERROR));
        let dry = SVector::<f64, 7>::from_fn(|j, _| other(nominal.dry_nm(j)));
        let viscous = SVector::<f64, 7>::from_fn(|j, _| other(nominal.viscous_nm_s(j)));
        let offset = nominal.arm.limits.tau_max_nm.map(|largest| OFFSET * largest * chance.between(-1.0, 1.0));
        let joints = std::array::from_fn(|j| {
            let coulomb_nm = if soft { 0.0 } else { dry[j] };
            CoulombViscous { coulomb_nm, viscous_nm_s_per_rad: viscous[j] }.into()
        });
        let mut truth = Truth::new(arm, FrictionModel { joints });
        truth.effects = (0..7).map(|joint| Effect::TorqueOffset { joint, offset_nm: offset[joint] }).collect();
        let engine = SoftFriction::of(&truth.arm, &presets::panda_ready_pose(), dry);
        let nominal_dry = SVector::<f64, 7>::from_fn(|j, _| nominal.dry_nm(j));
        let nominal_viscous = SVector::<f64, 7>::from_fn(|j, _| nominal.viscous_nm_s(j));
        Self { truth, soft: engine.filter(|_| soft), lacks: [dry - nominal_dry, viscous - nominal_viscous, offset] }
    }
}

/// Every link wrong by some percent.
fn other_links(arm: &Arm<7>, chance: &mut Chance) -> Arm<7> {
    arm.clone().altered(|arm| {
        for link in &mut arm.links {
            let mut error = || chance.side() * chance.between(LINK_ERROR[0], LINK_ERROR[1]);
            let gyration_m = (link.inertia_kg_m2.trace() / (2.0 * link.mass_kg.max(1e-9))).max(0.0).sqrt();
            link.mass_kg *= 1.0 + error();
            link.com_m += Vector3::from_fn(|_, _| error() * gyration_m);
            link.inertia_kg_m2 *= 1.0 + error();
        }
    })
}
