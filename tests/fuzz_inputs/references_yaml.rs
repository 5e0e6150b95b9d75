//! What a campaign leaves for whoever watches it: `references.yaml`.

use tribo_campaign::References;

use super::document::document;

/// Reference costs are taken only if they are costs.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    if let Some(References { uncompensated, oracle, frictionless, .. }) = References::parse(&document) {
        let costs = [uncompensated, oracle, frictionless];
        assert!(costs.iter().all(|cost| cost.is_finite() && *cost >= 0.0), "{costs:?}");
    }
}
