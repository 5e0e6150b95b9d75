//! The window during which somebody pushed.

use std::sync::Arc;

use nalgebra::{Matrix6, Vector6};

use crate::cause::{Candidate, ExternalContact};
use crate::column::{Column, subtracted};
use crate::evidence::{free_gain, joint_fit};
use crate::golden_section::golden_section;
use crate::noise_level::robust_sd;
use crate::push_window::PushWindow;
use crate::regression_data::RegressionData;
use crate::system::{System, dot};

/// Pieces that a log is cut into for the coarse scan.
const PIECES: usize = 220;
/// Shortest window (s).
const SHORTEST_S: f64 = 0.4;
/// Longest window, part of the log: a push that never ends is a payload.
const LONGEST_PART: f64 = 0.6;
/// How well the edges are known (s).
const EDGE_S: f64 = 2e-3;
/// Most moves of an edge.
const MOST_MOVES: usize = 12;
/// Evidence per row of the window that is worth building its columns.
const LEAST_EXPLAINED: f64 = 100.0;

/// The window in which a constant wrench explains most of what the columns `given` leave.
///
/// ```text
/// maximise sᵀ A⁻¹ s,   s = Σ_window Zᵀ r,   A = Σ_window Zᵀ Z,   Z = −Jᵀ whitened
/// ```
///
/// Cumulative sums over pieces make every pair of edges a 6×6 solve; the edges of the best are then moved sample by
/// sample. `None` if no window explains anything.
pub fn best_window<const N: usize>(system: &System<'_, N>, given: &[usize]) -> Option<PushWindow> {
    let data = system.data;
    if data.transmission {
        return None;
    }
    let left = residual(system, given);
    let rows_of = |log: usize| {
        (0..system.joint_rows).filter(|row| data.bursts[system.row_bursts[*row]].log == log).collect::<Vec<usize>>()
    };
    let time_s = |row: usize| data.time_s[system.row_samples[row]];
    best_of(data, &rows_of, &time_s, system.push_columns(), &left).map(|(_, window)| window)
}

/// The window of a push in what a fit leaves of every joint (Nm, output samples, rows weighted by `weights`), where a constant wrench explains
/// at least `least_share` of that, every joint measured by the spread of most of its samples.
pub fn dominant_window<const N: usize>(
    data: &RegressionData<N>,
    left_nm: &[Vec<f64>],
    weights: &[&[f64]],
    least_share: f64,
) -> Option<PushWindow> {
    if data.transmission {
        return None;
    }
    let sd: Vec<f64> = left_nm.iter().map(|left| robust_sd(left.iter().copied()).max(f64::MIN_POSITIVE)).collect();
    let mut push = ExternalContact { log: None }.filtered(data, &[f64::NEG_INFINITY, f64::INFINITY]);
    for column in &mut push {
        for (j, values) in column.rows.iter_mut().enumerate() {
            if let Some(values) = values {
                Arc::make_mut(values).iter_mut().zip(weights[j]).for_each(|(x, weight)| *x *= weight / sd[j]);
            }
        }
    }
    let left = Column::of_rows(std::array::from_fn(|j| left_nm[j].iter().map(|x| x / sd[j]).collect()));
    let total = dot(&left, &left);
    let rows_of = |log: usize| {
        let bursts = data.bursts.iter().filter(|burst| burst.log == log);
        bursts.flat_map(|burst| burst.out.clone()).collect::<Vec<usize>>()
    };
    let (explained, window) = best_of(data, &rows_of, &|row| data.time_s[row], &push, &left)?;
    (explained > least_share * total).then_some(window)
}

/// The best window of all logs and what it explains.
fn best_of<const N: usize>(
    data: &RegressionData<N>,
    rows_of: &dyn Fn(usize) -> Vec<usize>,
    time_s: &dyn Fn(usize) -> f64,
    push: &[Column<N>],
    left: &Column<N>,
) -> Option<(f64, PushWindow)> {
    let mut best: Option<(f64, usize, usize, usize)> = None;
    for log in 0..data.chains.len() {
        let rows = rows_of(log);
        let sums = CumulativeSums::of(&rows, push, left);
        let step = (rows.len() / PIECES).max(1);
        let longest = (rows.len() as f64 * LONGEST_PART) as usize;
        let shortest = (SHORTEST_S * data.chains[log].output_rate_hz()).ceil() as usize;
        let mut log_best = (0.0, 0, 0);
        for start in (0..rows.len()).step_by(step) {
            let last = (start + longest).min(rows.len());
            let mut end = start + shortest.max(step);
            while end <= last {
                let value = sums.explained(start, end);
                if value > log_best.0 {
                    log_best = (value, start, end);
                }
                end += step;
            }
        }
        // Edges, sample by sample.
        let (mut value, mut start, mut end) = log_best;
        for _ in 0..3 {
            for candidate in start.saturating_sub(step)..(start + step).min(end.saturating_sub(shortest)) {
                let moved = sums.explained(candidate, end);
                if moved > value {
                    (value, start) = (moved, candidate);
                }
            }
            for candidate in (start + shortest).max(end.saturating_sub(step))..(end + step).min(rows.len()) {
                let moved = sums.explained(start, candidate);
                if moved > value {
                    (value, end) = (moved, candidate);
                }
            }
        }
        if value > best.map_or(LEAST_EXPLAINED, |best| best.0) {
            best = Some((value, log, rows[start], rows[end - 1]));
        }
    }
    best.map(|(explained, log, start, end)| {
        let half_s = 0.5 / data.chains[log].output_rate_hz();
        (explained, PushWindow { log, start_s: time_s(start) - half_s, end_s: time_s(end) + half_s })
    })
}

/// The window with its edges moved to where a push explains most, between the samples of the output: a step of a few Newton that
/// comes 20 ms late leaves more than the noise in every joint, for which other causes would be found.
pub fn sharpened<const N: usize>(
    system: &System<'_, N>,
    push: &dyn Candidate<N>,
    window_s: [f64; 2],
    given: &[usize],
) -> [f64; 2] {
    let chain = &system.data.chains[push.log().unwrap_or(0)];
    let within_s = 1.0 / chain.output_rate_hz();
    let explained = |window_s: [f64; 2]| free_gain(system, &system.evaluate(push, &window_s), given).explained;
    let mut best = (explained(window_s), window_s);
    for edge in [0, 1] {
        let centre_s = best.1[edge];
        let mut value = |time_s: f64| {
            let mut moved = best.1;
            moved[edge] = time_s;
            let value = if moved[0] < moved[1] { explained(moved) } else { 0.0 };
            if value > best.0 {
                best = (value, moved);
            }
            value
        };
        golden_section([centre_s - within_s, centre_s + within_s], EDGE_S, MOST_MOVES, &mut value);
    }
    best.1
}

/// Whitened residual after fitting `given`.
pub fn residual<const N: usize>(system: &System<'_, N>, given: &[usize]) -> Column<N> {
    let target = std::array::from_fn(|j| system.target.rows[j].as_deref().cloned().unwrap_or_default());
    let columns: Vec<Column<N>> = given.iter().map(|c| system.columns[*c].clone()).collect();
    Column::of_rows(subtracted(target, &columns, &joint_fit(system, given).coefficients))
}

/// Running sums of Zᵀ Z and Zᵀ r over rows.
struct CumulativeSums {
    square: Vec<Matrix6<f64>>,
    score: Vec<Vector6<f64>>,
}

impl CumulativeSums {
    fn of<const N: usize>(rows: &[usize], jacobian: &[Column<N>], left: &Column<N>) -> Self {
        let (mut square, mut score) = (vec![Matrix6::zeros()], vec![Vector6::zeros()]);
        let (mut a, mut s) = (Matrix6::zeros(), Vector6::zeros());
        for &row in rows {
            for j in 0..N {
                let z = Vector6::from_fn(|c, _| jacobian[c].rows[j].as_ref().map_or(0.0, |values| values[row]));
                let r = left.rows[j].as_ref().map_or(0.0, |values| values[row]);
                a += z * z.transpose();
                s += z * r;
            }
            square.push(a);
            score.push(s);
        }
        Self { square, score }
    }

    fn explained(&self, start: usize, end: usize) -> f64 {
        let square = self.square[end] - self.square[start];
        let score = self.score[end] - self.score[start];
        let ridge = Matrix6::identity() * (1e-6 * square.trace() + 1e-300);
        (square + ridge).cholesky().map_or(0.0, |factor| score.dot(&factor.solve(&score)))
    }
}
