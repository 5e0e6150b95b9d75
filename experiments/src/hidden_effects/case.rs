//! One log with something hidden in it.

use std::collections::BTreeSet;

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_regression::{CauseLabel, Nominal};
use tribo_sim::{Effect, RecordingError};

use super::calibration::Calibrated;
use super::chance::Chance;
use super::drawn_effect::DrawnEffect;
use super::outside::{OUTSIDE_NAMES, Outside};
use super::world::{Reality, World};
use super::{Kind, Scenario};

/// A log, the model that lacks something, and what it lacks.
pub struct HiddenCase {
    /// Seed that everything comes from.
    pub seed: u64,
    /// What was asked for.
    pub kind: Kind,
    /// The logs that diagnosis is given.
    pub logs: Vec<RobotLog>,
    /// The model that diagnosis is given.
    pub nominal: Nominal<7>,
    /// How right that model is but for what is hidden.
    pub world: World,
    /// What it lacks of dry friction, viscous friction and offsets beside that, joint by joint (Nm, Nm s/rad, Nm).
    pub lacks: [SVector<f64, 7>; 3],
    /// Causes that the logs have and the model lacks.
    pub hidden: Vec<Effect>,
    /// Name of a torque outside the vocabulary, if there is one.
    pub extra: Option<&'static str>,
    /// Hidden torque over torque noise in the band, of the strongest joint and cause [-]; 0 if nothing is hidden.
    pub strength: f64,
    /// The same logs, noise and all, of the nominal model.
    pub twins: Vec<RobotLog>,
    /// Everything in words.
    pub description: String,
}

impl HiddenCase {
    /// Draws motion, sensors, nominal model and hidden cause from the seed.
    ///
    /// # Errors
    /// A drawn case that cannot be simulated: a bug.
    pub fn draw(seed: u64, kind: Kind, world: World) -> Result<Self, RecordingError> {
        let chance = &mut Chance::new(seed, 2);
        match kind {
            Kind::Single(label, strength) => {
                let [least, most] = strength.range();
                Self::of_causes(seed, kind, world, &[label], &[chance.log_between(least, most)], chance)
            }
            Kind::Pair | Kind::Triple => {
                let labels = several_causes(if kind == Kind::Pair { 2 } else { 3 }, chance);
                let strengths: Vec<f64> = labels.iter().map(|_| chance.log_between(1.0, 8.0)).collect();
                Self::of_causes(seed, kind, world, &labels, &strengths, chance)
            }
            Kind::Null => Self::of_causes(seed, kind, world, &[], &[], chance),
            Kind::OutsideVocabulary => Self::outside(seed, world, chance),
        }
    }

    /// A case with these causes; without any, the motion suits a cause that is absent, or none.
    fn of_causes(
        seed: u64,
        kind: Kind,
        world: World,
        labels: &[CauseLabel],
        strengths: &[f64],
        chance: &mut Chance,
    ) -> Result<Self, RecordingError> {
        let pretext = match kind {
            Kind::Null if chance.happens(0.7) => vec![chance.pick(&CauseLabel::ALL[..19])],
            _ => labels.to_vec(),
        };
        let dual_encoder = pretext.contains(&CauseLabel::Backlash)
            || (pretext.contains(&CauseLabel::JointElasticity) && chance.happens(0.5));
        let mut scenario = Scenario::draw(&pretext, dual_encoder, noise_range_nm(labels, strengths), world, seed);

        // Each cause alone has its strength.
        let (mut hidden, mut taken, mut sizes) = (Vec::new(), Vec::new(), Vec::<Calibrated>::new());
        for (label, strength) in labels.iter().zip(strengths) {
            let shortest_s = scenario.shortest_s();
            let drawn = DrawnEffect::draw(*label, &scenario.nominal, world, &taken, shortest_s, dual_encoder, chance);
            let Some(drawn) = drawn else { continue };
            let calibrated = scenario.calibrate(&drawn, *strength)?;
            if let Some(joint) = drawn.carried_by_friction_of {
                let law = &mut scenario.nominal.friction.joints[joint];
                *law = law.scaled(calibrated.size);
                scenario.reality.truth.friction.joints[joint] = *law;
            }
            let effect = drawn.sized(calibrated.size);
            taken.extend(effect.joint());
            hidden.push(effect);
            sizes.push(calibrated);
        }
        Self::recorded(seed, kind, world, &scenario, hidden, &sizes, None, chance)
    }

    fn outside(seed: u64, world: World, chance: &mut Chance) -> Result<Self, RecordingError> {
        let outside = Outside::draw(OUTSIDE_NAMES[(seed % 10) as usize], chance);
        let pretext = chance.pick(&[CauseLabel::Payload, CauseLabel::Viscous, CauseLabel::CoulombAsymmetry]);
        let scenario = Scenario::draw(&[pretext], false, TORQUE_SD_NM, world, seed);
        let calibrated = scenario.calibrate_outside(&outside, chance.log_between(1.5, 8.0))?;
        let outside = outside.sized(calibrated.size);
        Self::recorded(
            seed,
            Kind::OutsideVocabulary,
            world,
            &scenario,
            Vec::new(),
            &[calibrated],
            Some(&outside),
            chance,
        )
    }

    fn recorded(
        seed: u64,
        kind: Kind,
        world: World,
        scenario: &Scenario,
        hidden: Vec<Effect>,
        sizes: &[Calibrated],
        outside: Option<&Outside>,
        chance: &mut Chance,
    ) -> Result<Self, RecordingError> {
        let log_seed = chance.seed();
        // The same seed draws the same noise, whatever is hidden.
        let logs = scenario.logs(&hidden, outside, scenario.recording, log_seed)?;
        let twins =
            scenario.logs_of(&Reality::of_nominal(&scenario.nominal), &[], None, scenario.recording, log_seed)?;
        let strengths = sizes.iter().map(|size| {
            format!("{:.2}{}", size.strength, if size.clamped { " (bound by what is plausible)" } else { "" })
        });
        let strengths: Vec<String> = strengths.collect();
        let causes: Vec<String> = hidden.iter().map(|effect| format!("{effect:?}")).collect();
        let extra = outside.map(|outside| format!("{} on joint {}", outside.name, outside.joint));
        let description = format!(
            "{}{}; strength {}; {}",
            causes.join(" + "),
            extra.unwrap_or_default(),
            strengths.join(", "),
            scenario.description
        );
        Ok(Self {
            seed,
            kind,
            logs,
            nominal: scenario.nominal.clone(),
            lacks: scenario.reality.lacks,
            world,
            hidden,
            extra: outside.map(|outside| outside.name),
            strength: sizes.iter().map(|size| size.strength).fold(0.0, f64::max),
            twins,
            description,
        })
    }
}

/// Torque noise of arms (Nm).
const TORQUE_SD_NM: [f64; 2] = [0.02, 0.15];
/// Torque noise (Nm) that divides quiet arms from noisy ones.
const MIDDLE_SD_NM: f64 = 0.06;

/// Torque noise that lets a cause of bounded size have its strength: noisy for weak ones, quiet for strong ones.
fn noise_range_nm(labels: &[CauseLabel], strengths: &[f64]) -> [f64; 2] {
    let bounded =
        |label| matches!(label, CauseLabel::ThermalFriction | CauseLabel::TimeDelay | CauseLabel::JointElasticity);
    match (labels, strengths) {
        ([label], [strength]) if bounded(*label) && *strength < 1.0 => [MIDDLE_SD_NM, TORQUE_SD_NM[1]],
        ([label], [strength]) if bounded(*label) && *strength > 3.0 => [TORQUE_SD_NM[0], MIDDLE_SD_NM],
        _ => TORQUE_SD_NM,
    }
}

/// Different causes, at most one of them on the whole arm or a link.
fn several_causes(count: usize, chance: &mut Chance) -> Vec<CauseLabel> {
    const OF_THE_ARM: [CauseLabel; 5] = [
        CauseLabel::Payload,
        CauseLabel::BaseTilt,
        CauseLabel::LinkInertial,
        CauseLabel::TimeDelay,
        CauseLabel::ExternalContact,
    ];
    // Two hours of short cycles show neither a single push nor what needs a fast clock.
    const NOT_IN_SESSIONS: [CauseLabel; 5] = [
        CauseLabel::ExternalContact,
        CauseLabel::TorqueRipple,
        CauseLabel::Presliding,
        CauseLabel::TimeDelay,
        CauseLabel::JointElasticity,
    ];
    let causes: Vec<CauseLabel> = Kind::causes().collect();
    loop {
        let drawn: Vec<CauseLabel> = (0..count).map(|_| chance.pick(&causes)).collect();
        let of_the_arm = drawn.iter().filter(|label| OF_THE_ARM.contains(label)).count();
        let session = drawn.contains(&CauseLabel::ThermalFriction);
        let misfit = session && drawn.iter().any(|label| NOT_IN_SESSIONS.contains(label));
        let different = drawn.iter().collect::<BTreeSet<_>>().len() == count;
        if different && of_the_arm <= 1 && !misfit {
            return drawn;
        }
    }
}
