//! Campaigns that end when there is nothing left to gain.

use std::path::Path;

use tribo_campaign::strategy::{FinishedTrial, StrategyName};
use tribo_campaign::{
    Campaign, CampaignError, CampaignObserver, CampaignResult, Changes, EarlyStop, StopBelow, TuneConfig,
};
use tribo_watch::CampaignWatch;

fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

fn config(share: Option<f64>) -> TuneConfig {
    let stop_below = share.map(StopBelow::Share);
    TuneConfig { strategy: StrategyName::Bo, trials: 30, init: 5, stop_below, ..TuneConfig::default() }
}

/// Asks to stop after so many trials.
struct Killed {
    after: usize,
    seen: usize,
}

impl CampaignObserver for Killed {
    fn trial_finished(&mut self, _: &FinishedTrial) {
        self.seen += 1;
    }

    fn stop_requested(&mut self) -> bool {
        self.seen >= self.after
    }
}

fn killed(directory: &Path, after: usize) {
    let campaign = Campaign::create(directory, config(Some(0.2)).validate::<7>().unwrap(), clock).unwrap();
    let end = campaign.run(&mut Killed { after, seen: 0 });
    assert!(matches!(end, Err(CampaignError::Stopped { .. })), "{end:?}");
}

fn resumed(directory: &Path) -> CampaignResult {
    Campaign::<7>::resume(directory, Changes::default(), clock).unwrap().run(&mut ()).unwrap()
}

#[test]
fn a_resumed_campaign_ends_at_the_same_trial() {
    let [whole, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let campaign = Campaign::create(whole.path(), config(Some(0.2)).validate::<7>().unwrap(), clock).unwrap();
    let result = campaign.run(&mut ()).unwrap();
    let stop = result.early_stop.unwrap();
    assert!(stop.trials == result.trials.len() && (7..30).contains(&stop.trials), "{stop:?}");
    assert!(stop.expected_gain < stop.least_gain, "{stop:?}");
    assert_eq!(EarlyStop::read(whole.path()), Some(stop));

    // Killed in the last but one trial, resumed; and resumed again after its end.
    killed(other.path(), stop.trials - 1);
    let snapshot = CampaignWatch::open(other.path()).unwrap().poll().unwrap().unwrap();
    assert!(!snapshot.is_complete());
    // Who looks now sees the trial that is believed best, and not the luckiest.
    assert_eq!(snapshot.conclusion.as_ref().map(|conclusion| conclusion.trials), Some(stop.trials - 1));
    for _ in 0..2 {
        let again = resumed(other.path());
        assert_eq!((again.early_stop, again.trials), (Some(stop), result.trials.clone()));
    }
    let snapshot = CampaignWatch::open(other.path()).unwrap().poll().unwrap().unwrap();
    assert!(snapshot.is_complete() && snapshot.early_stop == Some(stop));
    assert_eq!(
        std::fs::read(whole.path().join("tuned.yaml")).unwrap(),
        std::fs::read(other.path().join("tuned.yaml")).unwrap()
    );
}

#[test]
fn the_setting_is_checked() {
    let refused = |config: TuneConfig| config.validate::<7>().unwrap_err().to_string();
    assert!(refused(config(Some(0.0))).contains("stop_below"));
    assert!(refused(config(Some(0.6))).contains("at most 0.5"));
    let blind = TuneConfig { strategy: StrategyName::Sobol, ..config(Some(0.1)) };
    assert!(refused(blind).contains("bo and composite"));
}
