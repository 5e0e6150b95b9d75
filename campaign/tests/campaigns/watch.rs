//! What is shown of a campaign against the campaign itself, and the page that stands alone.

use std::path::Path;
use std::sync::Arc;

use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{Campaign, CampaignResult, TuneConfig};
use tribo_trial::{PenaltyLimits, read_trial_log, trial_log_path};
use tribo_watch::{CampaignWatch, Surrogate, TrialSnapshot, loop_times, write_report};

fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

fn run(directory: &Path, config: TuneConfig) -> CampaignResult {
    Campaign::create(directory, config.validate::<7>().unwrap(), clock).unwrap().run(&mut ()).unwrap()
}

fn config(strategy: StrategyName, trials: usize) -> TuneConfig {
    TuneConfig { strategy, trials, ..TuneConfig::default() }
}

/// The snapshot holds the trials to the last bit, and the reference costs follow from the settings.
#[test]
fn a_snapshot_is_the_campaign() {
    let dir = tempfile::tempdir().unwrap();
    let result = run(dir.path(), config(StrategyName::Random, 4));
    let mut watch = CampaignWatch::open(dir.path()).unwrap();
    let snapshot = watch.poll().unwrap().unwrap();
    assert!(watch.poll().unwrap().is_none(), "nothing has changed");
    let trials: Vec<_> = snapshot.trials.iter().map(|watched| watched.trial.clone()).collect();
    assert_eq!(trials, result.trials);
    assert_eq!(snapshot.references, Some(result.references));
    assert_eq!(snapshot.references, Some(watch.tune().references().unwrap()));
    assert_eq!(snapshot.best().map(|best| best.trial.number), result.conclusion.best.map(|best| best.trial));
    assert!(snapshot.is_complete() && !snapshot.torn && snapshot.running.is_empty());
}

/// Where the arm moves, what the rigid-body model leaves unexplained is the plant's friction.
#[test]
fn friction_torque_is_the_truth() {
    let truth = config(StrategyName::Zero, 1).validate::<7>().unwrap().trial.truth;
    let dir = tempfile::tempdir().unwrap();
    run(dir.path(), config(StrategyName::Zero, 1));
    let snapshot = CampaignWatch::open(dir.path()).unwrap().poll().unwrap().unwrap();
    let without = Arc::new(tribo_watch::uncompensated(&snapshot.tune).unwrap());
    let trial =
        TrialSnapshot::read(dir.path(), Arc::clone(&snapshot.tune), snapshot.trials[0].clone(), Some(without)).unwrap();
    for joint in 0..7 {
        let law = &truth.friction.joints[joint];
        // Well above the speeds at which a filter of 0.17 s smears the jump of Coulomb friction.
        for sign in [-1.0, 1.0] {
            let sliding: Vec<f64> = (20..trial.log.len() - 20)
                .filter(|k| (k - 12..k + 12).all(|near| sign * trial.log.qd[joint][near] > 0.02))
                .map(|k| trial.log.friction_torque[joint][k] - law.torque(trial.log.qd[joint][k], 0.0))
                .collect();
            // Twice differentiated encoder noise scatters by 0.1 Nm; over 100 samples and more it averages out.
            let mean = sliding.iter().sum::<f64>() / sliding.len().max(1) as f64;
            assert!(sliding.len() < 100 || mean.abs() < 0.05, "joint {joint}: {mean} Nm over {}", sliding.len());
        }
    }
    let moving = (0..7).filter(|&j| trial.log.qd[j].iter().filter(|qd| qd.abs() > 0.02).count() > 300).count();
    assert!(moving >= 4, "{moving} joints move enough to be judged");
    assert_eq!(trial.row_at(-100.0), 0);
    assert_eq!(trial.row_at(100.0), trial.log.len() - 1);
    assert!((trial.log.time_s[trial.row_at(7.004)] - 7.0).abs() < 1e-9);
}

/// One reading per tick of 33 s at 1 kHz, ascending.
#[test]
fn every_tick_is_timed() {
    let tune = config(StrategyName::Zero, 1).validate::<7>().unwrap();
    let times = loop_times(&tune, &tune.space.zero()).unwrap();
    assert_eq!(times.tick_us.len(), 33_000);
    assert!(times.tick_us.windows(2).all(|pair| pair[0] <= pair[1]) && times.quantile(0.5).unwrap() > 0.0);
    assert_eq!(times.quantile(1.0), times.tick_us.last().copied());
}

/// Three equal trials say nothing about the rest of the space.
#[test]
fn no_belief_without_variety() {
    let dir = tempfile::tempdir().unwrap();
    run(dir.path(), config(StrategyName::Zero, 3));
    let snapshot = CampaignWatch::open(dir.path()).unwrap().poll().unwrap().unwrap();
    assert_eq!(Surrogate::of(&snapshot).unwrap(), None);
}

/// One file: no script, no address, every picture with a title, every heading in its place, failures with reasons.
#[test]
fn the_report_stands_alone() {
    let dir = tempfile::tempdir().unwrap();
    // A limit that half of the trials violate: between the middle two of their largest errors.
    let free = dir.path().join("free");
    // Trusted: the guard would learn from the trials that are stopped, and try something else.
    let random = TuneConfig { guard: None, ..config(StrategyName::Random, 4) };
    run(&free, random.clone());
    let mut largest: Vec<f64> = (0..4)
        .map(|number| {
            let log = read_trial_log::<7>(&trial_log_path(&free, number)).unwrap();
            log.error.iter().map(|error| error.fixed_rows::<3>(3).amax()).fold(0.0, f64::max)
        })
        .collect();
    largest.sort_by(f64::total_cmp);
    let limits = PenaltyLimits { error_m: 0.5 * (largest[1] + largest[2]), ..PenaltyLimits::default() };
    let result = run(&dir.path().join("strict"), TuneConfig { limits, ..random });
    let failed: Vec<_> = result.trials.iter().filter(|trial| trial.aborted.is_some()).collect();
    assert_eq!(failed.len(), 2, "{largest:?}");
    let dir = dir.path().join("strict");
    let page = std::fs::read_to_string(write_report(&dir, None, true).unwrap()).unwrap();

    let address = page.replace("http://www.w3.org/2000/svg", "");
    for word in ["http:", "https:", "src=", "href=", "url(", "@import", "<script", "NaN"] {
        assert!(!address.contains(word), "{word}");
    }
    for tag in ["section", "figure", "table", "svg", "div", "main", "h1", "h2", "h3"] {
        let opened = page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
    }
    let pictures = page.matches("<svg ").count();
    assert!(pictures > 25 && page.matches("<title>").count() == pictures + 1, "{pictures}");
    assert_eq!(page.matches("role=\"img\" aria-label=\"").count(), pictures);
    assert_eq!(page.matches("<h1>").count(), 1);
    assert!(page.contains(&format!("Failed trials ({})", failed.len())));
    for trial in failed {
        let reason = trial.aborted.unwrap();
        assert!(page.contains(&format!("<td class=\"t\">{}</td><td class=\"t\">{reason}</td>", trial.number)));
    }
    assert!(page.len() < 5_000_000, "{} bytes", page.len());
}

/// Equal campaigns in different places have equal reports, to the last byte.
#[test]
fn reports_are_reproducible() {
    let dir = tempfile::tempdir().unwrap();
    let page = |name: &str| {
        run(&dir.path().join(name), config(StrategyName::GreyBox, 4));
        std::fs::read(write_report(&dir.path().join(name), None, false).unwrap()).unwrap()
    };
    assert!(page("here") == page("there"));
}

/// A campaign in the middle has a report too; a directory without one says what is missing.
#[test]
fn unfinished_and_missing_campaigns() {
    let dir = tempfile::tempdir().unwrap();
    let error = write_report(dir.path(), None, true).unwrap_err().to_string();
    assert!(error.contains("holds no campaign.yaml"), "{error}");
    run(dir.path(), config(StrategyName::Random, 2));
    let journal = std::fs::read_to_string(dir.path().join("journal.log")).unwrap();
    let half = journal.find("\"op_code\":6").unwrap() + 300;
    std::fs::write(dir.path().join("journal.log"), &journal[..half]).unwrap();
    let page = std::fs::read_to_string(write_report(dir.path(), None, true).unwrap()).unwrap();
    assert!(page.contains("not finished") && page.contains("last line of the journal is incomplete"));
}
