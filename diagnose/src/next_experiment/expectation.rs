//! Expected evidence between two causes.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, SVector};
use tribo_regression::cause::{Candidate, ExternalContact, TorqueRipple, candidate_of_effect, candidates};
use tribo_regression::least_squares::solve_ridge;
use tribo_regression::{CauseLabel, Column, Location, RegressionData, add_scaled};
use tribo_sim::Effect;

use super::pair::Pair;
use crate::diagnosis::JointMisfit;

/// Density of what the model cannot know (Nm² s), white in the band:
///
/// ```text
/// density_j = sd_j² / 2B,   sd_j = max(sensor noise in the band, what the findings leave),   B = ∫ gain² df
/// ```
pub(super) struct SensorNoise<const N: usize> {
    density_nm2_s: SVector<f64, N>,
}

/// Least noise (Nm): arithmetic is no better.
const LEAST_NOISE_NM: f64 = 1e-4;
/// Steps of the integral of the gain.
const STEPS: usize = 200;
/// Rounds of fixed-point refinement of a rival's shape.
const ROUNDS: usize = 2;
/// Steps of a rival's shape between those of its grid, as powers of the grid's ratio.
const BETWEEN: [f64; 4] = [-0.5, -0.25, 0.25, 0.5];

impl<const N: usize> SensorNoise<N> {
    /// Of the log at hand.
    pub fn of(data: &RegressionData<N>, joints: &[JointMisfit]) -> Option<Self> {
        let chain = data.chains.first()?;
        let nyquist_hz = 0.5 * chain.rate_hz;
        let gain = |step: usize| chain.gain(nyquist_hz * (step as f64 + 0.5) / STEPS as f64);
        let noise_band_hz = nyquist_hz * (0..STEPS).map(|step| gain(step).powi(2)).sum::<f64>() / STEPS as f64;
        let band_hz = noise_band_hz.min(0.5 * chain.output_rate_hz());
        Some(Self {
            density_nm2_s: SVector::from_fn(|j, _| {
                let left_nm = joints.get(j).map_or(0.0, |joint| joint.rms_after_nm);
                let left_nm = if left_nm.is_finite() { left_nm } else { 0.0 };
                data.noise_floor_nm[j].max(left_nm).max(LEAST_NOISE_NM).powi(2) / (2.0 * band_hz)
            }),
        })
    }

    /// Weight of the output samples of a joint: `1/(rate density)`.
    fn weight(&self, data: &RegressionData<N>, joint: usize) -> f64 {
        let rate_hz = data.chains.first().map_or(1.0, |chain| chain.output_rate_hz());
        1.0 / (rate_hz * self.density_nm2_s[joint])
    }
}

/// A motion with the torque that the nominal model lacks on it (Nm).
pub(super) struct Run<'s, const N: usize> {
    data: &'s RegressionData<N>,
    torque_nm: Column<N>,
    /// Whether a push may act.
    touched: bool,
}

impl<'s, const N: usize> Run<'s, N> {
    /// What the model leaves over.
    pub fn of_residual(data: &'s RegressionData<N>) -> Self {
        let torque_nm = Column::of_rows(data.residual_nm.clone());
        Self { data, torque_nm, touched: true }
    }

    /// What an effect would add; `None` where it is not a torque.
    pub fn of_torque(data: &'s RegressionData<N>, effect: &Effect) -> Option<Self> {
        let (candidate, shape, coefficients) = candidate_of_effect::<N>(effect)?;
        let mut rows: [Option<Vec<f64>>; N] = std::array::from_fn(|_| None);
        for (column, coefficient) in candidate.filtered(data, &shape).iter().zip(coefficients) {
            let coefficient = match effect {
                Effect::Presliding { joint, .. } => data.nominal.dry_nm(*joint),
                _ => coefficient,
            };
            for (sum, values) in rows.iter_mut().zip(&column.rows) {
                if let Some(values) = values {
                    let sum = sum.get_or_insert_with(|| vec![0.0; values.len()]);
                    add_scaled(sum, values, coefficient);
                }
            }
        }
        Some(Self { data, torque_nm: Column { rows: rows.map(|row| row.map(Arc::new)) }, touched: true })
    }

    /// The same motion with nobody touching the arm, and nothing lacking.
    pub fn untouched(&self) -> Self {
        Self { data: self.data, torque_nm: Column::zero(), touched: false }
    }

    /// Columns of a candidate on this motion.
    fn columns(&self, candidate: &dyn Candidate<N>, shape: &[f64]) -> Vec<Column<N>> {
        let mut columns = candidate.filtered(self.data, shape);
        if !self.touched && candidate.label() == CauseLabel::ExternalContact {
            columns.iter_mut().for_each(|column| *column = Column::zero());
        }
        columns
    }
}

/// `RSS(rival) − RSS(found)` in units of the noise, over all runs with common coefficients.
///
/// Both fits carry the other findings, refitted. The rival has its best shape and extent; its coefficients are free, which
/// errs to its side. `None` where a run is too short to show either cause.
pub(super) fn expected_evidence<const N: usize>(
    runs: &[Run<'_, N>],
    pair: &Pair,
    others: &[&Effect],
    noise: &SensorNoise<N>,
) -> Option<f64> {
    let fit = Fit { runs, noise, company: company(runs, pair, others) };
    let (found, shape, _) = candidate_of_effect::<N>(&pair.effect)?;
    let able = |candidate: &dyn Candidate<N>| runs.iter().all(|run| candidate.unavailable(run.data).is_none());
    if !able(found.as_ref()) {
        return None;
    }
    let found = fit.explained(found.as_ref(), &shape);
    let rival = candidates_at::<N>(pair.rival)
        .into_iter()
        .filter(|candidate| able(candidate.as_ref()))
        .map(|candidate| fit.best(candidate.as_ref()))
        .max_by(f64::total_cmp)?;
    Some((found - rival).max(0.0)).filter(|evidence| evidence.is_finite())
}

/// What an effect's columns explain with no company, in units of the noise.
#[cfg(test)]
pub(super) fn explained_alone<const N: usize>(
    runs: &[Run<'_, N>],
    effect: &Effect,
    noise: &SensorNoise<N>,
) -> Option<f64> {
    let (candidate, shape, _) = candidate_of_effect::<N>(effect)?;
    let company = runs.iter().map(|_| Vec::new()).collect();
    Some(Fit { runs, noise, company }.explained(candidate.as_ref(), &shape))
}

/// Every extent of the cause at its place.
fn candidates_at<const N: usize>(place: (CauseLabel, Location)) -> Vec<Box<dyn Candidate<N>>> {
    match place {
        (CauseLabel::ExternalContact, _) => vec![Box::new(ExternalContact { log: None })],
        (CauseLabel::TorqueRipple, Location::Joint(joint)) => vec![Box::new(TorqueRipple { joint })],
        _ => candidates::<N>().into_iter().filter(|c| (c.label(), c.location()) == place).collect(),
    }
}

/// Columns of the other findings, run by run; what the rival would replace is left to it.
fn company<const N: usize>(runs: &[Run<'_, N>], pair: &Pair, others: &[&Effect]) -> Vec<Vec<Column<N>>> {
    let placed: Vec<_> = others
        .iter()
        .filter_map(|effect| candidate_of_effect::<N>(effect))
        .filter(|(candidate, _, _)| (candidate.label(), candidate.location()) != pair.rival)
        .filter(|(candidate, _, _)| runs.iter().all(|run| candidate.unavailable(run.data).is_none()))
        .collect();
    let columns = |run: &Run<'_, N>| {
        placed.iter().flat_map(|(candidate, shape, _)| run.columns(candidate.as_ref(), shape)).collect()
    };
    runs.iter().map(columns).collect()
}

/// Weighted least squares over runs.
struct Fit<'f, const N: usize> {
    runs: &'f [Run<'f, N>],
    noise: &'f SensorNoise<N>,
    company: Vec<Vec<Column<N>>>,
}

impl<const N: usize> Fit<'_, N> {
    /// What the candidate explains at its best shape.
    fn best(&self, candidate: &dyn Candidate<N>) -> f64 {
        let Some(last) = self.runs.last() else { return 0.0 };
        let shapes = candidate.shapes(last.data);
        let judged = shapes.iter().map(|shape| (self.fitted(candidate, shape), shape));
        let Some(((mut explained, coefficients), shape)) = judged.max_by(|a, b| a.0.0.total_cmp(&b.0.0)) else {
            return 0.0;
        };
        if candidate.profile().is_some()
            && let [first, second, ..] = shapes.as_slice()
        {
            let ratio = second[0] / first[0];
            for power in BETWEEN {
                let mut between = shape.clone();
                between[0] *= ratio.powf(power);
                explained = explained.max(self.explained(candidate, &between));
            }
        }
        let mut next = candidate.fixed_point(shape, &coefficients);
        for _ in 0..ROUNDS {
            let Some(better) = next else { break };
            let (value, coefficients) = self.fitted(candidate, &better);
            explained = explained.max(value);
            next = candidate.fixed_point(&better, &coefficients);
        }
        explained
    }

    fn explained(&self, candidate: &dyn Candidate<N>, shape: &[f64]) -> f64 {
        self.fitted(candidate, shape).0
    }

    /// Squares explained by the candidate and the company together, and the candidate's coefficients.
    fn fitted(&self, candidate: &dyn Candidate<N>, shape: &[f64]) -> (f64, Vec<f64>) {
        let own: Vec<Vec<Column<N>>> = self.runs.iter().map(|run| run.columns(candidate, shape)).collect();
        let own_count = own.first().map_or(0, Vec::len);
        let count = own_count + self.company.first().map_or(0, Vec::len);
        let (mut square, mut score) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for ((run, own), company) in self.runs.iter().zip(&own).zip(&self.company) {
            let columns: Vec<&Column<N>> = own.iter().chain(company).collect();
            for j in 0..N {
                let weight = self.noise.weight(run.data, j);
                for (i, a) in columns.iter().enumerate() {
                    let Some(a) = &a.rows[j] else { continue };
                    if let Some(torque) = &run.torque_nm.rows[j] {
                        score[i] += weight * product(a, torque);
                    }
                    for (k, b) in columns.iter().enumerate().take(i + 1) {
                        if let Some(b) = &b.rows[j] {
                            square[(i, k)] += weight * product(a, b);
                        }
                    }
                }
            }
        }
        square.fill_upper_triangle_with_lower_triangle();
        let gain = solve_ridge(&square, &score, &vec![0.0; score.len()]);
        (gain.explained, gain.coefficients.into_iter().take(own_count).collect())
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
