//! Bayesian optimisation of any function of yours, by ask and tell.
//!
//! `cargo run --release -p tribo-bayesopt --example any_function`

use tribo_bayesopt::{Domain, Outcome, Settings, Study};

/// What is to be low: settling time (s) of a second-order system by its stiffness (N/m) and damping (N s/m). Unstable ones fail.
fn settling_time_s(stiffness: f64, damping: f64) -> Option<f64> {
    let (mass_kg, dt_s) = (1.0, 1e-3);
    let (mut x, mut v, mut settled_s) = (1.0_f64, 0.0_f64, 0.0);
    for k in 0..10_000 {
        v += dt_s * (-stiffness * x - damping * v) / mass_kg;
        x += dt_s * v;
        if x.abs() > 0.02 {
            settled_s = f64::from(k) * dt_s;
        }
    }
    (damping > 0.5).then_some(settled_s)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let names = vec!["stiffness_n_per_m".to_owned(), "damping_n_s_per_m".to_owned()];
    let domain = Domain::new(names, vec![1.0, 0.0], vec![100.0, 40.0])?;
    let settings = Settings { init_trials: 6, ..Settings::bo(vec![50.0, 5.0]) };
    let mut study = Study::new(settings, domain, 1)?;
    for _ in 0..25 {
        let suggestion = study.ask()?;
        let outcome = match settling_time_s(suggestion.point[0], suggestion.point[1]) {
            Some(time_s) => Outcome::Value(time_s),
            None => Outcome::FAILED,
        };
        study.tell(suggestion.trial, outcome)?;
    }
    let (trial, time_s) = study.incumbent().ok_or("a trial that finished")?;
    let point = &study.history().trials[trial].point;
    println!("lowest {time_s:.3} s, in trial {trial}: {:.1} N/m, {:.1} N s/m", point[0], point[1]);
    Ok(())
}
