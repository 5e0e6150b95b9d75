//! Problems shared by the stories across crates; see `integration/` and `no_alloc/`.
//!
//! The reference problem everywhere is the Panda at its ready pose with the default settings of every crate; a story
//! says in its own header what it changes.

pub mod fuzz_inputs;

use nalgebra::SVector;
use tribo_control::{GuardSettings, ImpedanceSettings, PAPER_PHASES_RAD, SinusoidReference};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::law::CoulombViscous;
use tribo_friction::{BristlePart, Compensator, Curve, FrictionModel, JointEffects, Ripple, VelocitySource};
use tribo_robot::{Kinematics, Plant, PlantLost, Pose, SensorFrame, presets};
use tribo_runtime::{ControlLoop, LoopSettings};
use tribo_sim::{BoxFrictionPlant, DEFAULT_SUB_STEPS, Sensors, Truth, WrenchPulses};
use tribo_trial::{CostMeasure, PenaltyLimits, Trial};

/// A 7-vector, one entry per joint of the Panda.
pub type Joints = SVector<f64, 7>;

/// Control period of every story (s).
pub const DT_S: f64 = 1e-3;

/// Flange pose at the ready configuration, `base_from_flange`.
pub fn ready_flange() -> Pose {
    Kinematics::at(&presets::panda(), &presets::panda_ready_pose()).base_from_flange()
}

/// The compensator's belief "no friction".
pub fn no_friction() -> FrictionModel<7> {
    FrictionModel::uniform(CoulombViscous::default().into())
}

/// A wrench filter with its default settings.
pub fn default_ekf() -> WrenchEkf {
    WrenchEkf::new(WrenchEkfSettings::default())
}

/// Every torque that a compensator knows beyond its law, on every joint; small enough for a loop that is not told.
pub fn all_effects() -> [JointEffects; 7] {
    let ripple = |cycles_per_rev| Ripple { cycles_per_rev, amplitude_nm: 0.05, phase_rad: 0.4 };
    let effects = JointEffects {
        coulomb_nm: 0.05,
        viscous_nm_s_per_rad: 0.1,
        breakaway_minus_coulomb_nm: 0.05,
        stribeck_velocity_rad_s: 0.05,
        asymmetry_nm: 0.02,
        offset_nm: 0.05,
        load_coefficient: 0.002,
        ripples: [10.0, 20.0, 40.0, 160.0].map(ripple),
        spring_nm_per_rad: 0.3,
        spring_rest_rad: 0.1,
        presliding_distance_rad: 1e-3,
        curves: [0.02, 0.1, 0.5].map(|width_rad_s| Curve { amplitude_nm: 0.02, width_rad_s }),
        bristles: [3e-4, 3e-3, 3e-2].map(|distance_rad| BristlePart { amplitude_nm: 0.02, distance_rad }),
    };
    [effects; 7]
}

/// The five truths of the tuning tables.
pub fn five_truths() -> [(&'static str, Truth<7>); 5] {
    [
        ("frictionless", Truth::panda_frictionless()),
        ("coulomb_viscous", Truth::panda_coulomb_viscous()),
        ("stribeck", Truth::panda_stribeck()),
        ("lugre", Truth::panda_lugre()),
        ("gaz", Truth::panda_gaz()),
    ]
}

/// The tuning trial: ready pose, paper trajectory and phases, default gains, sensors and limits.
pub fn tuning_trial(truth: Truth<7>, velocity: VelocitySource) -> Trial<7> {
    Trial {
        truth,
        sensors: Sensors::default(),
        sub_steps: DEFAULT_SUB_STEPS,
        pulses: WrenchPulses::default(),
        model: presets::panda(),
        gears_nm_per_rad: presets::PANDA_JOINT_STIFFNESS_NM_PER_RAD,
        effects: Default::default(),
        start: presets::panda_ready_pose(),
        impedance: ImpedanceSettings::default(),
        reference: SinusoidReference::paper(ready_flange(), PAPER_PHASES_RAD),
        velocity,
        guard: None,
        limits: PenaltyLimits::default(),
        measure: CostMeasure::Paper,
        stopped_at_s: None,
        dt_s: DT_S,
    }
}

/// The bare loop of [`tuning_trial`] with another reference.
pub fn panda_loop(
    reference: SinusoidReference,
    friction: FrictionModel<7>,
    velocity: VelocitySource,
) -> ControlLoop<7, WrenchEkf> {
    loop_with(reference, Compensator::new(friction, velocity))
}

/// The bare loop of [`tuning_trial`] with another reference and any compensator.
pub fn loop_with(reference: SinusoidReference, compensator: Compensator<7>) -> ControlLoop<7, WrenchEkf> {
    let settings = LoopSettings {
        impedance: ImpedanceSettings::default(),
        reference,
        compensator,
        guard: Some(GuardSettings::default()),
        dt_s: DT_S,
    };
    ControlLoop::new(presets::panda(), presets::panda_ready_pose(), settings, default_ekf())
}

/// A simulated Panda whose sensor frames pass through `tamper(tick, frame)` on their way to the loop.
#[derive(Clone, Debug)]
pub struct TamperedPlant<F> {
    /// The honest plant.
    pub inner: BoxFrictionPlant<7>,
    tamper: F,
    ticks: u64,
}

impl<F: FnMut(u64, SensorFrame<7>) -> SensorFrame<7>> TamperedPlant<F> {
    /// Wraps `inner`; the first frame has tick 0.
    pub fn new(inner: BoxFrictionPlant<7>, tamper: F) -> Self {
        Self { inner, tamper, ticks: 0 }
    }
}

impl<F: FnMut(u64, SensorFrame<7>) -> SensorFrame<7>> Plant<7> for TamperedPlant<F> {
    fn sense(&mut self) -> Result<SensorFrame<7>, PlantLost> {
        let frame = (self.tamper)(self.ticks, self.inner.sample());
        self.ticks += 1;
        Ok(frame)
    }

    fn actuate(&mut self, tau_nm: &Joints) {
        self.inner.actuate(tau_nm);
    }
}
