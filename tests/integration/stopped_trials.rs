//! Story: people stop trials; what they stopped is not taken for tried.

use tribo_campaign::strategy::Origin;
use tribo_campaign::{StopBelow, TuneConfig, run_in_memory};
use tribo_trial::AbortReason;

/// Trials of least squares before the Bayesian ones.
const FITS: usize = 3;

#[test]
fn least_squares_goes_on_until_its_trials_were_seen_to_the_end() {
    let (mut stopped, mut corrected) = (0, 0);
    for seed in 0..6 {
        let config = TuneConfig {
            seed,
            trials: 8,
            failure_rate: 0.5,
            stop_below: Some(StopBelow::Never),
            ..TuneConfig::default()
        };
        let trials = run_in_memory(&config.validate::<7>().expect("valid settings")).expect("a campaign").trials;
        for (number, _) in trials.iter().enumerate().filter(|(_, trial)| trial.origin == Origin::Model) {
            let seen =
                |origin: Origin| trials[..number].iter().filter(move |it| it.origin == origin && it.aborted.is_none());
            let fits = seen(Origin::LeastSquares).count() + seen(Origin::Constant).count();
            assert!(fits > FITS, "seed {seed}: trial {number} is a correction after {fits} trials that were seen");
            corrected += 1;
        }
        stopped += trials.iter().filter(|trial| trial.aborted == Some(AbortReason::Stopped)).count();
    }
    // Otherwise the story has not been told.
    assert!(stopped > 12 && corrected > 5, "{stopped} {corrected}");
}
