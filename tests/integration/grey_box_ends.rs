//! A campaign that is left alone is good after its second trial, ends by itself, and never delivers something worse: on noise that none of its trials
//! has seen. A sample of the table of experiment 08, which has forty campaigns of each.

use tribo_experiments::grey_box_ends::grey_box_to_its_end;

/// J over that of the true friction that no campaign exceeds.
const WORST: f64 = 1.15;
/// Standard errors by which the final set may seem worse than that of trial 2: one campaign in seven by chance exceeds one.
const BY_CHANCE: f64 = 2.5;

#[test]
fn a_campaign_that_is_left_alone_ends_well() {
    for (truth, seed) in [("coulomb_viscous", 101), ("stribeck", 102), ("lugre", 103), ("gaz", 104), ("soft", 105)] {
        let ended = grey_box_to_its_end(truth, seed).unwrap_or_else(|error| panic!("{truth} {seed}: {error}"));
        println!("{truth} {seed}: {ended:?}");
        assert!(ended.second <= WORST && ended.best <= WORST, "{truth} {seed}: {ended:?}");
        assert!(ended.gain[0] <= BY_CHANCE * ended.gain[1], "{truth} {seed}: {ended:?}");
        assert!(ended.trials <= 6, "{truth} {seed}: {ended:?}");
    }
}
