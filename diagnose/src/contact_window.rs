//! The window during which somebody pushed.

use nalgebra::{Matrix6, Vector6};

use crate::evidence::joint_fit;
use crate::scene::{Column, add_scaled};
use crate::system::System;

/// Pieces that a log is cut into for the coarse scan.
const PIECES: usize = 220;
/// Shortest window (s).
const SHORTEST_S: f64 = 0.4;
/// Longest window, part of the log: a push that never ends is a payload.
const LONGEST_PART: f64 = 0.6;
/// Evidence per row of the window that is worth building its columns.
const LEAST_EXPLAINED: f64 = 100.0;

/// Log, start and end (s) of the window in which a constant wrench explains most of what the columns `given` leave.
///
/// ```text
/// maximise sᵀ A⁻¹ s,   s = Σ_window Zᵀ r,   A = Σ_window Zᵀ Z,   Z = −Jᵀ whitened
/// ```
///
/// Cumulative sums over pieces make every pair of edges a 6×6 solve; the edges of the best are then moved sample by
/// sample. `None` if no window explains anything.
pub(crate) fn best_window<const N: usize>(system: &System<'_, N>, given: &[usize]) -> Option<(usize, f64, f64)> {
    let scene = system.scene;
    if scene.transmission {
        return None;
    }
    let left = residual(system, given);

    let mut best: Option<(f64, usize, usize, usize)> = None;
    for log in 0..scene.chains.len() {
        let rows: Vec<usize> =
            (0..system.joint_rows).filter(|row| scene.bursts[system.row_bursts[*row]].log == log).collect();
        let sums = CumulativeSums::of(&rows, system.push_columns(), &left);
        let step = (rows.len() / PIECES).max(1);
        let longest = (rows.len() as f64 * LONGEST_PART) as usize;
        let shortest = (SHORTEST_S * scene.chains[log].output_rate_hz()).ceil() as usize;
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
    best.map(|(_, log, start, end)| {
        let half_s = 0.5 / scene.chains[log].output_rate_hz();
        let time_s = |row: usize| scene.time_s[system.row_samples[row]];
        (log, time_s(start) - half_s, time_s(end) + half_s)
    })
}

/// Whitened residual after fitting `given`.
pub(crate) fn residual<const N: usize>(system: &System<'_, N>, given: &[usize]) -> Column<N> {
    let fit = joint_fit(system, given);
    let mut left = system.target.clone();
    for (c, coefficient) in given.iter().zip(&fit.coefficients) {
        for (left, x) in left.rows.iter_mut().zip(&system.columns[*c].rows) {
            if let (Some(left), Some(x)) = (left, x) {
                add_scaled(left, x, -coefficient);
            }
        }
    }
    left
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
