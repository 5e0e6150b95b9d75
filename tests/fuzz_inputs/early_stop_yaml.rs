//! Why a campaign ended early: `early_stop.yaml`.

use tribo_campaign::EarlyStop;
use tribo_model::to_yaml;

use super::document::{document, written};

/// The end of a campaign is taken only if it is one, and is the same after it was written and read.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    let Some(stop) = EarlyStop::parse(&document) else { return };
    let EarlyStop { trials, expected_gain, least_gain, repeatability, .. } = stop;
    let sizes = [expected_gain, least_gain, repeatability];
    assert!(trials > 0 && sizes.iter().all(|size| size.is_finite() && *size >= 0.0), "{stop:?}");
    let text = to_yaml(&stop).expect("the end can be written");
    assert_eq!(EarlyStop::parse(&written(&text)), Some(stop), "{text}");
}
