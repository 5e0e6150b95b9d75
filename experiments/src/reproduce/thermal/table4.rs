//! Table 4 of simoni2019: a model with and without temperature over five hours of work.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::thermal::ThermalJoint;
use tribo_sim::{JointWarmth, WarmJoint};

/// Peak speeds of the validation motion as parts of the fastest.
const PEAKS: [f64; 7] = [0.10, 0.25, 0.40, 0.55, 0.70, 0.85, 1.0];
/// Length of a cycle (s): three minutes, never resting.
const CYCLE_S: f64 = 180.0;
/// Samples per second of the validation (Hz).
const RATE_HZ: f64 = 10.0;

/// One row of the table, over a cycle of three minutes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table4Row {
    /// End of the cycle (min).
    pub minute: f64,
    /// Standard deviation of the error (Nm): with temperature, without.
    pub sd_nm: [f64; 2],
    /// Variance of the error over that of the friction [%]: with, without.
    pub unexplained_percent: [f64; 2],
    /// Temperature of the model and of the true gears (°C).
    pub temperature_c: [f64; 2],
}

/// Rows at 3, 33, … 273 min. Velocities are none of the identification's; the model's temperature starts in the room and
/// follows its own heat balance, without an observer.
pub fn validate(
    truth: &WarmJoint,
    model: &ThermalJoint,
    top_speed_rad_s: f64,
    noise_sd_nm: f64,
    room_c: f64,
    seed: u64,
) -> Vec<Table4Row> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let (law, dt) = (model.law(), 1.0 / RATE_HZ);
    let (mut warmth, mut believed) = (JointWarmth::rested(room_c), room_c);
    let per_cycle = (CYCLE_S * RATE_HZ) as usize;
    let mut rows = Vec::new();
    for cycle in 1..=91 {
        // Sums of x and x²: error with, error without, friction.
        let mut sums = [[0.0_f64; 2]; 3];
        for k in 0..per_cycle {
            let t = k as f64 * dt;
            let peak = top_speed_rad_s * PEAKS[(t / CYCLE_S * PEAKS.len() as f64) as usize % PEAKS.len()];
            let qd = peak * (std::f64::consts::TAU * t / 3.91).sin();
            let measured = truth.friction_nm(qd, warmth.gear_c) + noise_sd_nm * rng.sample::<f64, _>(StandardNormal);
            let errors =
                [measured - law.torque_nm(qd, believed), measured - law.torque_nm(qd, law.reference_c), measured];
            for (sum, x) in sums.iter_mut().zip(errors) {
                sum[0] += x;
                sum[1] += x * x;
            }
            warmth = truth.warmed(warmth, qd, room_c, dt);
            believed = model.warmed_c(believed, qd, room_c, dt);
        }
        if cycle % 10 != 1 {
            continue;
        }
        let n = per_cycle as f64;
        let [with, without, friction] = sums.map(|[sum, square]| square / n - (sum / n).powi(2));
        rows.push(Table4Row {
            minute: f64::from(cycle) * CYCLE_S / 60.0,
            sd_nm: [with.sqrt(), without.sqrt()],
            unexplained_percent: [100.0 * with / friction, 100.0 * without / friction],
            temperature_c: [believed, warmth.gear_c],
        });
    }
    rows
}
