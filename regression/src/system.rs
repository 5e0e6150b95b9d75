//! All candidate columns, whitened, and their Gram matrix: every question of the search is small dense algebra on it.

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock};

use nalgebra::{DMatrix, DVector, DVectorView};
use rayon::prelude::*;

use crate::cause::{Candidate, ExternalContact};
use crate::column::Column;
use crate::label::{CauseLabel, Location};
use crate::least_squares::{ROUNDING, inner};
use crate::noise_level::{rms, robust_sd};
use crate::regression_data::RegressionData;
use crate::whitening::Whitening;

/// A candidate at one shape: a set of columns that stand or fall together. Two candidates may share columns.
#[derive(Clone)]
pub struct Group<const N: usize> {
    /// The cause.
    pub candidate: Arc<dyn Candidate<N>>,
    /// Its shape: a speed, a distance, a time constant.
    pub shape: Vec<f64>,
    /// Its columns among those of the system.
    pub columns: Range<usize>,
}

/// The whitened regression problem `y = X θ + e`, rows over joints and time.
pub struct System<'a, const N: usize> {
    /// What the columns are made of.
    pub data: &'a RegressionData<N>,
    /// Candidates at their shapes.
    pub groups: Vec<Group<N>>,
    /// X, whitened, column by column.
    pub columns: Vec<Column<N>>,
    /// y, the whitened residual.
    pub target: Column<N>,
    /// Xᵀ X.
    pub gram: DMatrix<f64>,
    /// Xᵀ y.
    pub score: DVector<f64>,
    /// Whitened rows, all joints.
    pub rows: usize,
    /// Rows of one joint.
    pub joint_rows: usize,
    /// Whitening per joint and log.
    pub whitening: [Vec<Whitening>; N],
    /// Columns evaluated off the grid: the search comes back to the same shapes in other company.
    evaluated: Mutex<Kept<N>>,
    /// Filtered columns of groups that were asked for.
    plain: Mutex<BTreeMap<usize, Vec<Column<N>>>>,
    /// Columns of a push that lasts the whole log, on first use.
    push: OnceLock<Vec<Column<N>>>,
    /// Weight of each output sample of a joint, before whitened rows are dropped.
    weights: [Vec<f64>; N],
    /// Joints whose rests are left out.
    pub stuck: [bool; N],
    /// Output sample of each whitened row.
    pub row_samples: Vec<usize>,
    /// Burst of each whitened row.
    pub row_bursts: Vec<usize>,
}

/// A cause at a shape.
type Place = (CauseLabel, Location, Vec<u64>);
/// Numbers kept of evaluations: 32 MB.
const MOST_KEPT: usize = 4_000_000;

/// The last evaluations.
struct Kept<const N: usize> {
    columns: BTreeMap<Place, Vec<Column<N>>>,
    numbers: usize,
}

impl<const N: usize> Default for Kept<N> {
    fn default() -> Self {
        Self { columns: BTreeMap::new(), numbers: 0 }
    }
}

impl<const N: usize> Kept<N> {
    /// Keeps one more, instead of all others where they would be too many.
    fn insert(&mut self, place: Place, columns: &[Column<N>]) {
        let numbers: usize = columns.iter().flat_map(|column| column.rows.iter().flatten()).map(|row| row.len()).sum();
        if self.numbers + numbers > MOST_KEPT {
            *self = Self::default();
        }
        if self.columns.insert(place, columns.to_vec()).is_none() {
            self.numbers += numbers;
        }
    }
}

/// A candidate at a shape with its filtered columns.
type Shaped<const N: usize> = (Arc<dyn Candidate<N>>, Vec<f64>, Vec<Column<N>>);

/// The filtered columns of all candidates that data can show, on their grids of shapes.
pub struct EvaluatedColumns<const N: usize> {
    /// Candidates at their shapes.
    pub groups: Vec<Group<N>>,
    /// Their columns, filtered and not whitened (Nm per unit of the coefficient).
    pub columns: Vec<Column<N>>,
}

impl<const N: usize> EvaluatedColumns<N> {
    /// Evaluates candidate by candidate; columns that two candidates share are evaluated once.
    pub fn of(data: &RegressionData<N>, candidates: &[Arc<dyn Candidate<N>>]) -> Self {
        let evaluated: Vec<Shaped<N>> = candidates
            .par_iter()
            .filter(|candidate| candidate.unavailable(data).is_none())
            .flat_map_iter(|candidate| {
                candidate.shapes(data).into_iter().map(|shape| {
                    let own = candidate.columns_of_widest().is_none();
                    let filtered = if own { candidate.filtered(data, &shape) } else { Vec::new() };
                    (candidate.clone(), shape, filtered)
                })
            })
            .collect();
        let (mut groups, mut columns) = (Vec::new(), Vec::new());
        let mut widest: BTreeMap<(CauseLabel, Location), Range<usize>> = BTreeMap::new();
        for (candidate, shape, filtered) in evaluated {
            let start = columns.len();
            columns.extend(filtered);
            let own = start..columns.len();
            let known = widest.entry((candidate.label(), candidate.location())).or_insert_with(|| own.clone());
            if own.len() > known.len() {
                *known = own.clone();
            }
            groups.push(Group { candidate, shape, columns: own });
        }
        for Group { candidate, columns, .. } in &mut groups {
            if let Some(shared) = candidate.columns_of_widest() {
                let first = widest[&(candidate.label(), candidate.location())].start;
                *columns = first + shared.start..first + shared.end;
            }
        }
        Self { groups, columns }
    }

    /// What every column together leaves of the residual (Nm).
    pub fn saturated_residual(&self, data: &RegressionData<N>) -> [Vec<f64>; N] {
        let mut left: Vec<Vec<f64>> =
            (0..N).into_par_iter().map(|j| saturated_residual(data, &self.columns, j)).collect();
        std::array::from_fn(|j| std::mem::take(&mut left[j]))
    }
}

/// Least innovation scale over the sensor noise in the band.
const LEAST_SCALE: f64 = 0.05;
/// Least innovation scale over the RMS of the measured torque: arithmetic and interpolation are no better.
const LEAST_RELATIVE_SCALE: f64 = 2e-5;
/// Residual at rest over residual in motion beyond which standing samples are down-weighted.
const REST_RATIO: f64 = 1.5;
/// The same, beyond which they are left out.
const STUCK_RATIO: f64 = 12.0;
/// Output samples in motion below which a joint's rests stay in.
const LEAST_MOVING: usize = 40;
/// Share of standing samples in the filter's window beyond which an output sample counts as one of a rest.
const STANDING_SHARE: f64 = 0.003;

/// Rows that are multiplied at once.
const ROWS_AT_ONCE: usize = 512;

impl<'a, const N: usize> System<'a, N> {
    /// Whitens and multiplies the columns of all groups, lent or given away; the colour is that of `left`, the residual (Nm) of a fit.
    pub fn new<C: Borrow<Column<N>>>(
        data: &'a RegressionData<N>,
        groups: Vec<Group<N>>,
        columns: impl IntoParallelIterator<Iter: IndexedParallelIterator, Item = C>,
        left: &[Vec<f64>; N],
    ) -> Self {
        let colour: Vec<(Vec<Whitening>, Vec<f64>, bool)> = (0..N)
            .into_par_iter()
            .map(|j| {
                let filters = whitening_of(data, &left[j], j);
                let order = filters.iter().map(Whitening::order).max().unwrap_or(0);
                let mut weights = rest_weights(data, &left[j], j, order);
                let stuck = weights.contains(&0.0);
                weights.iter_mut().zip(data.noise_weights(j)).for_each(|(weight, noisy)| *weight *= noisy);
                (filters, weights, stuck)
            })
            .collect();
        let mut whitening: [Vec<Whitening>; N] = std::array::from_fn(|_| Vec::new());
        let mut weights: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
        let mut stuck = [false; N];
        for (j, (filters, weight, sticks)) in colour.into_iter().enumerate() {
            whitening[j] = filters;
            weights[j] = weight;
            stuck[j] = sticks;
        }

        let (mut row_samples, mut row_bursts) = (Vec::new(), Vec::new());
        let order = whitening.iter().flatten().map(Whitening::order).max().unwrap_or(0);
        // One order for all, so that a row is one instant of every joint.
        for (index, burst) in data.bursts.iter().enumerate() {
            for k in burst.out.clone().skip(order) {
                row_samples.push(k);
                row_bursts.push(index);
            }
        }
        let mut system = Self {
            data,
            groups,
            columns: Vec::new(),
            target: Column::zero(),
            gram: DMatrix::zeros(0, 0),
            score: DVector::zeros(0),
            joint_rows: row_samples.len(),
            rows: row_samples.len() * N,
            whitening,
            evaluated: Mutex::default(),
            plain: Mutex::default(),
            push: OnceLock::new(),
            weights,
            stuck,
            row_samples,
            row_bursts,
        };
        system.columns = columns.into_par_iter().map(|column| system.whiten(column.borrow())).collect();
        for group in &system.groups {
            drop_rounding(&mut system.columns[group.columns.clone()]);
        }
        system.target = system.whiten(&Column::of_rows(data.residual_nm.clone()));
        system.multiply();
        system
    }

    /// A filtered column, whitened and weighted.
    pub fn whiten(&self, column: &Column<N>) -> Column<N> {
        let order = self.whitening.iter().flatten().map(Whitening::order).max().unwrap_or(0);
        let rows = std::array::from_fn(|j| {
            column.rows[j].as_ref().map(|values| {
                let mut white = Vec::with_capacity(self.joint_rows);
                for burst in &self.data.bursts {
                    let filter = &self.whitening[j][burst.log];
                    let whole = filter.apply(&values[burst.out.clone()]);
                    let extra = order - filter.order();
                    white.extend(whole.into_iter().skip(extra));
                }
                white.iter_mut().zip(&self.row_samples).for_each(|(w, k)| *w *= self.weights[j][*k]);
                Arc::new(white)
            })
        });
        Column { rows }
    }

    /// Gives each joint as much less weight as left-over correlation inflates chance there.
    pub fn deflate(&mut self, joint_inflation: &[f64]) {
        self.evaluated = Mutex::default();
        self.push = OnceLock::new();
        for (j, inflation) in joint_inflation.iter().enumerate().take(N) {
            let factor = 1.0 / inflation.sqrt();
            self.weights[j].iter_mut().for_each(|weight| *weight *= factor);
            for column in self.columns.iter_mut().chain([&mut self.target]) {
                if let Some(row) = &mut column.rows[j] {
                    Arc::make_mut(row).iter_mut().for_each(|x| *x *= factor);
                }
            }
        }
        self.multiply();
    }

    /// Gram matrix and score, joint by joint.
    fn multiply(&mut self) {
        let count = self.columns.len();
        let parts: Vec<(Vec<usize>, DMatrix<f64>, DVector<f64>)> = (0..N)
            .into_par_iter()
            .map(|j| {
                let present: Vec<usize> = (0..count).filter(|c| self.columns[*c].rows[j].is_some()).collect();
                let mut gram = DMatrix::zeros(present.len(), present.len());
                let mut score = DVector::zeros(present.len());
                let Some(target) = &self.target.rows[j] else { return (present, gram, score) };
                // Passes of a few rows: a matrix of all would be the columns once more.
                for first in (0..self.joint_rows).step_by(ROWS_AT_ONCE) {
                    let rows = first..(first + ROWS_AT_ONCE).min(self.joint_rows);
                    let mut x = DMatrix::zeros(rows.len(), present.len());
                    for (mut own, c) in x.column_iter_mut().zip(&present) {
                        if let Some(values) = &self.columns[*c].rows[j] {
                            own.copy_from_slice(&values[rows.clone()]);
                        }
                    }
                    let xt = x.transpose();
                    gram.gemm(1.0, &xt, &x, 1.0);
                    score.gemv(1.0, &xt, &DVectorView::from_slice(&target[rows.clone()], rows.len()), 1.0);
                }
                (present, gram, score)
            })
            .collect();
        self.gram = DMatrix::zeros(count, count);
        self.score = DVector::zeros(count);
        for (present, gram, score) in parts {
            for (column, &c) in present.iter().enumerate() {
                self.score[c] += score[column];
                for (row, &r) in present.iter().enumerate() {
                    self.gram[(r, c)] += gram[(row, column)];
                }
            }
        }
    }

    /// Whitened columns of a candidate at a shape.
    pub fn evaluate(&self, candidate: &dyn Candidate<N>, shape: &[f64]) -> Vec<Column<N>> {
        let key = (candidate.label(), candidate.location(), shape.iter().map(|x| x.to_bits()).collect::<Vec<u64>>());
        if let Ok(known) = self.evaluated.lock()
            && let Some(columns) = known.columns.get(&key)
        {
            return columns.clone();
        }
        let columns: Vec<Column<N>> =
            candidate.filtered(self.data, shape).iter().map(|column| self.whiten(column)).collect();
        if let Ok(mut known) = self.evaluated.lock() {
            known.insert(key, &columns);
        }
        columns
    }

    /// Whitened columns of a push that lasts the whole log: −Jᵀ.
    pub fn push_columns(&self) -> &[Column<N>] {
        self.push.get_or_init(|| self.evaluate(&ExternalContact { log: None }, &[f64::NEG_INFINITY, f64::INFINITY]))
    }

    /// Adds a group with its rows of the Gram matrix; returns its index.
    pub fn push(&mut self, candidate: Arc<dyn Candidate<N>>, shape: Vec<f64>, mut columns: Vec<Column<N>>) -> usize {
        drop_rounding(&mut columns);
        let (old, new) = (self.columns.len(), columns.len());
        self.columns.extend(columns);
        let gram = std::mem::replace(&mut self.gram, DMatrix::zeros(0, 0));
        let mut gram = gram.resize(old + new, old + new, 0.0);
        let mut score = std::mem::replace(&mut self.score, DVector::zeros(0)).resize_vertically(old + new, 0.0);
        for c in old..old + new {
            let products: Vec<f64> =
                (0..old + new).into_par_iter().map(|other| dot(&self.columns[c], &self.columns[other])).collect();
            for (other, product) in products.into_iter().enumerate() {
                gram[(c, other)] = product;
                gram[(other, c)] = product;
            }
            score[c] = dot(&self.columns[c], &self.target);
        }
        self.gram = gram;
        self.score = score;
        self.groups.push(Group { candidate, shape, columns: old..old + new });
        self.groups.len() - 1
    }

    /// Ridges of columns in a joint fit: bodies have directions that no joint feels, single causes have none.
    pub fn ridges(&self, columns: &[usize]) -> Vec<f64> {
        let is_body = |group: &&Group<N>| {
            group.columns.len() >= MANY_COLUMNS && group.columns.clone().all(|column| columns.contains(&column))
        };
        let bodies: Vec<&Range<usize>> = self.groups.iter().filter(is_body).map(|group| &group.columns).collect();
        let ridge = |column| if bodies.iter().any(|body| body.contains(column)) { BODY_RIDGE } else { 0.0 };
        columns.iter().map(ridge).collect()
    }

    /// The columns of several groups.
    pub fn columns_of(&self, groups: &[usize]) -> Vec<usize> {
        groups.iter().flat_map(|g| self.groups[*g].columns.clone()).collect()
    }

    /// The columns of a group as filtered torques, before whitening.
    pub fn plain_columns(&self, group: usize) -> Vec<Column<N>> {
        if let Ok(known) = self.plain.lock()
            && let Some(columns) = known.get(&group)
        {
            return columns.clone();
        }
        let Group { candidate, shape, .. } = &self.groups[group];
        let columns = candidate.filtered(self.data, shape);
        if let Ok(mut known) = self.plain.lock() {
            known.insert(group, columns.clone());
        }
        columns
    }
}

/// Empties the columns of a group that are nothing but rounding: scaled to unit length they would be noise.
fn drop_rounding<const N: usize>(columns: &mut [Column<N>]) {
    let largest = columns.iter().map(|column| dot(column, column)).fold(0.0, f64::max);
    for column in columns {
        if dot(column, column) < ROUNDING.powi(2) * largest {
            *column = Column::zero();
        }
    }
}

/// Columns of a group from which on they describe a body.
const MANY_COLUMNS: usize = 4;
/// Its ridge, relative to unit columns.
const BODY_RIDGE: f64 = 1e-4;

/// Inner product over the joints that both have.
pub(crate) fn dot<const N: usize>(a: &Column<N>, b: &Column<N>) -> f64 {
    (0..N).filter_map(|j| a.rows[j].as_ref().zip(b.rows[j].as_ref())).map(|(a, b)| inner(a, b)).sum()
}

/// Least relative eigenvalue of the saturated fit.
const SATURATED_TOLERANCE: f64 = 1e-6;
/// Rows per direction of the saturated fit.
const ROWS_PER_DIRECTION: usize = 8;

/// What is left of the residual of a joint when every column has been fitted (truncated least squares).
fn saturated_residual<const N: usize>(data: &RegressionData<N>, columns: &[Column<N>], joint: usize) -> Vec<f64> {
    let y = DVector::from_column_slice(&data.residual_nm[joint]);
    let rows = y.len();
    let unit: Vec<DVector<f64>> = columns
        .iter()
        .filter_map(|column| column.rows[joint].as_ref())
        .map(|values| DVector::from_column_slice(values))
        .filter(|column| column.norm() > 0.0)
        .map(|column| &column / column.norm())
        .collect();
    if unit.is_empty() || rows == 0 {
        return y.as_slice().to_vec();
    }
    let x = DMatrix::from_columns(&unit);
    let xt = x.transpose();
    let eigen = (&xt * &x).symmetric_eigen();
    let score = &xt * &y;
    let mut order: Vec<usize> = (0..unit.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let largest = eigen.eigenvalues[order[0]];
    let mut coefficients = DVector::zeros(unit.len());
    for &i in order.iter().take((rows / ROWS_PER_DIRECTION).max(1)) {
        let value = eigen.eigenvalues[i];
        if value > SATURATED_TOLERANCE * largest {
            let direction = eigen.eigenvectors.column(i);
            coefficients += direction * (direction.dot(&score) / value);
        }
    }
    (y - x * coefficients).as_slice().to_vec()
}

fn whitening_of<const N: usize>(data: &RegressionData<N>, left: &[f64], joint: usize) -> Vec<Whitening> {
    let measured = &data.measured_nm[joint];
    let least = (LEAST_SCALE * data.noise_floor_nm[joint]).max(LEAST_RELATIVE_SCALE * rms(measured)).max(1e-9);
    (0..data.chains.len())
        .map(|log| {
            let bursts: Vec<Range<usize>> =
                data.bursts.iter().filter(|burst| burst.log == log).map(|burst| burst.out.clone()).collect();
            Whitening::of(left, &bursts, least)
        })
        .collect()
}

/// Weight of each output sample: 1, but less or 0 while the joint stands if friction is undefined there.
///
/// Below a few standard deviations of its velocity the dry friction of a stuck joint is anything in [−Fc, Fc]. Whether
/// it is shows in the residual itself: where it is no larger at rest than in motion, nothing is thrown away; a little
/// larger may be a cause of low speed at a shape between two trials, and a log that mostly rests has nothing else. Where
/// samples of a rest are left out, the `order` rows after it go too, for their prediction reaches into it.
fn rest_weights<const N: usize>(data: &RegressionData<N>, left: &[f64], joint: usize, order: usize) -> Vec<f64> {
    let standing = data.standing(joint);
    // Robust: a push that happens to fall into a rest is none of its own.
    let scale = |pick: &dyn Fn(f64) -> bool| {
        robust_sd(left.iter().zip(standing).filter(|(_, share)| pick(**share)).map(|(r, _)| *r))
    };
    let (rest, motion) = (scale(&|share| share > 0.5), scale(&|share| share < 0.1));
    let mut weights = vec![1.0; left.len()];
    if rest <= REST_RATIO * motion {
        return weights;
    }
    for burst in &data.bursts {
        let mut since_rest = usize::MAX;
        for k in burst.out.clone() {
            since_rest = if standing[k] > STANDING_SHARE { 0 } else { since_rest.saturating_add(1) };
            if since_rest <= order {
                weights[k] = 0.0;
            }
        }
    }
    let left_out = weights.iter().filter(|weight| **weight == 0.0).count();
    if rest <= STUCK_RATIO * motion || left_out + LEAST_MOVING > weights.len() {
        let excess = (rest / motion.max(f64::MIN_POSITIVE)).powi(2) - 1.0;
        return standing.iter().map(|s| 1.0 / (1.0 + excess * s.clamp(0.0, 1.0)).sqrt()).collect();
    }
    weights
}
