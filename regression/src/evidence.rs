//! What one more group explains, given those selected.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::column::Column;
use crate::least_squares::{Gain, OWN_PART, solve_ridge, solve_truncated};
use crate::system::{System, dot};

/// The problem with the selected columns projected out.
///
/// ```text
/// W = L⁻¹ G_S,   v = L⁻¹ b_S,   L Lᵀ = G_SS;    A = G_CC − W_Cᵀ W_C + U_Cᵀ U_C,   b = b_C − W_Cᵀ v + U_Cᵀ u
/// ```
///
/// U and u give back what columns g of the selection explain that are left out again, see [`Selection`].
pub struct Conditional {
    projected: Arc<DMatrix<f64>>,
    explained: Arc<DVector<f64>>,
    lower: Arc<DMatrix<f64>>,
    given_back: Option<(DMatrix<f64>, DVector<f64>)>,
}

/// A selection all of whose members are projected out, and what it takes to leave any of them out again.
///
/// ```text
/// P = G_SS⁻¹,   Z = P G_S,   β = P b_S;    U = C⁻¹ Z_g,   u = C⁻¹ β_g,   C Cᵀ = P_gg
/// ```
///
/// Leaving one member out of a selection is a downdate of few rows; projecting out all others anew takes the selection's size as often.
pub struct Selection {
    whole: Conditional,
    inverse: DMatrix<f64>,
    coefficients: DMatrix<f64>,
    fitted: DVector<f64>,
}

impl Selection {
    /// Projects out the given columns.
    pub fn of<const N: usize>(system: &System<'_, N>, selected: &[usize]) -> Self {
        let whole = Conditional::on(system, selected);
        let upper = whole.lower.transpose();
        let solved = |right: &DMatrix<f64>| upper.solve_upper_triangular(right).unwrap_or_else(|| right.clone());
        let identity = DMatrix::identity(selected.len(), selected.len());
        let inverse_lower = whole.lower.solve_lower_triangular(&identity).unwrap_or(identity);
        let inverse = solved(&inverse_lower);
        let coefficients = solved(&whole.projected);
        let fitted = upper.solve_upper_triangular(&whole.explained).unwrap_or_else(|| (*whole.explained).clone());
        Self { whole, inverse, coefficients, fitted }
    }

    /// The selection without the columns at these places of it; `None` where they are twins of others.
    pub fn without(&self, places: std::ops::Range<usize>) -> Option<Conditional> {
        let (first, count) = (places.start, places.len());
        let lower = self.inverse.view((first, first), (count, count)).into_owned().cholesky()?.l();
        let given_back = lower.solve_lower_triangular(&self.coefficients.rows(first, count).into_owned())?;
        let score = lower.solve_lower_triangular(&self.fitted.rows(first, count).into_owned())?;
        let Conditional { projected, explained, lower, .. } = &self.whole;
        Some(Conditional {
            projected: Arc::clone(projected),
            explained: Arc::clone(explained),
            lower: Arc::clone(lower),
            given_back: Some((given_back, score)),
        })
    }
}

impl Conditional {
    /// Projects out the given columns.
    pub fn on<const N: usize>(system: &System<'_, N>, selected: &[usize]) -> Self {
        let count = system.columns.len();
        if selected.is_empty() {
            return Self {
                projected: Arc::new(DMatrix::zeros(0, count)),
                explained: Arc::new(DVector::zeros(0)),
                lower: Arc::new(DMatrix::zeros(0, 0)),
                given_back: None,
            };
        }
        let (square, score) = unit_gram(system, selected);
        let rows = DMatrix::from_fn(selected.len(), count, |i, c| {
            system.gram[(selected[i], c)] / column_norm(system, selected[i])
        });
        let lower = square.cholesky().map_or_else(|| DMatrix::identity(selected.len(), selected.len()), |c| c.l());
        let projected = lower.solve_lower_triangular(&rows).unwrap_or(rows);
        let explained = lower.solve_lower_triangular(&score).unwrap_or(score);
        Self {
            projected: Arc::new(projected),
            explained: Arc::new(explained),
            lower: Arc::new(lower),
            given_back: None,
        }
    }

    /// What the columns explain beyond the selected ones.
    pub fn gain<const N: usize>(&self, system: &System<'_, N>, columns: &[usize]) -> Gain {
        let k = columns.len();
        let square = self.square(system, columns);
        let score = DVector::from_fn(k, |i, _| {
            let given_back = self.given_back.as_ref().map_or(0.0, |(u, score)| u.column(columns[i]).dot(score));
            system.score[columns[i]] - self.projected.column(columns[i]).dot(&self.explained) + given_back
        });
        let norms = DVector::from_fn(k, |i, _| system.gram[(columns[i], columns[i])].sqrt());
        solve_truncated(&square, &score, &norms, OWN_PART)
    }

    /// Gram matrix of columns beyond the selected ones.
    pub fn square<const N: usize>(&self, system: &System<'_, N>, columns: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(columns.len(), columns.len(), |i, m| {
            let product = |of: &DMatrix<f64>| of.column(columns[i]).dot(&of.column(columns[m]));
            let given_back = self.given_back.as_ref().map_or(0.0, |(u, _)| product(u));
            system.gram[(columns[i], columns[m])] - product(&self.projected) + given_back
        })
    }

    /// Scores of all columns for other data, beyond the selected columns.
    pub fn projected_scores<const N: usize>(
        &self,
        system: &System<'_, N>,
        selected: &[usize],
        scores: &[f64],
    ) -> Vec<f64> {
        if selected.is_empty() {
            return scores.to_vec();
        }
        let own = DVector::from_fn(selected.len(), |i, _| scores[selected[i]] / column_norm(system, selected[i]));
        debug_assert!(self.given_back.is_none(), "a whole selection");
        let explained = self.lower.solve_lower_triangular(&own).unwrap_or(own);
        (0..scores.len()).map(|c| scores[c] - self.projected.column(c).dot(&explained)).collect()
    }
}

/// What a few columns of the system explain beyond others, without projecting the whole system.
pub fn gain_given<const N: usize>(system: &System<'_, N>, columns: &[usize], given: &[usize]) -> Gain {
    let k = columns.len();
    let square = DMatrix::from_fn(k, k, |i, m| system.gram[(columns[i], columns[m])]);
    let score = DVector::from_fn(k, |i, _| system.score[columns[i]]);
    gain_beyond(system, given, square, score, |g, m| system.gram[(g, columns[m])])
}

/// What columns outside the system explain beyond columns of it.
pub fn free_gain<const N: usize>(system: &System<'_, N>, columns: &[Column<N>], given: &[usize]) -> Gain {
    let k = columns.len();
    let square = DMatrix::from_fn(k, k, |i, m| dot(&columns[i], &columns[m]));
    let score = DVector::from_fn(k, |i, _| dot(&columns[i], &system.target));
    gain_beyond(system, given, square, score, |g, m| dot(&system.columns[g], &columns[m]))
}

/// Projects columns `given` of the system out of others with this Gram matrix and score; `product` of a given column and
/// one of the others.
fn gain_beyond<const N: usize>(
    system: &System<'_, N>,
    given: &[usize],
    mut square: DMatrix<f64>,
    mut score: DVector<f64>,
    product: impl Fn(usize, usize) -> f64,
) -> Gain {
    let (k, s) = (score.len(), given.len());
    let norms = DVector::from_fn(k, |i, _| square[(i, i)].sqrt());
    if s > 0 {
        let (selected, selected_score) = unit_gram(system, given);
        let cross = DMatrix::from_fn(s, k, |i, m| product(given[i], m) / column_norm(system, given[i]));
        let Some(factor) = selected.cholesky() else {
            return Gain { explained: 0.0, directions: 0, coefficients: vec![0.0; k] };
        };
        square -= cross.transpose() * factor.solve(&cross);
        score -= cross.transpose() * factor.solve(&selected_score);
    }
    solve_truncated(&square, &score, &norms, OWN_PART)
}

/// Gram matrix and score of columns of the system scaled to unit length, with a ridge against exact twins.
fn unit_gram<const N: usize>(system: &System<'_, N>, columns: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
    let k = columns.len();
    let norm = |i: usize| column_norm(system, columns[i]);
    let square = DMatrix::from_fn(k, k, |i, m| {
        let value = system.gram[(columns[i], columns[m])] / (norm(i) * norm(m));
        if i == m { value + TWIN_RIDGE } else { value }
    });
    (square, DVector::from_fn(k, |i, _| system.score[columns[i]] / norm(i)))
}

fn column_norm<const N: usize>(system: &System<'_, N>, column: usize) -> f64 {
    let norm = system.gram[(column, column)].sqrt();
    // An empty column has no length to be scaled to.
    if norm > 0.0 { norm } else { 1.0 }
}

/// Ridge of a projection, relative to unit columns.
const TWIN_RIDGE: f64 = 1e-9;

/// Sum of squares that columns explain together.
pub fn explained_by<const N: usize>(system: &System<'_, N>, columns: &[usize]) -> f64 {
    joint_fit(system, columns).explained
}

/// Coefficients of columns fitted together.
pub fn joint_fit<const N: usize>(system: &System<'_, N>, columns: &[usize]) -> Gain {
    let k = columns.len();
    let square = DMatrix::from_fn(k, k, |i, m| system.gram[(columns[i], columns[m])]);
    let score = DVector::from_fn(k, |i, _| system.score[columns[i]]);
    solve_ridge(&square, &score, &system.ridges(columns))
}

#[cfg(test)]
mod tests {
    use tribo_robot::presets;
    use tribo_sim::excitation::{Envelope, Excitation};
    use tribo_sim::{Effect, Recording, Truth, record};

    use super::*;
    use crate::Nominal;
    use crate::cause::{Candidate, candidates};
    use crate::regression_data::RegressionData;
    use crate::system::EvaluatedColumns;

    /// A Panda with a payload that its model does not have, and all candidates.
    fn payload_and_candidates() -> (RegressionData<7>, Vec<Arc<dyn Candidate<7>>>) {
        let hidden = vec![Effect::Payload { mass_kg: 0.4, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] }];
        let plain = Truth::<7>::panda_coulomb_viscous();
        let truth = Truth { effects: hidden, ..plain.clone() };
        let around = Envelope::around(&plain.arm, presets::panda_ready_pose());
        let motion = Excitation::Multisine.draw(&around, 15.0, 5);
        let recording = Recording::default();
        let log = record(&truth, 0.01, motion.as_ref(), &recording, 1).unwrap();
        let Truth { arm, friction, .. } = plain;
        let torque_side = recording.torque_side;
        let nominal = Nominal { smoothing_rad_s: 0.01, ..Nominal::new(arm, friction, torque_side) };
        let data = RegressionData::of_logs(&[log], &nominal, None).unwrap();
        (data, candidates::<7>().into_iter().map(Arc::from).collect())
    }

    /// Shared columns are those that the candidate itself has, and there are some.
    #[test]
    fn every_candidate_has_its_own_columns() {
        let (data, causes) = payload_and_candidates();
        let evaluated = EvaluatedColumns::of(&data, &causes);
        let mut own = 0;
        for group in &evaluated.groups {
            let filtered = group.candidate.filtered(&data, &group.shape);
            own += filtered.len();
            let place = (group.candidate.label(), group.candidate.location());
            assert_eq!(filtered.len(), group.columns.len(), "{place:?}");
            for (one, other) in filtered.iter().zip(&evaluated.columns[group.columns.clone()]) {
                assert_eq!(one.rows, other.rows, "{place:?}");
            }
        }
        // Of each link first moments (3) and mass (4), the point mass (4), the small tilt (2).
        assert_eq!(own - evaluated.columns.len(), 7 * 7 + 4 + 2);
    }

    /// Second algorithm: all others projected out anew.
    #[test]
    fn leaving_one_member_out_is_projecting_out_the_others() {
        let (data, causes) = payload_and_candidates();
        let evaluated = EvaluatedColumns::of(&data, &causes);
        let left = evaluated.saturated_residual(&data);
        let system = System::new(&data, evaluated.groups.clone(), &evaluated.columns, &left);

        let members: Vec<usize> = (0..system.groups.len()).step_by(system.groups.len() / 6).collect();
        let columns = system.columns_of(&members);
        let whole = Selection::of(&system, &columns);
        let mut compared = 0;
        for (place, member) in members.iter().enumerate() {
            let others: Vec<usize> = members.iter().copied().filter(|other| other != member).collect();
            let anew = Conditional::on(&system, &system.columns_of(&others));
            let first = system.columns_of(&members[..place]).len();
            let downdate = whole.without(first..first + system.groups[*member].columns.len()).unwrap();
            for group in &system.groups {
                let columns: Vec<usize> = group.columns.clone().collect();
                let [one, other] = [&anew, &downdate].map(|given| given.gain(&system, &columns));
                let size = one.explained.max(1.0);
                assert!((one.explained - other.explained).abs() < 1e-5 * size, "{member}: {one:?} {other:?}");
                assert_eq!(one.directions, other.directions, "{member}: {one:?} {other:?}");
                compared += 1;
            }
        }
        assert!(compared > 500, "{compared}");
    }
}
