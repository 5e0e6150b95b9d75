//! `tribo reproduce`.

mod overcompensation;
mod rerun;
mod roveda2022;
mod seeded;
mod uhlmann2023;
mod wrench_pulses;

use tribo_experiments::reproduce::{Linderoth2013, Simoni2017, Simoni2019, shipped};

use crate::arguments::{Common, Reproduce};

/// Reruns the experiment of a paper, which is called by the paper or by its number.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    match arguments.paper.as_str() {
        "linderoth2013" | "02" => {
            seeded::run::<Linderoth2013>("linderoth2013", shipped::LINDEROTH2013, arguments, common)
        }
        "simoni2017" | "03" => seeded::run::<Simoni2017>("simoni2017", shipped::SIMONI2017, arguments, common),
        "simoni2019" | "04" => seeded::run::<Simoni2019>("simoni2019", shipped::SIMONI2019, arguments, common),
        "uhlmann2023" | "05" => uhlmann2023::run(arguments, common),
        "overcompensation" | "09" => overcompensation::run(arguments, common),
        "wrench_pulses" | "07" => wrench_pulses::run(arguments, common),
        _ => roveda2022::run(arguments, common),
    }
}
