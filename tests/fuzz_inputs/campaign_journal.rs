//! The journal of a campaign whose trials the user runs, beside its settings.

use tribo_campaign::UserCampaign;
use tribo_watch::CampaignWatch;

use super::scratch::{directory, put};

/// The cheapest strategy; its trials run elsewhere.
const SETTINGS: &[u8] = b"schema: tribo.tune/1\nstrategy: sobol\ntrials: 3\ninit: 3\nuser_trials: {}\n";

fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

/// A campaign is refused, or can be asked; what it answers is in its boxes. Watching it never fails in another way.
pub fn check(input: &[u8]) {
    let directory = directory().join("campaign");
    std::fs::create_dir_all(&directory).expect("a directory");
    put(&directory.join("campaign.yaml"), SETTINGS);
    put(&directory.join("journal.log"), input);
    let watched = CampaignWatch::open(&directory).and_then(|mut watch| watch.poll());
    match UserCampaign::<7>::open(&directory, clock) {
        Ok(mut campaign) => {
            assert!(watched.is_ok(), "{watched:?}");
            let (finished, running) = (campaign.finished().count(), campaign.running().len());
            if let Ok(asked) = campaign.ask(false) {
                assert!(finished + running < 3, "{finished} told, {running} running");
                assert!(asked.theta.iter().all(|value| value.is_finite()), "{:?}", asked.theta);
                campaign.give_up(asked.number).expect("a running trial can be given up");
            }
        }
        Err(error) => assert!(error.to_string().contains("campaign"), "{error}"),
    }
}
