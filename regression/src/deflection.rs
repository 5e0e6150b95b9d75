//! Two encoders: what lies between motor and link.
//!
//! ```text
//! theta − q = offset + skew qd + tau_link / K − (D/K²) d tau_link/dt + b sign(tau_link)
//! ```
//!
//! The offset of the encoders and a skew of their clocks are always fitted along: a skew of 3 ms looks like a spring and
//! a gap. Stiffness and gap are then named if they explain what these leave.

use nalgebra::{DMatrix, SVector};
use tribo_sim::Effect;

use crate::cause::{Backlash, Candidate, transmitted_sign};
use crate::column::add_scaled;
use crate::filter::central_difference;
use crate::label::CauseLabel;
use crate::least_squares::{Gain, fit_rows, inner};
use crate::noise_level::rms;
use crate::regression_data::RegressionData;
use crate::whitening::Whitening;

/// What the deflection of one joint shows.
#[derive(Clone, Debug)]
pub struct DeflectionFinding {
    /// The joint, from 0.
    pub joint: usize,
    /// Elasticity or backlash.
    pub label: CauseLabel,
    /// The same with its stiffness or gap.
    pub effect: Effect,
    /// Relative standard error of stiffness or gap.
    pub relative_error: f64,
    /// Evidence against a rigid gear (extended BIC).
    pub evidence: f64,
    /// RMS of the held-out deflection before and after (rad), per block.
    pub blocks: Vec<[f64; 2]>,
    /// Link torque (Nm) against theta − q (rad), and the fit.
    pub cloud: [Vec<f64>; 3],
}

/// Widths of the smooth sign that are tried (Nm).
const WIDTHS_NM: [f64; 4] = [0.03, 0.1, 0.3, 1.0];
/// Stiffness believed [Nm/rad].
const STIFFNESS_NM_RAD: [f64; 2] = [100.0, 1e6];
/// Deflection in standard deviations of the encoder noise in the band that is worth naming.
const LEAST_OVER_NOISE: f64 = 0.3;
/// Evidence of both over that of the better one: how a gap closes is no spring, how a spring bends no gap.
const SECOND_CAUSE: f64 = 1.01;
/// Evidence that either needs.
const LEAST_EVIDENCE: f64 = 15.0;

/// Elasticity and backlash of every joint; empty without a second encoder.
pub fn deflections<const N: usize>(data: &RegressionData<N>) -> Vec<DeflectionFinding> {
    let Some(deflection) = &data.deflection_rad else { return Vec::new() };
    (0..N).flat_map(|joint| joint_deflection(data, deflection, joint)).collect()
}

/// The deflection that the model's own effects predict (rad).
fn nominal_deflection<const N: usize>(data: &RegressionData<N>, joint: usize) -> impl Fn(f64) -> f64 + '_ {
    move |link_nm| {
        data.nominal
            .effects
            .iter()
            .map(|effect| match effect {
                Effect::JointElasticity { joint: at, stiffness_nm_per_rad, .. } if *at == joint => {
                    link_nm / stiffness_nm_per_rad
                }
                Effect::Backlash { joint: at, half_gap_rad } if *at == joint => {
                    half_gap_rad * transmitted_sign(link_nm, WIDTHS_NM[1])
                }
                _ => 0.0,
            })
            .sum()
    }
}

fn joint_deflection<const N: usize>(
    data: &RegressionData<N>,
    deflection: &[SVector<f64, N>],
    joint: usize,
) -> Vec<DeflectionFinding> {
    let predicted = nominal_deflection(data, joint);
    let own = |values: Vec<f64>| data.filter_own(&values);
    let sample = |value: &dyn Fn(usize) -> f64| own((0..data.motion.len()).map(value).collect());
    let target = sample(&|k| deflection[k][joint] - predicted(data.of_model[k].link_nm[joint]));
    let mut rates = Vec::with_capacity(data.motion.len());
    for burst in &data.bursts {
        let load: Vec<f64> = data.of_model[burst.fine.clone()].iter().map(|at| at.link_nm[joint]).collect();
        rates.extend(central_difference(&load, data.period_s(burst)));
    }
    let load = sample(&|k| data.of_model[k].link_nm[joint]);
    let nuisance = [sample(&|_| 1.0), sample(&|k| data.motion[k].qd[joint])];
    let spring = [load.clone(), own(rates)];
    let gap = Backlash { joint };
    let gaps: Vec<Vec<f64>> = WIDTHS_NM
        .iter()
        .map(|width| gap.filtered(data, &[*width]).swap_remove(0).rows[joint].as_deref().cloned().unwrap_or_default())
        .collect();

    // Whiten by the colour of what everything together leaves.
    let all: Vec<&[f64]> = nuisance.iter().chain(&spring).chain(&gaps).map(Vec::as_slice).collect();
    let bursts: Vec<_> = data.bursts.iter().map(|burst| burst.out.clone()).collect();
    let left = subtract(&target, &all, &fit(&all, &target).coefficients);
    let noise = deflection_noise(data, joint);
    let whitening = Whitening::of(&left, &bursts, (0.05 * noise).max(1e-10));
    let white = |x: &[f64]| bursts.iter().flat_map(|burst| whitening.apply(&x[burst.clone()])).collect::<Vec<f64>>();
    let white_target = white(&target);
    let n = white_target.len().max(2) as f64;
    let explained = |columns: &[&[f64]]| {
        let columns: Vec<Vec<f64>> = columns.iter().map(|column| white(column)).collect();
        let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        fit(&views, &white_target).explained
    };
    let base: Vec<&[f64]> = nuisance.iter().map(Vec::as_slice).collect();

    // Models: nothing, spring, gap (widths profiled), both.
    let none = explained(&base);
    let stiff = [spring[0].as_slice(), spring[1].as_slice()];
    let only_spring = explained(&[base.as_slice(), &stiff].concat()) - none - 2.0 * n.ln();
    let best_gap = |extra: &[&[f64]]| {
        gaps.iter()
            .enumerate()
            .map(|(w, gap)| (w, explained(&[base.as_slice(), &[gap.as_slice()], extra].concat())))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, 0.0))
    };
    let (gap_width, gap_explained) = best_gap(&[]);
    let only_gap = gap_explained - none - 2.0 * n.ln();
    let (both_width, both) = best_gap(&stiff);
    let both = both - none - 4.0 * n.ln();
    let best = only_spring.max(only_gap).max(both);
    if best < LEAST_EVIDENCE {
        return Vec::new();
    }
    let (has_spring, gap_index) = if both >= best && both > SECOND_CAUSE * only_spring.max(only_gap) + LEAST_EVIDENCE {
        (true, Some(both_width))
    } else if only_spring >= only_gap {
        (true, None)
    } else {
        (false, Some(gap_width))
    };
    let mut chosen = base.clone();
    if has_spring {
        chosen.extend(stiff);
    }
    if let Some(w) = gap_index {
        chosen.push(&gaps[w]);
    }
    let white_columns: Vec<Vec<f64>> = chosen.iter().map(|column| white(column)).collect();
    let views: Vec<&[f64]> = white_columns.iter().map(Vec::as_slice).collect();
    let gain = fit(&views, &white_target);
    let errors = standard_errors(&views);

    let corrected = subtract(&target, &base, &gain.coefficients[..2]);
    let predicted: Vec<f64> = subtract(&corrected, &chosen[2..], &gain.coefficients[2..]);
    let (before_rad, after_rad) = (rms(&corrected), rms(&predicted));
    if (before_rad.powi(2) - after_rad.powi(2)).max(0.0).sqrt() < LEAST_OVER_NOISE * noise {
        return Vec::new();
    }
    let block = (2.0 * data.chains[0].output_rate_hz()).ceil().max(1.0) as usize;
    let blocks: Vec<[f64; 2]> =
        corrected.chunks(block).zip(predicted.chunks(block)).map(|(b, a)| [rms(b), rms(a)]).collect();
    let fitted: Vec<f64> = corrected.iter().zip(&predicted).map(|(before, after)| before - after).collect();
    let template = |label, effect, relative_error, evidence| DeflectionFinding {
        joint,
        label,
        effect,
        relative_error,
        evidence,
        blocks: blocks.clone(),
        cloud: [load.clone(), corrected.clone(), fitted.clone()],
    };
    let mut findings = Vec::new();
    if has_spring {
        let (compliance, rate) = (gain.coefficients[2], gain.coefficients[3]);
        let stiffness = 1.0 / compliance;
        if stiffness > STIFFNESS_NM_RAD[0] && stiffness < STIFFNESS_NM_RAD[1] {
            let effect = Effect::JointElasticity {
                joint,
                stiffness_nm_per_rad: stiffness,
                damping_nm_s_per_rad: (-rate * stiffness * stiffness).max(0.0),
            };
            let evidence = if gap_index.is_some() { both - only_gap } else { only_spring };
            findings.push(template(CauseLabel::JointElasticity, effect, errors[2] / compliance.abs(), evidence));
        }
    }
    if gap_index.is_some() {
        let place = chosen.len() - 1;
        let half_gap_rad = gain.coefficients[place];
        if half_gap_rad > 0.0 {
            let evidence = if has_spring { both - only_spring } else { only_gap };
            if let Some(effect) = Candidate::<N>::effect(&gap, data, &[], &[half_gap_rad]) {
                findings.push(template(CauseLabel::Backlash, effect, errors[place] / half_gap_rad, evidence));
            }
        }
    }
    findings
}

/// Noise of theta − q in the band (rad): both encoders.
fn deflection_noise<const N: usize>(data: &RegressionData<N>, joint: usize) -> f64 {
    let chain = &data.chains[0];
    data.position_sd_rad[joint] * (2.0 * 2.0 * chain.band_hz / chain.rate_hz).sqrt()
}

fn fit(columns: &[&[f64]], target: &[f64]) -> Gain {
    fit_rows(columns, target, 1e-7)
}

/// Standard errors of whitened columns.
fn standard_errors(columns: &[&[f64]]) -> Vec<f64> {
    let k = columns.len();
    let square = DMatrix::from_fn(k, k, |a, b| inner(columns[a], columns[b]));
    square.try_inverse().map_or_else(
        || vec![f64::INFINITY; k],
        |inverse| inverse.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect(),
    )
}

fn subtract(target: &[f64], columns: &[&[f64]], coefficients: &[f64]) -> Vec<f64> {
    let mut left = target.to_vec();
    columns.iter().zip(coefficients).for_each(|(column, coefficient)| add_scaled(&mut left, column, -coefficient));
    left
}
