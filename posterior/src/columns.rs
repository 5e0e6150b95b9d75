//! The columns of all families along logs, joint by joint, and their Gram matrices part by part.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use tribo_friction::law::{leading_sign, smooth_sign};
use tribo_regression::cause::{base_tilt_columns, bristle};
use tribo_regression::filter::central_difference;
use tribo_regression::{PushWindow, RegressionData};
use tribo_sim::{Effect, SOFT_FRICTION_LEAD_S};

use crate::joint_columns::{DELAY, JointColumns, LINKS, TILT};
use crate::joint_term::JointTerm;
use crate::prior::{ArmScale, PRESLIDING_RAD};
use crate::standstill;

/// Parts that each log is cut into; a third of them is a third of the log.
pub const PARTS: usize = 12;

/// A stretch of output samples that is fitted or held out as a whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Output samples.
    pub samples: Range<usize>,
    /// Log that it is of.
    pub log: usize,
}

/// Rows of a log that are to stand together.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Output samples.
    pub rows: Vec<usize>,
    /// Log that they are of.
    pub log: usize,
}

/// Columns of all joints, and the Gram matrix of every joint's columns over every part.
#[derive(Debug)]
pub struct Columns {
    /// Columns joint by joint.
    pub joints: Vec<JointColumns>,
    /// Consecutive rows of one log each; fits are asked of some and judged on others.
    pub parts: Vec<Part>,
    /// `[part][joint]`.
    pub grams: Vec<Vec<DMatrix<f64>>>,
    /// Weight that each row of a joint has been given.
    weights: Vec<Vec<f64>>,
    /// See [`Self::gram_over`].
    sums: Mutex<Sums>,
}

/// Gram matrices of all joints by the parts that they are of.
type Sums = BTreeMap<Vec<usize>, Arc<Vec<DMatrix<f64>>>>;

impl Columns {
    /// Evaluates and filters all columns of regression data; each log is cut into as many parts.
    pub fn of<const N: usize>(data: &RegressionData<N>, scale: &ArmScale, parts_per_log: usize) -> Self {
        Self::around(data, scale, parts_per_log, &[])
    }

    /// The same, where pushes are known that the model does not have.
    pub fn around<const N: usize>(
        data: &RegressionData<N>,
        scale: &ArmScale,
        parts_per_log: usize,
        pushes: &[PushWindow],
    ) -> Self {
        let parts = parts_of(data, parts_per_log);
        let tilt = if data.transmission {
            Vec::new()
        } else {
            data.filter_all(&base_tilt_columns(data, &vec![data.nominal.arm.clone(); data.chains.len()]))
        };
        let links = if data.transmission { 0 } else { N };
        let mut joints: Vec<JointColumns> = (0..N)
            .into_par_iter()
            .map(|j| {
                let own = own_columns(data, j, scale);
                let (first_link, links) = (j.min(links), links.saturating_sub(j));
                let mut matrix = DMatrix::zeros(data.time_s.len(), LINKS + 10 * links + 2);
                for (c, values) in own.iter().enumerate() {
                    matrix.column_mut(c).copy_from_slice(values);
                }
                for (c, column) in tilt.iter().enumerate() {
                    if let Some(values) = &column.rows[j] {
                        matrix.column_mut(TILT + c).copy_from_slice(values);
                    }
                }
                matrix.column_mut(DELAY).copy_from_slice(&lateness(data, j));
                let mut columns = JointColumns { matrix, links, first_link };
                let (nominal, measured) = (columns.nominal(), columns.measured());
                columns.matrix.column_mut(nominal).copy_from_slice(&data.model_nm[j]);
                columns.matrix.column_mut(measured).copy_from_slice(&data.measured_nm[j]);
                columns
            })
            .collect();
        let regressors = if links > 0 { data.link_regressors() } else { &[] };
        for (link, regressor) in regressors.iter().enumerate() {
            for (i, column) in regressor.iter().enumerate() {
                for (j, values) in column.rows.iter().enumerate().take(link + 1) {
                    if let Some(values) = values {
                        joints[j].matrix.column_mut(LINKS + 10 * (link - j) + i).copy_from_slice(values);
                    }
                }
            }
        }
        // Where a joint turns back the noise of its velocity is torque noise too; where it stands, so is its dry friction.
        let pushed = push_weights(data, pushes);
        let weights: Vec<Vec<f64>> = (0..N)
            .into_par_iter()
            .map(|j| {
                let standing = standstill::weights(data, j, &joints[j]);
                let own = data.noise_weights(j).iter().zip(standing);
                own.zip(&pushed).map(|((noise, standing), pushed)| noise * standing * pushed).collect()
            })
            .collect();
        joints.iter_mut().zip(&weights).for_each(|(joint, weights)| {
            for mut column in joint.matrix.column_iter_mut() {
                column.iter_mut().zip(weights).for_each(|(x, weight)| *x *= weight);
            }
        });
        let grams = grams_of(&joints, &parts);
        Self { joints, parts, grams, weights, sums: Mutex::default() }
    }

    /// Puts other values in some columns, one list per joint; returns the RMS of what changes, weighted, `[column][joint]`.
    pub fn replace(&mut self, columns: &[(usize, Vec<Vec<f64>>)]) -> Vec<Vec<f64>> {
        let mut changes = Vec::with_capacity(columns.len());
        for (place, values) in columns {
            let joints = self.joints.iter_mut().zip(&self.weights).zip(values);
            let change = joints.map(|((joint, weights), values)| {
                let mut square = 0.0;
                for (x, (value, weight)) in joint.matrix.column_mut(*place).iter_mut().zip(values.iter().zip(weights)) {
                    square += (value * weight - *x).powi(2);
                    *x = value * weight;
                }
                (square / values.len().max(1) as f64).sqrt()
            });
            changes.push(change.collect());
        }
        self.grams = grams_of(&self.joints, &self.parts);
        self.sums = Mutex::default();
        changes
    }

    /// The same rows in another order, cut into other parts.
    pub fn rearranged(&self, parts: &[Rows]) -> Self {
        let rows: Vec<usize> = parts.iter().flat_map(|part| part.rows.iter().copied()).collect();
        let mut start = 0;
        let cut: Vec<Part> = parts
            .iter()
            .map(|part| {
                let samples = start..start + part.rows.len();
                start = samples.end;
                Part { samples, log: part.log }
            })
            .collect();
        let joints: Vec<JointColumns> = self
            .joints
            .par_iter()
            .map(|joint| JointColumns { matrix: joint.matrix.select_rows(&rows), ..*joint })
            .collect();
        let weights = self.weights.iter().map(|of| rows.iter().map(|k| of[*k]).collect()).collect();
        let grams = grams_of(&joints, &cut);
        Self { joints, parts: cut, grams, weights, sums: Mutex::default() }
    }

    /// Gram matrix of each joint over some parts; few sets of parts are asked for, each many times.
    pub fn gram_over(&self, parts: &[usize]) -> Option<Arc<Vec<DMatrix<f64>>>> {
        let [first, rest @ ..] = parts else { return None };
        if let Ok(known) = self.sums.lock()
            && let Some(sum) = known.get(parts)
        {
            return Some(Arc::clone(sum));
        }
        let mut sum = self.grams[*first].clone();
        for part in rest {
            sum.iter_mut().zip(&self.grams[*part]).for_each(|(sum, of_part)| *sum += of_part);
        }
        let sum = Arc::new(sum);
        if let (Ok(mut known), true) = (self.sums.lock(), rest.len() > 1) {
            known.insert(parts.to_vec(), Arc::clone(&sum));
        }
        Some(sum)
    }

    /// Number of samples of some parts.
    pub fn samples(&self, parts: &[usize]) -> usize {
        parts.iter().map(|part| self.parts[*part].samples.len()).sum()
    }

    /// Weight of each row of a joint.
    pub fn row_weights(&self, joint: usize) -> &[f64] {
        &self.weights[joint]
    }

    /// A combination of the columns of a joint over some parts.
    pub fn combined(&self, joint: usize, weights: &DVector<f64>, parts: &[usize]) -> Vec<f64> {
        let matrix = &self.joints[joint].matrix;
        let mut values = Vec::with_capacity(self.samples(parts));
        for part in parts {
            let samples = &self.parts[*part].samples;
            let product = matrix.rows(samples.start, samples.len()) * weights;
            values.extend(product.iter());
        }
        values
    }

    /// The same combination before rows are weighted.
    pub fn unweighted(&self, joint: usize, weights: &DVector<f64>, parts: &[usize]) -> Vec<f64> {
        let of_rows = parts.iter().flat_map(|part| &self.weights[joint][self.parts[*part].samples.clone()]);
        self.combined(joint, weights, parts).into_iter().zip(of_rows).map(|(x, weight)| x / weight).collect()
    }
}

/// `[part][joint]`.
fn grams_of(joints: &[JointColumns], parts: &[Part]) -> Vec<Vec<DMatrix<f64>>> {
    let gram = |joint: &JointColumns, part: &Part| {
        let rows = joint.matrix.rows(part.samples.start, part.samples.len());
        rows.tr_mul(&rows)
    };
    parts.par_iter().map(|part| joints.iter().map(|joint| gram(joint, part)).collect()).collect()
}

/// Weight of each output sample by the pushes that the model has and by others: what happens during a push tells of the push, and hardly of the arm.
pub fn push_weights<const N: usize>(data: &RegressionData<N>, others: &[PushWindow]) -> Vec<f64> {
    let mut weights = vec![1.0; data.time_s.len()];
    let own = data.nominal.effects.iter().filter_map(|effect| match effect {
        Effect::ExternalContact { start_s, end_s, .. } => Some((None, *start_s, *end_s)),
        _ => None,
    });
    let others = others.iter().map(|push| (Some(push.log), push.start_s, push.end_s));
    for (log, start_s, end_s) in own.chain(others) {
        for burst in data.bursts.iter().filter(|burst| log.is_none_or(|log| log == burst.log)) {
            let memory_s = data.chains[burst.log].memory_s();
            let during = |time_s: f64| time_s > start_s - memory_s && time_s < end_s + memory_s;
            burst.out.clone().filter(|k| during(data.time_s[*k])).for_each(|k| weights[k] = PUSHED);
        }
    }
    weights
}

/// Weight of a sample during a push.
const PUSHED: f64 = 1e-2;

/// Each log in as many contiguous parts.
fn parts_of<const N: usize>(data: &RegressionData<N>, parts_per_log: usize) -> Vec<Part> {
    let logs = data.chains.len();
    (0..logs)
        .flat_map(|log| {
            let of_log: Vec<&Range<usize>> =
                data.bursts.iter().filter(|burst| burst.log == log).map(|burst| &burst.out).collect();
            let start = of_log.first().map_or(0, |range| range.start);
            let end = of_log.last().map_or(start, |range| range.end);
            let edge = move |k: usize| start + k * (end - start) / parts_per_log;
            (0..parts_per_log).map(move |k| Part { samples: edge(k)..edge(k + 1), log })
        })
        .collect()
}

/// The columns of [`JointTerm::ALL`], filtered.
fn own_columns<const N: usize>(data: &RegressionData<N>, j: usize, scale: &ArmScale) -> Vec<Vec<f64>> {
    let waves = |k: usize| scale.waves_per_rev(j, k);
    let of =
        |value: &dyn Fn(&tribo_regression::Sample<N>) -> f64| data.samples().map(|at| value(&at)).collect::<Vec<f64>>();
    let fine = JointTerm::ALL.into_iter().map(|term| match term {
        JointTerm::Offset => of(&|_| 1.0),
        JointTerm::Coulomb => of(&|at| at.sign[j]),
        JointTerm::Viscous => of(&|at| at.qd[j]),
        JointTerm::Curve(k) => of(&|at| smooth_sign(at.qd[j], scale.curve_width_rad_s(j, k))),
        JointTerm::Load => of(&|at| at.link_nm[j].abs() * at.sign[j]),
        JointTerm::Rotor => of(&|at| at.qdd[j]),
        JointTerm::Presliding(k) => {
            let z = bristle(data, j, PRESLIDING_RAD[k]);
            z.iter().zip(&data.of_model).map(|(z, at)| z - at.sign[j]).collect()
        }
        JointTerm::Lead(k) => {
            let width_rad_s = scale.lead_width_rad_s(j, k);
            of(&|at| leading_sign(at.qd[j], at.qdd[j], width_rad_s, SOFT_FRICTION_LEAD_S) - at.sign[j])
        }
        JointTerm::Sine(k) => of(&|at| waves(k).map_or(0.0, |n| (n * at.q[j]).sin())),
        JointTerm::Cosine(k) => of(&|at| waves(k).map_or(0.0, |n| (n * at.q[j]).cos())),
        JointTerm::Spring => of(&|at| at.q[j]),
    });
    data.filter_own_all(fine)
}

/// −dy/dt of the measured torque in the band: torque per second of lateness.
fn lateness<const N: usize>(data: &RegressionData<N>, j: usize) -> Vec<f64> {
    let mut rates = Vec::with_capacity(data.time_s.len());
    for burst in &data.bursts {
        let dt_s = data.chains[burst.log].output_rate_hz().recip();
        rates.extend(central_difference(&data.measured_nm[j][burst.out.clone()], dt_s).iter().map(|rate| -rate));
    }
    rates
}
