//! A made-up diagnosis with something of everything, for tests.

use tribo_regression::{CauseLabel, Location};
use tribo_robot::JointNames;
use tribo_sim::Effect;

use crate::{
    Alternative, CrossJointPattern, Diagnosis, Finding, JointMisfit, NextExperiment, Parameter, Plot, Rejected, Series,
    Unseen, Validation, Verdict,
};

/// Text that must never reach a page as it is.
pub const NASTY: &str = "<script>alert('1')</script> & \"two\"";

/// An ambiguous diagnosis: Stribeck friction with a rival, a payload, and a torque that nobody can name.
pub fn diagnosis() -> Diagnosis {
    let scalar =
        |name, value: f64, half: f64| Parameter { name, value: vec![value], ci95: vec![[value - half, value + half]] };
    let effect = Effect::Stribeck { joint: 3, breakaway_minus_coulomb_nm: 0.412, stribeck_velocity_rad_s: 0.0503 };
    let stribeck = Finding {
        label: CauseLabel::Stribeck,
        location: Location::Joint(3),
        joints: vec![3],
        links: Vec::new(),
        effect: Some(effect),
        parameters: vec![
            scalar("breakaway_minus_coulomb_nm", 0.412, 0.031),
            scalar("stribeck_velocity_rad_s", 0.0503, 0.0042),
        ],
        signature: None,
        p_value: 5e-4,
        held_out_gain: 0.623,
        held_out_gain_ci95: [0.578, 0.661],
        explained_rms_nm: 0.183,
        evidence: 5210.0,
        alternatives: vec![Alternative {
            label: CauseLabel::Presliding,
            location: Location::Joint(3),
            evidence_gap: 6.3,
            why: format!("both act near reversals only; cruising at several low speeds separates them {NASTY}"),
        }],
        plots: vec![stribeck_curve(), spectrum()],
    };
    let payload = Finding {
        label: CauseLabel::Payload,
        location: Location::Arm,
        joints: Vec::new(),
        effect: Some(Effect::Payload { mass_kg: 0.853, com_m: [0.01, -0.002, 0.061], inertia_kg_m2: [0.0; 6] }),
        parameters: vec![
            scalar("mass_kg", 0.853, 0.021),
            Parameter {
                name: "com_m",
                value: vec![0.0101, -0.0021, 0.0612],
                ci95: vec![[0.0052, 0.015], [-0.0073, 0.0031], [0.0492, 0.0732]],
            },
        ],
        held_out_gain: 0.31,
        held_out_gain_ci95: [0.28, 0.34],
        alternatives: Vec::new(),
        plots: vec![before_and_after()],
        ..stribeck.clone()
    };
    let unknown = Finding {
        label: CauseLabel::Unknown,
        location: Location::Joint(5),
        joints: vec![5],
        effect: None,
        parameters: Vec::new(),
        signature: Some(format!("position, two periods per turn {NASTY}")),
        alternatives: Vec::new(),
        held_out_gain: 0.041,
        held_out_gain_ci95: [0.012, 0.07],
        plots: Vec::new(),
        ..stribeck.clone()
    };
    let joint = |j: usize| JointMisfit {
        rms_nm: 0.5 / (1.0 + j as f64),
        bias_nm: -0.02 * j as f64,
        unexplained: 0.01 * j as f64,
        noise_floor_nm: 0.031,
        goes_with: [("velocity", 0.62), ("position", 0.2), ("load", 0.1), ("time", 0.01), ("reversals", 0.4)],
        rms_after_nm: 0.1 / (1.0 + j as f64) + 0.03,
        held_out_nm: [0.52 / (1.0 + j as f64), 0.11 / (1.0 + j as f64) + 0.031],
    };
    Diagnosis {
        verdict: Verdict::Ambiguous,
        findings: vec![stribeck, payload, unknown],
        joint_names: JointNames::default(),
        joints: (0..7).map(joint).collect(),
        pattern: CrossJointPattern { wrench: 0.41, gravity: 0.12, inertial: 0.77 },
        gain_heldout: 0.71,
        gain_heldout_ci95: [0.66, 0.75],
        validation: vec![Validation {
            log: format!("tuesday {NASTY}.csv"),
            before_nm: vec![0.5, 0.4, 0.3, 0.6, 0.1, 0.1, 0.05],
            after_nm: vec![0.1, 0.09, 0.1, 0.2, 0.05, 0.05, 0.03],
            plain_nm: vec![0.2, 0.19, 0.2, 0.3, 0.08, 0.08, 0.05],
            full_nm: vec![0.15, 0.12, 0.2, 0.25, 0.07, 0.06, 0.04],
            inside95: Some(0.94),
            gain: 0.64,
            gain_ci95: [0.6, 0.68],
        }],
        rejected: vec![
            Rejected {
                label: CauseLabel::TorqueGain,
                location: Location::Joint(1),
                evidence: Some(-12.3),
                reason: "does not pay for its parameters".to_owned(),
            },
            Rejected {
                label: CauseLabel::Backlash,
                location: Location::Joint(0),
                evidence: None,
                reason: format!("the log has no theta_0 {NASTY}"),
            },
        ],
        extension: Vec::new(),
        smoothing_rad_s: None,
        sticks: false,
        unseen: Some(Unseen {
            split: "each third of the log in turn",
            nominal_nm: vec![0.5, 0.4, 0.3, 0.6, 0.1, 0.1, 0.05],
            extended_nm: vec![0.11, 0.1, 0.12, 0.2, 0.05, 0.05, 0.03],
            plain_nm: vec![0.21, 0.2, 0.2, 0.3, 0.08, 0.08, 0.05],
            full_nm: vec![0.16, 0.13, 0.2, 0.25, 0.07, 0.06, 0.04],
        }),
        predictive_sd_nm: vec![0.12; 7],
        assumptions: vec!["torques are measured on the motor side of the gears".to_owned()],
        notes: vec![format!("joint 6 never moved {NASTY}")],
        next_experiment: Some(next_experiment()),
        overview: vec![time_plot(), spectrum()],
        band_hz: 24.7,
        rate_hz: 62.5,
        samples: 20_625,
        bursts: 4,
    }
}

fn next_experiment() -> NextExperiment {
    let pose =
        |k: usize| (0..7).map(move |j| if j == 3 { -1.5 + 0.4 * f64::from(k as u32 % 2) } else { 0.1 * j as f64 });
    NextExperiment {
        motion: "multi_speed_cruise",
        instruction: "Move joint 3 to and fro over 0.4 rad at 0.01, 0.03, 0.1 and 0.3 rad/s.".to_owned(),
        separates: [(CauseLabel::Stribeck, Location::Joint(3)), (CauseLabel::Presliding, Location::Joint(3))],
        expected_evidence: 412.0,
        evidence_of_this_log: 6.3,
        via_points: (0..9).map(|k| (4.0 * k as f64, pose(k).collect())).collect(),
    }
}

/// Repeatable noise in [−1, 1].
fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898).sin() * 43_758.545;
    2.0 * (x - x.floor()) - 1.0
}

fn plot(title: &str, x_label: &str, y_label: &str, series: Vec<Series>) -> Plot {
    Plot { title: title.to_owned(), x_label: x_label.to_owned(), y_label: y_label.to_owned(), series }
}

fn series(name: &str, joined: bool, points: impl Iterator<Item = (f64, f64)>) -> Series {
    let (x, y) = points.unzip();
    Series { name: name.to_owned(), x, y, joined }
}

fn stribeck_curve() -> Plot {
    let law = |qd: f64| 0.412 * (-(qd / 0.05f64).powi(2)).exp() * (qd / 0.005).tanh();
    let cloud = (0..8000).map(|k| {
        let qd = 0.6 * noise(k);
        (qd, law(qd) + 0.06 * noise(k + 50_000))
    });
    let grid = || (0..600).map(|k| -0.6 + 0.002 * f64::from(k));
    let series = vec![
        series("residual without this finding", false, cloud),
        series("Stribeck friction", true, grid().map(|qd| (qd, law(qd)))),
        series("presliding, the closest rival", true, grid().map(|qd| (qd, 0.2 * (qd / 0.03).tanh()))),
    ];
    plot("Residual of joint 3 against its velocity", "velocity of joint 3 [rad/s]", "residual torque [Nm]", series)
}

fn spectrum() -> Plot {
    let bins = || (1..1200).map(|k| 0.05 * f64::from(k));
    let power = |f: f64, k: usize| (1e-2 / (1.0 + f * f) + 1e-6) * (1.0 + 0.6 * noise(k));
    let series = vec![
        series("before", true, bins().enumerate().map(|(k, f)| (f, power(f, k)))),
        series("with the findings", true, bins().enumerate().map(|(k, f)| (f, 0.05 * power(f, k + 7) + 1e-6))),
    ];
    plot("Spectrum of the residual of joint 3", "frequency [Hz]", "power density [Nm²/Hz]", series)
}

fn time_plot() -> Plot {
    let samples = || (0..20_000).map(|k| (k, k as f64 * 1.6e-3));
    let wave = |t: f64| 0.4 * (1.3 * t).sin() + 0.1 * (5.0 * t).cos();
    let series = vec![
        series("before", true, samples().map(|(k, t)| (t, wave(t) + 0.05 * noise(k)))),
        series("with the findings", true, samples().map(|(k, t)| (t, 0.05 * noise(k + 3)))),
    ];
    plot("Residual of joint 3 over time", "time [s]", "residual torque [Nm]", series)
}

fn before_and_after() -> Plot {
    let samples = || (0..900).map(|k| f64::from(k) * 0.01);
    let series = (0..6).map(|j| {
        let phase = f64::from(j);
        series(&format!("joint {j}, a longer name"), true, samples().map(|t| (t, (t + phase).sin() * (1.0 + phase))))
    });
    plot("Torque of the payload on each joint", "time [s]", "torque [Nm]", series.collect())
}
