//! The promises of the ask/tell surface: purity, resumption, and survival of anything a robot may report.

use crate::common::{PROBLEMS, given_history};
use tribo_bayesopt::{
    Allowed, BayesoptError, Domain, History, Outcome, Phase, Settings, Study, suggest, suggest_allowed,
};

fn presets(dimension: usize) -> Vec<Settings> {
    vec![Settings::paper(), Settings::bo(vec![0.0; dimension]), Settings::random(), Settings::sobol()]
}

fn bowl(x: &[f64]) -> f64 {
    1.0 + x.iter().map(|x| (x - 0.3).powi(2)).sum::<f64>()
}

#[test]
fn same_inputs_give_same_bits_and_other_seeds_other_points() {
    let problem = &PROBLEMS[1];
    let domain = Domain::unit_cube(problem.dimension).unwrap();
    let history = given_history(problem, 3);
    for settings in presets(problem.dimension) {
        let first = suggest(&settings, &domain, &history, 5).unwrap();
        assert_eq!(first, suggest(&settings, &domain, &history, 5).unwrap());
        if settings.model.is_none() {
            assert_ne!(first.point, suggest(&settings, &domain, &history, 6).unwrap().point);
        }
    }
}

#[test]
fn a_study_killed_and_resumed_from_its_journal_goes_on_bit_for_bit() {
    for settings in presets(3) {
        let domain = Domain::unit_cube(3).unwrap();
        let mut whole = Study::new(settings.clone(), domain.clone(), 11).unwrap();
        for k in 0..16 {
            // Every third step is killed: what survives is the journal, here its JSON text.
            if k % 3 == 2 {
                let journal = serde_json::to_string(whole.history()).unwrap();
                let history: History = serde_json::from_str(&journal).unwrap();
                let mut resumed = Study::resume(settings.clone(), domain.clone(), 11, history).unwrap();
                assert_eq!(resumed.ask().unwrap(), whole.clone().ask().unwrap());
            }
            let suggestion = whole.ask().unwrap();
            whole.tell(suggestion.trial, Outcome::Value(bowl(&suggestion.point))).unwrap();
        }
    }
}

#[test]
fn the_design_is_known_before_any_value() {
    let domain = Domain::unit_cube(14).unwrap();
    for settings in presets(14) {
        let mut study = Study::new(settings.clone(), domain.clone(), 2).unwrap();
        for i in 0..settings.init_trials {
            let suggestion = study.ask().unwrap();
            assert_eq!(suggestion.phase, Phase::Design);
            assert_eq!(suggestion.point, settings.design_point(&domain, i, 2).unwrap());
        }
    }
}

#[test]
fn pending_trials_are_not_proposed_again() {
    let domain = Domain::unit_cube(2).unwrap();
    let mut study = Study::new(Settings::bo(vec![0.5, 0.5]), domain, 4).unwrap();
    for _ in 0..10 {
        let suggestion = study.ask().unwrap();
        study.tell(suggestion.trial, Outcome::Value(bowl(&suggestion.point))).unwrap();
    }
    let batch: Vec<_> = (0..4).map(|_| study.ask().unwrap().point).collect();
    for i in 0..4 {
        for j in 0..i {
            let apart = batch[i].iter().zip(&batch[j]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart > 1e-3, "{batch:?}");
        }
    }
}

#[test]
fn the_order_in_which_robots_report_does_not_matter() {
    let told = |order: [usize; 3]| {
        let mut study = Study::new(Settings::bo(vec![0.2; 3]), Domain::unit_cube(3).unwrap(), 6).unwrap();
        let asked: Vec<_> = (0..12).map(|_| study.ask().unwrap()).collect();
        for block in asked.chunks(3) {
            for k in order {
                study.tell(block[k].trial, Outcome::Value(bowl(&block[k].point))).unwrap();
            }
        }
        study.ask().unwrap()
    };
    assert_eq!(told([0, 1, 2]), told([2, 0, 1]));
}

#[test]
fn duplicated_not_a_number_infinite_and_failed_outcomes_survive() {
    let domain = Domain::unit_cube(3).unwrap();
    let outcomes: Vec<Vec<Outcome>> = vec![
        vec![Outcome::Value(2.0); 12],
        vec![Outcome::FAILED; 12],
        vec![Outcome::Failed { value: Some(900.0), part: None }; 12],
        vec![Outcome::Value(f64::NAN); 12],
        vec![Outcome::Pending; 12],
        (0..12)
            .map(|i| match i % 4 {
                0 => Outcome::Value(f64::INFINITY),
                1 => Outcome::Value(f64::from(i)),
                2 => Outcome::FAILED,
                _ => Outcome::Value(-1e250),
            })
            .collect(),
    ];
    for settings in presets(3) {
        for outcomes in &outcomes {
            for repeated in [false, true] {
                let mut history = History::new();
                for (i, outcome) in outcomes.iter().enumerate() {
                    let place = if repeated { 0 } else { i };
                    history.push(settings.design_point(&domain, place, 1).unwrap(), *outcome);
                }
                let suggestion = suggest(&settings, &domain, &history, 1).unwrap();
                assert!(suggestion.point.iter().all(|x| (0.0..=1.0).contains(x)), "{suggestion:?}");
                if let Some(evidence) = suggestion.evidence {
                    assert!(evidence.jitter.is_finite() && evidence.mean.is_finite() && evidence.sd > 0.0);
                    assert!(suggestion.acquisition.unwrap().is_finite());
                }
            }
        }
    }
}

#[test]
fn every_dimension_from_one_to_fifty_is_served() {
    for dimension in [1, 2, 3, 7, 14, 20, 21, 35, 50] {
        let domain =
            Domain::new((0..dimension).map(|i| format!("p{i}")).collect(), vec![-2.0; dimension], vec![5.0; dimension])
                .unwrap();
        for settings in presets(dimension) {
            let mut study = Study::new(settings, domain.clone(), 1).unwrap();
            for _ in 0..13 {
                let suggestion = study.ask().unwrap();
                assert!(suggestion.point.iter().all(|x| (-2.0..=5.0).contains(x)));
                study.tell(suggestion.trial, Outcome::Value(bowl(&suggestion.point))).unwrap();
            }
            let above = study.settings().model.as_ref().and_then(|model| model.trust_region_above);
            let evidence = study.ask().unwrap().evidence;
            assert!(
                evidence.is_none_or(|at| at.trust_region.is_some() == above.is_some_and(|above| dimension > above))
            );
        }
    }
}

#[test]
fn a_history_of_a_thousand_trials_is_served() {
    let problem = &PROBLEMS[4];
    let domain = Domain::unit_cube(problem.dimension).unwrap();
    let mut history = History::new();
    for i in 0..1000 {
        let point = Settings::sobol().design_point(&domain, i, 1).unwrap();
        let value = (problem.value)(&point);
        history.push(point, Outcome::Value(value));
    }
    for settings in presets(problem.dimension) {
        let suggestion = suggest(&settings, &domain, &history, 1).unwrap();
        assert_eq!(suggestion.trial, 1000);
        assert!(suggestion.evidence.is_none_or(|evidence| evidence.observations == 1000));
    }
}

#[test]
fn a_history_that_does_not_fit_is_refused() {
    let domain = Domain::unit_cube(2).unwrap();
    let mut history = History::new();
    history.push(vec![0.5], Outcome::Value(1.0));
    let short = suggest(&Settings::random(), &domain, &history, 1);
    assert_eq!(short, Err(BayesoptError::DimensionMismatch { need: 2, got: 1 }));
    history.trials[0].point = vec![0.5, f64::NAN];
    let nan = Study::resume(Settings::random(), domain, 1, history);
    assert!(matches!(nan, Err(BayesoptError::NonFiniteCoordinate { index: 1, .. })));
}

/// The first coordinate at most 0.2, all together at most 0.5, by scaling them.
#[derive(Debug)]
struct Budget(Vec<f64>);

impl Allowed for Budget {
    fn highest(&self) -> &[f64] {
        &self.0
    }

    fn hold_back(&self, point: &mut [f64]) {
        point[0] = point[0].min(0.2);
        let sum: f64 = point.iter().sum();
        if sum > 0.5 {
            point.iter_mut().for_each(|x| *x *= 0.5 / sum);
        }
    }
}

#[test]
fn the_model_proposes_only_what_is_allowed() {
    for dimension in [2, 25] {
        let domain = Domain::unit_cube(dimension).unwrap();
        let mut history = History::new();
        let settings = Settings::bo(vec![0.0; dimension]);
        for i in 0..settings.init_trials + 3 {
            let point = settings.design_point(&domain, i, 7).unwrap();
            // The further from zero, the better.
            let cost = 1.0 + point.iter().map(|x| (x - 0.9).powi(2)).sum::<f64>();
            history.push(point, Outcome::Value(cost));
        }
        let free = suggest(&settings, &domain, &history, 7).unwrap().point;
        assert!(free.iter().sum::<f64>() > 0.6, "{free:?}");
        let mut highest = vec![0.5; dimension];
        highest[0] = 0.2;
        let kept = suggest_allowed(&settings, &domain, Some(&Budget(highest)), &history, 7).unwrap().point;
        assert!(kept[0] <= 0.2 + 1e-12 && kept.iter().sum::<f64>() <= 0.5 + 1e-12, "{kept:?}");
        // It goes to the limit, as what it was told asks for.
        assert!(kept.iter().sum::<f64>() > 0.4, "{kept:?}");
    }
}
