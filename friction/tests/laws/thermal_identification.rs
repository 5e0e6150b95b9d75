//! A thermal joint found again in generated duty-cycle logs: four duty cycles of four-minute cycles, six peak speeds
//! (simoni2019, figure 4), friction integrated here by Euler's rule (8) from the formulas (6), (7), noise correlated over
//! seconds.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::thermal::{
    CapacityAnchor, ColdFit, ThermalFit, ThermalFitError, ThermalFitSettings, ThermalSample, ThermalSession,
    identify_cold, identify_thermal,
};

const RATE_HZ: f64 = 4.0;
const T0: f64 = 22.0;
const TOP_RAD_S: f64 = 2.7;

/// α, β, γ, δ, K, C, h and c0 … c4.
#[derive(Clone, Copy)]
struct Truth {
    alpha: f64,
    beta: f64,
    gamma: f64,
    delta: f64,
    k: f64,
    c: f64,
    h: f64,
    cold: [f64; 5],
}

const TRUTH: Truth = Truth {
    alpha: -0.00937,
    beta: 0.91708,
    gamma: 0.006,
    delta: 1.08,
    k: 2.75614,
    c: 18_086.82,
    h: 6.0,
    cold: [70.0, 60.0, 12.0, -2.5, 30.0],
};

impl Truth {
    fn friction(&self, qd: f64, rise: Option<f64>) -> f64 {
        let v = qd.abs();
        let [c0, c1, c2, c3, c4] = self.cold;
        let (f, g) = rise.map_or((1.0, 1.0), |rise| (self.alpha * rise + self.beta, self.gamma * rise + self.delta));
        let polynomial = c0 + c1 * v + c2 * v.powi(2) + c3 * v.powi(3);
        (polynomial * f + c4 * (-self.h * v).exp() * g) * qd.signum()
    }

    /// `cold`: a joint held at T0, factors one.
    fn session(&self, duty: usize, minutes: f64, ambient_c: f64, cold: bool, seed: u64, sd: f64) -> ThermalSession {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut noise = 0.0;
        let dt = 1.0 / RATE_HZ;
        let memory = (-dt / 2.0_f64).exp();
        let mut temperature = ambient_c;
        let mut samples = Vec::new();
        let sub_steps = 5;
        for k in 0..(minutes * 60.0 * RATE_HZ) as usize {
            let t = k as f64 * dt;
            let velocity = |t: f64| velocity(t, duty);
            let rise = (!cold).then_some(temperature - T0);
            noise = memory * noise + (1.0 - memory * memory).sqrt() * sd * rng.sample::<f64, _>(StandardNormal);
            let qd = velocity(t);
            samples.push(ThermalSample { time_s: t, qd_rad_s: qd, friction_nm: self.friction(qd, rise) + noise });
            // The velocity is held over a sample, as the log says.
            for _ in 0..sub_steps {
                let power = self.friction(qd, Some(temperature - T0)) * qd;
                temperature += (power - self.k * (temperature - ambient_c)) / self.c * dt / f64::from(sub_steps);
            }
        }
        ThermalSession { ambient_c, start_c: None, samples }
    }

    fn study(&self, seed: u64, sd: f64, rooms: [f64; 4], minutes: f64) -> (ColdFit, Vec<ThermalSession>) {
        let cold = self.session(4, 6.0, T0, true, 1000 + seed, sd);
        let cold = identify_cold(&[cold], 0.01, self.cold[4] != 0.0).expect("a cold fit");
        let sessions = (0..4).map(|i| self.session(i + 1, minutes, rooms[i], false, 10 * seed + i as u64, sd));
        (cold, sessions.collect())
    }
}

/// Strokes of six peak speeds during the first `duty` of every four minutes; each stroke a half sine.
fn velocity(t: f64, duty: usize) -> f64 {
    let minute = (t / 60.0) as usize % 4;
    if minute >= duty {
        return 0.0;
    }
    let peak = TOP_RAD_S * [0.05, 0.24, 0.43, 0.62, 0.81, 1.0][(t / 10.0) as usize % 6];
    peak * (std::f64::consts::TAU * t / 4.37).sin()
}

fn fit(seed: u64, sd: f64, rooms: [f64; 4], minutes: f64) -> Result<ThermalFit, ThermalFitError> {
    let (cold, sessions) = TRUTH.study(seed, sd, rooms, minutes);
    identify_thermal(&cold, &sessions, &ThermalFitSettings::new(T0))
}

const ROOMS: [f64; 4] = [18.0, 25.0, 22.0, 28.0];

/// Without noise everything is found again. What is left is the mean temperature of a block, here of 2 s: blocks of a
/// minute are off by 0.5 % in δ.
#[test]
fn noise_free_logs_give_the_truth() {
    let (cold, sessions) = TRUTH.study(1, 1e-3, ROOMS, 200.0);
    let settings = ThermalFitSettings { block_s: 2.0, ..ThermalFitSettings::new(T0) };
    let fit = identify_thermal(&cold, &sessions, &settings).unwrap();
    let [c4, gamma, delta, h] = fit.stribeck.unwrap();
    for (name, got, truth, relative) in [
        ("alpha", fit.alpha_per_k.value, TRUTH.alpha, 0.01),
        ("beta", fit.beta.value, TRUTH.beta, 1e-3),
        ("gamma", gamma.value, TRUTH.gamma, 0.02),
        ("delta", delta.value, TRUTH.delta, 5e-3),
        ("K", fit.conductance_w_per_k.value, TRUTH.k, 0.01),
        ("C", fit.capacity_j_per_k.value, TRUTH.c, 0.01),
        ("h", h.value, TRUTH.h, 2e-3),
        ("c0", fit.polynomial[0].value, TRUTH.cold[0], 1e-3),
        ("c4", c4.value, TRUTH.cold[4], 5e-3),
    ] {
        println!("{name}: {got} for {truth}");
        assert!((got / truth - 1.0).abs() < relative, "{name}: {got} for {truth}");
    }
}

/// 95 % intervals cover in 95 % of 40 studies, within four standard deviations; seven intervals of a study are not
/// independent, so each parameter alone has to pass: 40 trials, sd 3.4 %.
#[test]
fn intervals_cover() {
    let studies = 40;
    let names = ["alpha", "beta", "gamma", "delta", "K", "C", "h"];
    let mut covered = [0_u32; 7];
    for seed in 0..studies {
        let fit = fit(seed, 3.0, ROOMS, 180.0).unwrap();
        let [_, gamma, delta, h] = fit.stribeck.unwrap();
        let all = [fit.alpha_per_k, fit.beta, gamma, delta, fit.conductance_w_per_k, fit.capacity_j_per_k, h];
        let truth = [TRUTH.alpha, TRUTH.beta, TRUTH.gamma, TRUTH.delta, TRUTH.k, TRUTH.c, TRUTH.h];
        for i in 0..7 {
            covered[i] += u32::from(all[i].covers(truth[i]));
            // An interval that covers because it is endless is none.
            assert!(all[i].sd < 0.5 * truth[i].abs(), "{}: {:?}", names[i], all[i]);
        }
    }
    println!("covered of {studies}: {names:?} {covered:?}");
    for (name, covered) in names.iter().zip(covered) {
        assert!(covered >= 33, "{name}: {covered} of {studies}");
    }
    let total: u32 = covered.iter().sum();
    assert!((0.90..=0.99).contains(&(f64::from(total) / f64::from(7 * studies as u32))), "{total}");
}

/// Rooms that are all equally warm cannot tell the unit of temperature; the capacity can, and the torques predicted do not
/// depend on it.
#[test]
fn equal_rooms_need_the_capacity() {
    let (cold, sessions) = TRUTH.study(3, 1.0, [T0; 4], 150.0);
    let settings = ThermalFitSettings::new(T0);
    let error = identify_thermal(&cold, &sessions, &settings).unwrap_err();
    assert!(matches!(error, ThermalFitError::ScaleUnknown { got_k, .. } if got_k == 0.0), "{error}");
    let anchored = |capacity_j_per_k: f64| {
        let capacity = Some(CapacityAnchor { capacity_j_per_k, relative_sd: 0.05 });
        identify_thermal(&cold, &sessions, &ThermalFitSettings { capacity, ..settings }).unwrap()
    };
    let (right, double) = (anchored(TRUTH.c), anchored(2.0 * TRUTH.c));
    assert!((right.conductance_w_per_k.value / TRUTH.k - 1.0).abs() < 0.05, "{right:?}");
    assert!((double.capacity_j_per_k.value / right.capacity_j_per_k.value - 2.0).abs() < 0.01);
    assert!((double.alpha_per_k.value / right.alpha_per_k.value - 2.0).abs() < 0.02);
    let after = |fit: &ThermalFit| {
        let mut temperature = T0;
        for k in 0..12_000 {
            temperature = fit.joint.warmed_c(temperature, velocity(0.5 * f64::from(k), 4), T0, 0.5);
        }
        fit.joint.law().torque_nm(1.3, temperature)
    };
    let (a, b) = (after(&right), after(&double));
    assert!((a - b).abs() < 0.05 && a < 0.85 * right.joint.law().torque_nm(1.3, T0), "{a} {b}");
}

#[test]
fn what_the_data_cannot_tell_is_said() {
    // Ten minutes are no time constant.
    let error = fit(4, 3.0, ROOMS, 10.0).unwrap_err();
    assert!(matches!(error, ThermalFitError::Undetermined { .. } | ThermalFitError::AtBound { .. }), "{error}");
    // A joint that never moves.
    let (cold, mut sessions) = TRUTH.study(5, 1.0, ROOMS, 10.0);
    for session in &mut sessions {
        session.samples.iter_mut().for_each(|s| s.qd_rad_s = 0.0);
    }
    let settings = ThermalFitSettings::new(T0);
    let error = identify_thermal(&cold, &sessions, &settings).unwrap_err();
    assert!(matches!(error, ThermalFitError::TooFewSamples { got: 0, .. }), "{error}");
    sessions[2].samples[7].time_s = 0.0;
    let error = identify_thermal(&cold, &sessions, &settings).unwrap_err();
    assert_eq!(error.to_string(), "session 2, sample 7: time does not grow");
    let settings = ThermalFitSettings { block_s: 0.0, ..settings };
    let error = identify_thermal(&cold, &sessions, &settings).unwrap_err();
    assert_eq!(error.to_string(), "thermal friction: block_s is 0; allowed: 1 to 600 s");
    // One speed only.
    let one_speed = ThermalSession {
        ambient_c: T0,
        start_c: None,
        samples: (0..500).map(|k| ThermalSample { time_s: f64::from(k), qd_rad_s: 0.5, friction_nm: 80.0 }).collect(),
    };
    assert!(matches!(identify_cold(&[one_speed], 0.01, true), Err(ThermalFitError::Undetermined { .. })));
}

/// No Stribeck part: c4, γ, δ and h are not asked for, and time and bits repeat.
#[test]
fn a_plain_polynomial_is_enough_where_nothing_creeps() {
    let truth = Truth { cold: [70.0, 60.0, 12.0, -2.5, 0.0], ..TRUTH };
    let (cold, sessions) = truth.study(6, 1.0, ROOMS, 150.0);
    let settings = ThermalFitSettings::new(T0);
    let fit = identify_thermal(&cold, &sessions, &settings).unwrap();
    assert!(fit.stribeck.is_none());
    assert!((fit.conductance_w_per_k.value / TRUTH.k - 1.0).abs() < 0.15, "{fit:?}");
    assert!((fit.rms_nm - 1.0).abs() < 0.05);
    assert_eq!(identify_thermal(&cold, &sessions, &settings).unwrap(), fit);
}
