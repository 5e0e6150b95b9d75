//! What a plain fit predicts: the least that a diagnosis must beat.
//!
//! ```text
//! plain:  y_j = τ0_j + offset + Fc s + Fv qd                          per joint, least squares
//! full:   y = Y π + offset + Fc s + Fv qd + Ir qdd                    all joints, truncated least squares about the nominal π
//! ```
//!
//! The truncation of the full refit is chosen by cross-validation over the parts that it is fitted to.

use nalgebra::{DMatrix, DVector};

use crate::fit::plain_state;
use crate::joint_term::JointTerm;
use crate::problem::{Place, Problem, State};
use crate::split::{Split, folds};

/// Singular values kept, relative to the largest of unit columns.
const TRUNCATIONS: [f64; 10] = [0.1, 0.05, 0.03, 0.02, 0.01, 5e-3, 3e-3, 1e-3, 3e-4, 1e-4];

/// The baselines by name.
pub struct Baselines {
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
            .filter(|i| {
                matches!(
                    problem.places[*i],
                    Place::Own(_, JointTerm::Offset | JointTerm::Coulomb | JointTerm::Viscous | JointTerm::Rotor)
                        | Place::Link(..)
                )
            })
            .collect();
        let normal = |parts: &[usize]| Refit::of(problem, &own, &sd, parts);
        let whole = normal(parts);
        // Squares of what is left of each part by the refit to all others, truncation by truncation.
        let mut unseen = [0.0; TRUNCATIONS.len()];
        for part in parts {
            let own_part = std::slice::from_ref(part);
            let left_out = normal(own_part);
            let rest = Truncated::of(&whole.without(&left_out));
            for (sum, truncation) in unseen.iter_mut().zip(TRUNCATIONS) {
                let squares = problem.mean_squares(&rest.state(problem, &own, truncation), own_part);
                let weighted = squares.iter().zip(&sd).map(|(square, sd)| square / sd.powi(2)).sum::<f64>();
                *sum += weighted * left_out.samples;
            }
        }
        let best = TRUNCATIONS
            .into_iter()
            .zip(unseen)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(TRUNCATIONS[0], |(truncation, _)| truncation);
        Self { full: Truncated::of(&whole).state(problem, &own, best), plain }
    }
}

/// RMS (Nm) that nominal model and baselines leave of each joint on parts that were held out.
#[derive(Clone, Debug, PartialEq)]
pub struct PlainFits {
    /// How the parts were held out.
    pub split: Split,
    /// Of the nominal model.
    pub nominal_nm: Vec<f64>,
    /// Of least squares of dry friction, viscous friction and offset.
    pub plain_nm: Vec<f64>,
    /// Of least squares of these and all base parameters.
    pub full_nm: Vec<f64>,
}

/// Fewest samples of what is held out.
const LEAST_HELD_OUT: usize = 20;

impl PlainFits {
    /// Fits both baselines to the rest of each fold; `None` where a fold is too short to say anything.
    pub fn of(problem: &Problem) -> Option<Self> {
        let (split, folds) = folds(problem);
        let columns = &problem.columns;
        if folds.iter().any(|held_out| columns.samples(held_out) < LEAST_HELD_OUT) {
            return None;
        }
        let joints = problem.joints();
        let nominal = DVector::zeros(problem.places.len());
        let (mut squares, mut samples) = ([(); 3].map(|()| vec![0.0; joints]), 0);
        for held_out in &folds {
            let rest = |part: &usize| !held_out.contains(part);
            let seen: Vec<usize> = problem.all_parts().into_iter().filter(rest).collect();
            let Baselines { plain, full } = Baselines::of(problem, &seen);
            for (sum, state) in squares.iter_mut().zip([&nominal, &plain, &full]) {
                for (j, sum) in sum.iter_mut().enumerate() {
                    *sum += held_out.iter().map(|part| problem.unseen_square(state, j, *part)).sum::<f64>();
                }
            }
            samples += columns.samples(held_out);
        }
        let [nominal_nm, plain_nm, full_nm] =
            squares.map(|sum| sum.into_iter().map(|sum| (sum / samples as f64).sqrt()).collect());
        Some(Self { split, nominal_nm, plain_nm, full_nm })
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

    /// The equations of all parts but these.
    fn without(&self, part: &Self) -> Self {
        Self { gram: &self.gram - &part.gram, score: &self.score - &part.score, samples: self.samples - part.samples }
    }
}

/// Normal equations of unit columns in their own directions.
struct Truncated {
    directions: DMatrix<f64>,
    values: DVector<f64>,
    /// Score along each direction.
    along: DVector<f64>,
    scale: Vec<f64>,
}

impl Truncated {
    fn of(refit: &Refit) -> Self {
        let n = refit.score.len();
        let unit = |i: usize| refit.gram[(i, i)].max(0.0).sqrt();
        let scale: Vec<f64> = (0..n).map(|i| if unit(i) > 0.0 { unit(i).recip() } else { 0.0 }).collect();
        let eigen = DMatrix::from_fn(n, n, |r, c| refit.gram[(r, c)] * scale[r] * scale[c]).symmetric_eigen();
        let score = DVector::from_fn(n, |i, _| refit.score[i] * scale[i]);
        let along = eigen.eigenvectors.tr_mul(&score);
        Self { directions: eigen.eigenvectors, values: eigen.eigenvalues, along, scale }
    }

    /// Least squares in the directions whose singular value is above `truncation` of the largest.
    fn state(&self, problem: &Problem, own: &[usize], truncation: f64) -> State {
        let least = truncation.powi(2) * self.values.max();
        let kept = DVector::from_fn(self.values.len(), |k, _| {
            if self.values[k] > least { self.along[k] / self.values[k] } else { 0.0 }
        });
        let found = &self.directions * kept;
        let mut state = DVector::zeros(problem.places.len());
        own.iter().enumerate().for_each(|(i, parameter)| state[*parameter] = found[i] * self.scale[i]);
        state
    }
}
