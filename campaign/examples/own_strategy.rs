//! A campaign from code, and a strategy of your own beside it.
//!
//! `cargo run --release -p tribo-campaign --example own_strategy`
//!
//! Both tune the friction compensator of the simulated Panda. `grey_box` looks at logs; the strategy written here sees J alone and moves
//! along one line: so many times a friction that somebody guessed.

use tribo_campaign::strategy::{FinishedTrial, LogSource, Origin, Past, Proposal, Strategy, StrategyError};
use tribo_campaign::{TuneConfig, ValidTune, run_in_memory, run_numbered};
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_model::FileError;
use tribo_trial::TrialLog;

/// Zero, half and all of the guess, then the lowest point of the parabola through the three best trials.
struct AlongALine {
    guess: Vec<f64>,
}

impl AlongALine {
    fn at(&self, scale: f64) -> Proposal {
        Proposal { theta: self.guess.iter().map(|parameter| scale * parameter).collect(), origin: Origin::Design }
    }
}

impl Strategy<7> for AlongALine {
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError> {
        Ok([0.0, 0.5, 1.0].get(number).map(|&scale| self.at(scale)))
    }

    fn propose(&self, _: usize, past: Past<'_>, _: &dyn LogSource<7>) -> Result<Proposal, StrategyError> {
        let mut trials: Vec<(f64, f64)> =
            past.finished.iter().map(|trial| (trial.theta[0] / self.guess[0], trial.cost.total())).collect();
        trials.sort_by(|a, b| a.1.total_cmp(&b.1));
        let [(a, ja), (b, jb), (c, jc)] = [trials[0], trials[1], trials[2]];
        let (left, right) = ((b - a) * (jb - jc), (b - c) * (jb - ja));
        let lowest = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right);
        Ok(self.at(if lowest.is_finite() { lowest.clamp(0.0, 2.0) } else { a }))
    }
}

/// This strategy looks at no log.
struct NoLogs;

impl LogSource<7> for NoLogs {
    fn log(&self, _number: usize) -> Result<Option<TrialLog<7>>, FileError> {
        Ok(None)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tune: ValidTune<7> = TuneConfig::default().validate()?;
    let guess = FrictionModel::<7>::uniform(CoulombViscous { coulomb_nm: 0.5, viscous_nm_s_per_rad: 0.5 }.into());
    let mine = AlongALine { guess: tune.space.theta(&guess) };
    let mut finished: Vec<FinishedTrial> = Vec::new();
    for number in 0..6 {
        let past = Past { finished: &finished, ..Past::default() };
        let proposal = match mine.design(number)? {
            Some(proposal) => proposal,
            None => mine.propose(number, past, &NoLogs)?,
        };
        let outcome = run_numbered(&tune, number, &proposal.theta)?;
        println!("along a line, trial {number}: J = {:.2} N + Nm", outcome.cost.total());
        let (cost, aborted) = (outcome.cost, outcome.aborted);
        finished.push(FinishedTrial { number, theta: proposal.theta, cost, aborted, origin: proposal.origin });
    }
    for trial in &run_in_memory(&tune)?.trials {
        println!("grey_box, trial {}: J = {:.2} N + Nm ({})", trial.number, trial.cost.total(), trial.origin);
    }
    Ok(())
}
