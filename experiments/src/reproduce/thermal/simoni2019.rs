//! Friction model with temperature of one joint (simoni2019): identification, Table 4, time constants, observer.

use serde::{Deserialize, Serialize};
use tribo_friction::thermal::{
    CapacityAnchor, HeatBalance, InjectedPower, PolynomialStribeck, TemperatureFactor, ThermalJoint, ThermalLaw,
};
use tribo_residual::{ObserverGain, ObserverSettings};
use tribo_sim::{JointWarmth, WarmJoint};

use super::observer_run::ObserverRun;
use super::table4::validate;
use super::{DutyCycleStudy, ObserverTrace, Table4Row};
use crate::reproduce::{ExperimentError, Quantity, SeedRun};
use tribo_model::FieldError;

/// α [1/K] and β [-] of joint 2 in the paper.
const ALPHA_PER_K: f64 = -0.009_37;
const BETA: f64 = 0.917_08;
/// Time constants (min) of the paper at 25, 50, 75 and 100 % of the power.
const TIME_CONSTANTS_MIN: [f64; 4] = [101.38, 89.51, 81.58, 73.96];
/// Standard deviation of the error (Nm) and unexplained variance (%) of the paper's Table 4, with temperature and without.
const TABLE4: [[f64; 4]; 10] = [
    [48.4991, 49.4382, 2.59, 2.69],
    [43.6194, 106.0872, 4.00, 23.69],
    [45.5116, 128.5030, 5.40, 43.06],
    [50.1176, 140.2410, 7.30, 57.18],
    [53.3136, 147.8523, 8.88, 68.28],
    [55.3255, 152.3702, 9.97, 75.63],
    [57.0318, 154.7700, 10.79, 79.49],
    [58.2405, 156.4537, 11.39, 82.17],
    [58.7912, 157.6204, 11.71, 84.18],
    [59.3544, 158.1072, 11.96, 84.46],
];
/// Observer gains η [K/(Nm s)] and windows N that the paper tries.
const GAINS: [f64; 3] = [5e-3, 5e-2, 5e-1];
const WINDOWS: [usize; 2] = [20, 40];
/// |T̂ − T| (K) below which the observer counts as settled.
const SETTLED_K: f64 = 2.0;

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simoni2019 {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one.
    pub seeds: u64,
    /// Temperature of the room (°C).
    pub room_c: f64,
    /// Fastest peak speed of the joint [rad/s]; 155 deg/s in the paper.
    pub top_speed_rad_s: f64,
    /// c0 … c3 of the true friction [Nm, Nm s/rad, …].
    pub polynomial: [f64; 4],
    /// Standard deviation of the torque (Nm), unfiltered.
    pub noise_sd_nm: f64,
    /// Part of the heat capacity that is in the gears, of the rest in the housing.
    pub gear_share: f64,
    /// Part of the thermal resistance that is between gears and housing.
    pub gear_resistance_share: f64,
    /// Length of each identification session (min).
    pub identification_min: f64,
    /// How well the heat capacity is known beforehand [-].
    pub capacity_relative_sd: f64,
    /// Constant disturbance (Nm) of two minutes.
    pub disturbance_nm: f64,
}

/// What a figure needs of one seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Simoni2019Trace {
    /// Table 4 as measured.
    pub table: Vec<Table4Row>,
    /// One observer run per gain with N = 40, then the Kalman gain.
    pub observers: Vec<(String, ObserverTrace)>,
    /// The disturbance, with the observer always on and behind the gate.
    pub disturbed: [ObserverTrace; 2],
}

impl Simoni2019 {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        FieldError::check("room_c", self.room_c, -20.0, 60.0)?;
        FieldError::check("top_speed_rad_s", self.top_speed_rad_s, 0.1, 10.0)?;
        for c in self.polynomial {
            FieldError::check("polynomial", c, -1e4, 1e4)?;
        }
        FieldError::check("noise_sd_nm", self.noise_sd_nm, 0.01, 1e3)?;
        FieldError::check("gear_share", self.gear_share, 0.05, 0.95)?;
        FieldError::check("gear_resistance_share", self.gear_resistance_share, 0.01, 0.95)?;
        FieldError::check("identification_min", self.identification_min, 60.0, 1000.0)?;
        FieldError::check("capacity_relative_sd", self.capacity_relative_sd, 1e-4, 1.0)?;
        FieldError::check("disturbance_nm", self.disturbance_nm, 0.0, 1e3)
    }

    /// What is measured, in the order of the values.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all: Vec<Quantity> = ["25", "50", "75", "100"]
            .iter()
            .zip(TIME_CONSTANTS_MIN)
            .map(|(duty, minutes)| {
                Quantity::new(format!("time constant by (25), {duty} % power"), "min", Some(minutes))
            })
            .collect();
        let heat = HeatBalance::SIMONI2019;
        for (name, unit, paper) in [
            ("alpha", "1/K", ALPHA_PER_K),
            ("beta", "-", BETA),
            ("K", "W/K", heat.conductance_w_per_k),
            ("C", "J/K", heat.capacity_j_per_k),
        ] {
            all.push(Quantity::new(name, unit, Some(paper)));
        }
        for (k, row) in TABLE4.iter().enumerate() {
            let minute = 3 + 30 * k;
            for (i, what) in ["with temperature", "without"].iter().enumerate() {
                all.push(Quantity::new(format!("sd of error, {minute} min, {what}"), "Nm", Some(row[i])));
            }
            for (i, what) in ["with temperature", "without"].iter().enumerate() {
                all.push(Quantity::new(format!("unexplained variance, {minute} min, {what}"), "%", Some(row[2 + i])));
            }
        }
        for name in ["10 K wrong start, Kalman: settled after".to_owned()]
            .into_iter()
            .chain(sweep().iter().map(|(name, _)| format!("30 min late, {name}: settled after")))
        {
            all.push(Quantity::new(name, "s", None));
        }
        all.extend(sweep().iter().map(|(name, _)| Quantity::new(format!("30 min late, {name}: ripple"), "K", None)));
        for name in ["always on", "behind the gate"] {
            all.push(Quantity::new(format!("disturbance, {name}: bias"), "K", None));
            all.push(Quantity::new(format!("disturbance, {name}: worst error"), "K", None));
            all.push(Quantity::new(format!("disturbance, {name}: recovered after"), "s", None));
        }
        all
    }

    fn truth(&self) -> WarmJoint {
        let one = HeatBalance::SIMONI2019;
        WarmJoint {
            polynomial: self.polynomial,
            stribeck_nm: 0.0,
            stribeck_decay_s_per_rad: 0.0,
            polynomial_slope_per_k: ALPHA_PER_K,
            stribeck_slope_per_k: 0.0,
            reference_c: self.room_c,
            gear_capacity_j_per_k: 0.0,
            housing_capacity_j_per_k: 0.0,
            gear_to_housing_w_per_k: 0.0,
            housing_to_room_w_per_k: 0.0,
        }
        .with_heat(one.capacity_j_per_k, one.conductance_w_per_k, self.gear_share, self.gear_resistance_share)
    }

    /// One seed, with what figures need of it.
    ///
    /// # Errors
    /// Where the identification fails.
    pub fn run(&self, seed: u64) -> Result<(SeedRun, Simoni2019Trace), ExperimentError> {
        let truth = self.truth();
        let study = DutyCycleStudy {
            top_speed_rad_s: self.top_speed_rad_s,
            minutes: self.identification_min,
            rate_hz: 4.0,
            noise_sd_nm: self.noise_sd_nm,
            room_c: self.room_c,
        };
        let anchor = CapacityAnchor {
            capacity_j_per_k: HeatBalance::SIMONI2019.capacity_j_per_k,
            relative_sd: self.capacity_relative_sd,
        };
        let fit = study.identify(&truth, 4.0, anchor, seed)?;
        let mut values = published_time_constants()?.to_vec();
        values.extend([
            fit.alpha_per_k.value,
            fit.beta.value,
            fit.conductance_w_per_k.value,
            fit.capacity_j_per_k.value,
        ]);
        let table = validate(&truth, &fit.joint, self.top_speed_rad_s, self.noise_sd_nm, self.room_c, 7_000 + seed);
        for row in &table {
            values.extend(row.sd_nm);
            values.extend(row.unexplained_percent);
        }

        let run = ObserverRun {
            truth: &truth,
            model: fit.joint,
            top_speed_rad_s: self.top_speed_rad_s,
            noise_sd_nm: self.noise_sd_nm,
            room_c: self.room_c,
            disturbance: (0.0, [0.0; 2]),
            gated: true,
        };
        let kalman = ObserverSettings::default();
        let ten = JointWarmth { gear_c: self.room_c + 12.0, housing_c: self.room_c + 10.0 };
        let wrong_c = run.equivalent_c(ten) - 10.0;
        values.push(run.run(kalman, ten, wrong_c, 300.0, 8_000 + seed)?.settled_s(SETTLED_K));
        // The paper: thirty minutes of work, the room assumed. Its gains have no gate.
        let warm = run.warmed_up(1800.0);
        let (mut traces, mut ripples) = (Vec::new(), Vec::new());
        for (name, settings) in sweep() {
            let gated = settings.gain == ObserverGain::Kalman;
            let trace = ObserverRun { gated, ..run }.run(settings, warm, self.room_c, 600.0, 9_000 + seed)?;
            values.push(trace.settled_s(SETTLED_K));
            ripples.push(trace.error_k([480.0, 600.0])[1]);
            traces.push((name, trace));
        }
        values.extend(ripples);
        traces.retain(|(name, _)| !name.ends_with("N = 20"));

        // Two hours of work, the right temperature, then two minutes of disturbance.
        let warm = run.warmed_up(7200.0);
        let fixed = ObserverSettings { gain: ObserverGain::Fixed(GAINS[1]), ..kalman };
        let span = [120.0, 240.0];
        let disturbed = |gated| {
            let run = ObserverRun { disturbance: (self.disturbance_nm, span), gated, ..run };
            run.run(fixed, warm, run.equivalent_c(warm), 480.0, 10_000 + seed)
        };
        let disturbed = [disturbed(false)?, disturbed(true)?];
        for trace in &disturbed {
            // Second minute, when the observer has had time to follow, less the minute before.
            let [before, during] = [[60.0, span[0]], [span[0] + 60.0, span[1]]].map(|time| trace.error_k(time)[0]);
            values.push(during - before);
            values.push(trace.worst_k([span[0], span[1] + 10.0]));
            let after = |k: &usize| trace.time_s[*k] >= span[1];
            let first = (0..trace.time_s.len()).find(after).unwrap_or(0);
            let rest = ObserverTrace {
                time_s: trace.time_s[first..].iter().map(|t| t - span[1]).collect(),
                estimated_c: trace.estimated_c[first..].to_vec(),
                true_c: trace.true_c[first..].to_vec(),
            };
            values.push(rest.settled_s(SETTLED_K));
        }
        let values = values.into_iter().map(rounded).collect();
        Ok((SeedRun { seed, values }, Simoni2019Trace { table, observers: traces, disturbed }))
    }
}

/// Six digits: what a log of the same seed repeats on any platform.
pub(super) fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let scale = 10_f64.powi(5 - x.abs().log10().floor() as i32);
    (x * scale).round() / scale
}

/// The observers that are tried.
fn sweep() -> Vec<(String, ObserverSettings)> {
    let mut all = Vec::new();
    for window in WINDOWS {
        for eta in GAINS {
            let gain = ObserverGain::Fixed(eta);
            let settings = ObserverSettings { window, gain, ..ObserverSettings::default() };
            all.push((format!("η = {eta}, N = {window}"), settings));
        }
    }
    all.push(("Kalman, N = 40".to_owned(), ObserverSettings::default()));
    all
}

/// (25) with the paper's K, C and α for duty × P. The paper does not print P = tau_f0,RMS ω̄; one P for all four, by least
/// squares on the logarithms of the time constants, golden sections.
fn published_time_constants() -> Result<[f64; 4], ExperimentError> {
    let cold = PolynomialStribeck::default();
    let polynomial = TemperatureFactor { slope_per_k: ALPHA_PER_K, level: BETA };
    let law = ThermalLaw { polynomial, ..ThermalLaw::without_temperature(cold.into()) };
    let joint = ThermalJoint::new(law, HeatBalance::SIMONI2019)?;
    let minutes = |full_w: f64| -> Result<[f64; 4], ExperimentError> {
        let mut out = [0.0; 4];
        for (k, slot) in out.iter_mut().enumerate() {
            let power = InjectedPower { polynomial_w: full_w * 0.25 * (k + 1) as f64, stribeck_w: 0.0 };
            *slot = joint.response(&power, 22.0, 22.0)?.time_constant_s / 60.0;
        }
        Ok(out)
    };
    let cost = |full_w: f64| -> Result<f64, ExperimentError> {
        Ok(minutes(full_w)?.iter().zip(TIME_CONSTANTS_MIN).map(|(a, b)| (a / b).ln().powi(2)).sum())
    };
    let (mut low, mut high) = (50.0, 300.0);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if cost(a)? < cost(b)? {
            high = b;
        } else {
            low = a;
        }
    }
    minutes(0.5 * (low + high))
}
