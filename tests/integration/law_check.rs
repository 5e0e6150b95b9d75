//! Story: least squares finds the best parameters of a law; whether the law is of the right kind is another question.
//!
//! The laws that the grey box fits leave less than 1 % of the friction's wrench unexplained on parts of the log that they were not
//! fitted to. Other causes, each large enough to double the cost, leave 4.5 % (a ripple) to 94 % (a spring).

use tribo_campaign::strategy::{Identification, LawCheck, LogSource};
use tribo_campaign::{TuneConfig, run_numbered};
use tribo_model::FileError;
use tribo_sim::Effect;
use tribo_trial::TrialLog;
use tribo_trial::scenario::TruthName;

struct FirstTrial(TrialLog<7>);

impl LogSource<7> for FirstTrial {
    fn log(&self, number: usize) -> Result<Option<TrialLog<7>>, FileError> {
        Ok((number == 0).then(|| self.0.clone()))
    }
}

fn check(truth: TruthName, pose: usize, effects: Vec<Effect>) -> LawCheck {
    let config = TuneConfig { truth, pose, seed: 40 + pose as u64, ..TuneConfig::default() };
    let mut tune = config.validate::<7>().expect("valid settings");
    tune.trial.truth.effects.extend(effects);
    let outcome = run_numbered(&tune, 0, &tune.space.zero()).expect("a trial");
    let identification = Identification::new(&tune).expect("an estimator");
    identification.law_check(1, &FirstTrial(outcome.log)).expect("a check").expect("a log long enough")
}

#[test]
fn the_right_law_passes_in_every_pose() {
    for truth in [TruthName::CoulombViscous, TruthName::Stribeck, TruthName::Lugre, TruthName::Thermal] {
        for pose in 0..3 {
            let check = check(truth.clone(), pose, Vec::new());
            assert!(check.passed() && check.unexplained < 0.015, "{truth:?}, pose {pose}: {check:?}");
        }
    }
}

#[test]
fn other_causes_are_not_taken_for_friction() {
    let causes = [
        Effect::Payload { mass_kg: 0.3, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] },
        Effect::PositionSpring { joint: 5, stiffness_nm_per_rad: 3.0, rest_rad: 1.2 },
        Effect::CoulombAsymmetry { joint: 1, asymmetry_nm: 0.4 },
        Effect::Presliding { joint: 1, presliding_distance_rad: 0.02, amplitude_nm: None },
    ];
    for effect in causes {
        for pose in 0..3 {
            let check = check(TruthName::CoulombViscous, pose, vec![effect.clone()]);
            assert!(!check.passed(), "{effect:?}, pose {pose}: {check:?}");
        }
    }
}
