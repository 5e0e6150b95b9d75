//! What a plain fit predicts: the least that a diagnosis must beat.
//!
//! ```text
//! plain:  y_j = τ0_j + offset + Fc s + Fv qd                          per joint, least squares
//! full:   y = Y π + offset + Fc s + Fv qd + Ir qdd                    all joints, truncated least squares about the nominal π
//! ```
//!
//! The truncation of the full refit is chosen by cross-validation over the parts that it is fitted to.

use nalgebra::{DMatrix, DVector};

use super::columns::JointTerm;
use super::fit::plain_state;
use super::problem::{Place, Problem, State};

/// Singular values kept, relative to the largest of unit columns.
const TRUNCATIONS: [f64; 10] = [0.1, 0.05, 0.03, 0.02, 0.01, 5e-3, 3e-3, 1e-3, 3e-4, 1e-4];

/// The baselines by name.
pub(crate) struct Baselines {
    /// Coulomb + viscous + offset.
    pub plain: State,
    /// Every base parameter besides.
    pub full: State,
}

impl Baselines {
    /// Fits both to some parts.
    pub fn of(problem: &Problem, parts: &[usize]) -> Self {
        let plain = plain_state(problem, parts);
        let sd: Vec<f64> = problem.mean_squares(&plain, parts).iter().map(|square| square.sqrt().max(1e-6)).collect();
        let own: Vec<usize> = (0..problem.places.len())
            .filter(|i| match problem.places[*i] {
                Place::Own(_, JointTerm::Offset | JointTerm::Coulomb | JointTerm::Viscous | JointTerm::Rotor) => true,
                Place::Link(..) => true,
                _ => false,
            })
            .collect();
        let normal = |parts: &[usize]| Refit::of(problem, &own, &sd, parts);
        let whole = normal(parts);
        let each: Vec<Refit> = parts.iter().map(|part| normal(std::slice::from_ref(part))).collect();
        let unseen = |truncation: f64| -> f64 {
            (0..parts.len())
                .map(|k| {
                    let others: Vec<usize> = (0..parts.len()).filter(|other| *other != k).map(|k| parts[k]).collect();
                    let state = normal(&others).solve(problem, &own, truncation);
                    let squares = problem.mean_squares(&state, std::slice::from_ref(&parts[k]));
                    squares.iter().zip(&sd).map(|(square, sd)| square / sd.powi(2)).sum::<f64>() * each[k].samples
                })
                .sum()
        };
        let best = TRUNCATIONS
            .into_iter()
            .map(|truncation| (truncation, unseen(truncation)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(TRUNCATIONS[0], |(truncation, _)| truncation);
        Self { full: whole.solve(problem, &own, best), plain }
    }
}

/// Normal equations of the full refit, joints weighted by what the plain fit leaves.
struct Refit {
    gram: DMatrix<f64>,
    score: DVector<f64>,
    samples: f64,
}

impl Refit {
    fn of(problem: &Problem, own: &[usize], sd: &[f64], parts: &[usize]) -> Self {
        let equations = problem.normal_equations(&DVector::zeros(problem.places.len()), parts);
        let mut sum = Self {
            gram: DMatrix::zeros(own.len(), own.len()),
            score: DVector::zeros(own.len()),
            samples: equations.samples as f64,
        };
        for (joint, sd) in equations.joints.iter().zip(sd) {
            let weight = sd.powi(-2);
            let local: Vec<Option<usize>> =
                own.iter().map(|i| joint.index.iter().position(|other| other == i)).collect();
            for (c, column) in local.iter().enumerate().filter_map(|(c, l)| Some((c, (*l)?))) {
                sum.score[c] += weight * joint.score[column];
                for (r, row) in local.iter().enumerate().filter_map(|(r, l)| Some((r, (*l)?))) {
                    sum.gram[(r, c)] += weight * joint.gram[(row, column)];
                }
            }
        }
        sum
    }

    fn solve(&self, problem: &Problem, own: &[usize], truncation: f64) -> State {
        let n = own.len();
        let scale: Vec<f64> =
            (0..n).map(|i| if self.gram[(i, i)] > 0.0 { self.gram[(i, i)].sqrt().recip() } else { 0.0 }).collect();
        let unit = DMatrix::from_fn(n, n, |r, c| self.gram[(r, c)] * scale[r] * scale[c]);
        let eigen = unit.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let score = DVector::from_fn(n, |i, _| self.score[i] * scale[i]);
        let mut state = DVector::zeros(problem.places.len());
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value > truncation.powi(2) * largest {
                let direction = eigen.eigenvectors.column(k);
                let along = direction.dot(&score) / value;
                own.iter().enumerate().for_each(|(i, parameter)| state[*parameter] += direction[i] * along * scale[i]);
            }
        }
        state
    }
}
