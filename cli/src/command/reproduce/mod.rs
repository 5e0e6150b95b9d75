//! `tribo reproduce`.

mod overcompensation;
mod rerun;
mod roveda2022;
mod seeded;
mod uhlmann2023;
mod wrench_pulses;

use tribo_experiments::reproduce::{Linderoth2013, Simoni2017, Simoni2019};

use crate::arguments::{Common, Reproduce};

/// Reruns the experiment of a paper, which is called by the paper or by its number.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    match arguments.paper.as_str() {
        "linderoth2013" | "02" => {
            let settings = include_str!("../../../../experiments/02_linderoth2013/config.yaml");
            seeded::run::<Linderoth2013>("linderoth2013", settings, arguments, common)
        }
        "simoni2017" | "03" => {
            let settings = include_str!("../../../../experiments/03_simoni2017/config.yaml");
            seeded::run::<Simoni2017>("simoni2017", settings, arguments, common)
        }
        "simoni2019" | "04" => {
            let settings = include_str!("../../../../experiments/04_simoni2019/config.yaml");
            seeded::run::<Simoni2019>("simoni2019", settings, arguments, common)
        }
        "uhlmann2023" | "05" => uhlmann2023::run(arguments, common),
        "overcompensation" | "09" => overcompensation::run(arguments, common),
        "wrench_pulses" | "07" => wrench_pulses::run(arguments, common),
        _ => roveda2022::run(arguments, common),
    }
}
