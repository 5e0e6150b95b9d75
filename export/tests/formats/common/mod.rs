//! What the stories about exports share: tuned files of any law, and programs that may be missing.

#![allow(clippy::expect_used, reason = "test helpers")]

#[path = "../../../../tests/python_witness.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod python_witness;

use std::path::Path;
use std::process::{Command, Stdio};

pub use python_witness::python;
use tribo_export::{Exported, Format, export};
use tribo_friction::law::{Asymmetric, CoulombViscous, GazSigmoid, Lugre, Stribeck};
use tribo_friction::{Compensator, FrictionModel, JointFriction, VelocitySource};
use tribo_model::{FrictionSection, ModelFile, TunedFile, YamlDocument};

pub const SOURCES: [VelocitySource; 3] = [VelocitySource::Measured, VelocitySource::Reference, VelocitySource::Hybrid];

/// Every law, no joint like another.
pub fn laws<const N: usize>() -> Vec<FrictionModel<N>> {
    let each = |law: &dyn Fn(f64) -> JointFriction| FrictionModel {
        joints: std::array::from_fn(|j| law(1.0 + 0.13 * j as f64 + 1e-3 / 3.0)),
    };
    vec![
        each(&|x| CoulombViscous { coulomb_nm: 0.6 * x, viscous_nm_s_per_rad: 0.9 / x }.into()),
        each(&|x| {
            Stribeck {
                coulomb_nm: 0.5 * x,
                viscous_nm_s_per_rad: 1.1 / x,
                breakaway_minus_coulomb_nm: 0.3 * x,
                inverse_stribeck_velocity_s_per_rad: 7.0 * x,
                shape: 1.4 * x,
            }
            .into()
        }),
        each(&|x| GazSigmoid { phi1_nm: 0.55 * x, phi2_s_per_rad: 5.1 * x, phi3_rad_s: 0.04 - 0.03 * x }.into()),
        each(&|x| {
            Asymmetric {
                coulomb_positive_nm: 0.5 * x,
                coulomb_negative_nm: 0.7 / x,
                viscous_positive_nm_s_per_rad: 0.9,
                viscous_negative_nm_s_per_rad: 0.8 * x,
            }
            .into()
        }),
        each(&|x| {
            Lugre { coulomb_nm: 0.6 * x, viscous_nm_s_per_rad: 0.4 * x, presliding_distance_rad: 5e-4 * x }.into()
        }),
    ]
}

/// The file of a law on a robot.
pub fn tuned<const N: usize>(robot: &str, friction: FrictionModel<N>, source: VelocitySource) -> TunedFile {
    let compensator = Compensator::new(friction, source);
    TunedFile {
        cost_sd: None,
        schema: "tribo.tuned/1".to_owned(),
        tribo_version: "0.1.0".to_owned(),
        robot: robot.to_owned(),
        seed: 7,
        trial: 3,
        cost: Some(2.9),
        uncompensated_cost: None,
        velocity: source,
        hybrid_threshold_rad_s: compensator.hybrid_threshold_rad_s,
        friction: FrictionSection::of(&friction, compensator.smoothing_rad_s),
        model: None,
    }
}

/// A model file.
pub fn model(text: &str) -> ModelFile {
    YamlDocument::embedded("model.yaml", &format!("schema: tribo.model/1\n{text}")).parse().expect("a model")
}

/// One of each effect that a compensator adds; joint 2 has none.
pub const EFFECTS: &str = "\
effects:
- {cause: coulomb, joint: 0, delta_coulomb_nm: 0.1}
- {cause: coulomb, joint: 5, delta_coulomb_nm: -0.2}
- {cause: viscous, joint: 1, delta_viscous_nm_s_per_rad: 0.2}
- {cause: stribeck, joint: 3, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.05}
- {cause: coulomb_asymmetry, joint: 4, asymmetry_nm: 0.04}
- {cause: torque_offset, joint: 0, offset_nm: -0.5}
- {cause: load_friction, joint: 1, load_coefficient: 0.06}
- {cause: torque_ripple, joint: 3, cycles_per_rev: 7, amplitude_nm: 0.08, phase_rad: 0.9}
- {cause: torque_ripple, joint: 3, cycles_per_rev: 160, amplitude_nm: 0.02, phase_rad: -0.3}
- {cause: torque_ripple, joint: 4, cycles_per_rev: 12, amplitude_nm: 0.05, phase_rad: 0.1}
- {cause: position_spring, joint: 5, stiffness_nm_per_rad: 1.1, rest_rad: -1.2}
- {cause: presliding, joint: 0, presliding_distance_rad: 0.001}
- {cause: presliding, joint: 4, presliding_distance_rad: 0.003}
- {cause: friction_curve, joint: 6, amplitude_nm: 0.3, width_rad_s: 0.02}
- {cause: friction_curve, joint: 6, amplitude_nm: -0.1, width_rad_s: 0.7}
- {cause: friction_curve, joint: 1, amplitude_nm: 0.2, width_rad_s: 0.4}
- {cause: presliding, joint: 4, presliding_distance_rad: 0.03, amplitude_nm: 0.06}
- {cause: presliding, joint: 1, presliding_distance_rad: 0.002, amplitude_nm: 0.2}
- {cause: presliding, joint: 1, presliding_distance_rad: 0.05, amplitude_nm: -0.3}
";

#[track_caller]
pub fn exported(tuned: &TunedFile, format: Format, name: Option<&str>) -> Exported {
    export(tuned, format, name).expect("can be exported")
}

/// The largest torques of the loss whose name begins so.
#[track_caller]
pub fn largest_nm(exported: &Exported, lost: &str) -> Vec<f64> {
    let loss = exported.losses.iter().find(|loss| loss.lost.starts_with(lost));
    loss.unwrap_or_else(|| panic!("{lost}: {:#?}", exported.losses)).largest_nm.clone().expect("a torque")
}

/// Numbers that are the same in every run, uniform in [0, 1).
pub struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}

/// Whether a program is there.
pub fn there(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// What a program prints; it must succeed without a word on standard error.
#[track_caller]
pub fn output(at: &Path, program: &str, arguments: &[&str]) -> Vec<u8> {
    let output = Command::new(program).current_dir(at).args(arguments).output().expect("the program runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{program} {arguments:?}: {said}");
    output.stdout
}
