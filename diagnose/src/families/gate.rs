//! Whether a model is wrong everywhere, a little, or right but for a few causes.

use nalgebra::{DMatrix, DVector};
use tribo_posterior::{
    ArmScale, Columns, Family, JointTerm, PARTS, Place, PlainFits, Problem, Start, State, plain_state, posterior,
    push_weights,
};
use tribo_regression::contact_window::dominant_window;
use tribo_regression::{PushWindow, RegressionData, rms, robust_sd};

/// μᵀ S⁻¹ μ of a joint's own friction and offset from which on they are surely others than the model's. Stiction of held joints
/// reaches some hundreds, a fifth of a joint's friction thousands.
const SURE: f64 = 1000.0;
/// The same of a torque that is so many times what every family together leaves: in a noisy or short log nothing reaches thousands.
const SURE_OF_MOST: f64 = 100.0;
const MOST: f64 = 4.0;
/// RMS of that torque over the sensors' noise in the band from which on it matters.
const NOTABLE: f64 = 1.0;
/// Least noise over the RMS of the measured torque.
const LEAST_RELATIVE: f64 = 1e-3;
/// Samples in motion that a joint is asked by: a robot that works its way from point to point pauses for most of its time.
const LEAST_MOVING: usize = 200;
/// Share of standing samples in the filter's window below which a sample counts as one of motion.
const MOVING: f64 = 0.1;
/// What the plain fit leaves, over what every family together leaves, up to which friction and offsets are all that is wrong.
pub(crate) const AS_WELL: f64 = 1.25;
/// What every family together leaves, over the sensors' noise, from which on a joint has more than noise left.
const MUCH_LEFT: f64 = 4.0;

/// How much of a model is wrong.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wrongness {
    /// Whether more than half of the joints differ.
    pub everywhere: bool,
    /// Whether more than a third have friction or an offset that is surely not the model's, and those alone do not explain the log.
    pub in_many_joints: bool,
    /// RMS that all families together leave of each joint (Nm).
    pub left_nm: Vec<f64>,
    /// What plain fits predict of parts that they were not fitted to; `None` where the log is too short, or all is wrong.
    pub plain_fits: Option<PlainFits>,
    /// Pushes beside which the log was asked.
    pub pushes: Vec<PushWindow>,
}

/// Whether more than half of the joints differ from the model: by friction or offset of their own with more beside it, or by more than
/// every family together explains.
///
/// A model that came out of an identification lacks a payload or the friction of one joint; a model that came out of a CAD
/// file, or another copy of the robot, differs in every joint: so do all joints of the real logs of four arms.
///
/// A push is in all joints too, and no property of the arm: where one explains much of what every family together leaves, the rest of the log is asked.
///
/// `whole` is the regression of the data.
pub(crate) fn wrongness<const N: usize>(data: &RegressionData<N>, whole: &Problem) -> Wrongness {
    let (wrong, mut left) = wrongness_around(data, whole, &[]);
    let mut pushes = Vec::new();
    while let Some(Left { left_nm, weights }) = left.filter(|_| pushes.len() < MOST_PUSHES) {
        let weights: Vec<&[f64]> = weights.iter().map(Vec::as_slice).collect();
        let Some(push) = dominant_window(data, &left_nm, &weights, PUSHED_SHARE) else { break };
        pushes.push(push);
        let (rest, left_beside) = wrongness_around(data, &regression(data, &pushes), &pushes);
        if !rest.everywhere {
            // What any user reaches, who knows of no push.
            return Wrongness { plain_fits: PlainFits::of(whole), ..rest };
        }
        left = left_beside;
    }
    wrong
}

/// The regression of data on all families, around pushes that the model does not have.
pub(crate) fn regression<const N: usize>(data: &RegressionData<N>, pushes: &[PushWindow]) -> Problem {
    let scale = ArmScale::of(data);
    let columns = Columns::around(data, &scale, PARTS, pushes);
    Problem::of(data, columns, scale, vec![false; data.chains.len()])
}

/// Pushes that are looked for.
const MOST_PUSHES: usize = 3;
/// Share of what every family together leaves that a push explains where it may be what makes a model look wrong: the rest decides.
const PUSHED_SHARE: f64 = 0.2;

/// What every family together leaves of each joint of a model that is wrong everywhere, and the weights of its rows.
struct Left {
    left_nm: Vec<Vec<f64>>,
    weights: Vec<Vec<f64>>,
}

/// [`wrongness`] of what is beside these pushes.
fn wrongness_around<const N: usize>(
    data: &RegressionData<N>,
    problem: &Problem,
    pushes: &[PushWindow],
) -> (Wrongness, Option<Left>) {
    let parts = problem.all_parts();
    let families: Vec<Family> = Family::of_gears(problem.scale.link_side).collect();
    let Some((all, _)) = posterior(problem, &parts, &Start::of(&families)) else {
        let plain_fits = PlainFits::of(problem);
        let left_nm = vec![f64::INFINITY; N];
        return (
            Wrongness { everywhere: false, in_many_joints: false, left_nm, plain_fits, pushes: pushes.to_vec() },
            None,
        );
    };
    let samples = problem.columns.samples(&parts).max(1) as f64;
    // A simulated log has no sensors' noise, but interpolation.
    let noise_nm = |j: usize| data.noise_floor_nm[j].max(LEAST_RELATIVE * rms(&data.measured_nm[j]));
    let beside: Vec<bool> = push_weights(data, pushes).iter().map(|weight| *weight == 1.0).collect();
    let rms_nm = |state: &State, j: usize| {
        let weighted = problem.residual_along(state, j, &parts);
        let unweighted = weighted.iter().zip(problem.columns.row_weights(j)).map(|(r, weight)| r / weight);
        rms(&unweighted.zip(&beside).filter(|(_, beside)| **beside).map(|(r, _)| r).collect::<Vec<f64>>())
    };
    let left_nm: Vec<f64> = (0..N).map(|j| rms_nm(&all.state, j)).collect();
    let differs = |j: usize| {
        let terms = [JointTerm::Offset, JointTerm::Coulomb, JointTerm::Viscous];
        let own: Vec<usize> = terms.iter().filter_map(|term| problem.index(Place::Own(j, *term))).collect();
        let place = |i: &usize| all.active.iter().position(|active| active == i);
        let Some(active) = own.iter().map(place).collect::<Option<Vec<usize>>>() else { return false };
        // μᵀ S⁻¹ μ: dry and viscous friction share what they tell.
        let spread = DMatrix::from_fn(terms.len(), terms.len(), |r, c| all.covariance[(active[r], active[c])]);
        let mean = DVector::from_fn(terms.len(), |r, _| all.state[own[r]]);
        let Some(inverse) = spread.try_inverse() else { return false };
        let evidence = (mean.transpose() * inverse * &mean)[0];
        let gram = DMatrix::from_fn(terms.len(), terms.len(), |r, c| {
            let of_part = |part: &usize| problem.columns.grams[*part][j][(terms[r].place(), terms[c].place())];
            parts.iter().map(of_part).sum::<f64>()
        });
        let size_nm = ((mean.transpose() * gram * &mean)[0].max(0.0) / samples).sqrt();
        let is_most = evidence > SURE_OF_MOST && size_nm > MOST * left_nm[j];
        (evidence > SURE || is_most) && size_nm > NOTABLE * noise_nm(j)
    };
    let left = |j: usize| {
        // Robust, in motion: a push that lasts seconds is no property of the arm, nor is what holds a joint that stands.
        let residual = problem.residual_along(&all.state, j, &parts);
        let moving = residual.into_iter().zip(data.standing(j)).filter(|(_, share)| **share < MOVING);
        let left = robust_sd(moving.map(|(r, _)| r));
        left > MUCH_LEFT * noise_nm(j)
    };
    // What holds a joint that stands is anything within its dry friction, so that its rests weigh little; one that hardly moves is not asked.
    let moves = |j: &usize| data.standing(*j).iter().filter(|share| **share < MOVING).count() >= LEAST_MOVING;
    let differing = (0..N).filter(moves).filter(|j| differs(*j)).count();
    let leaving = (0..N).filter(moves).filter(|j| left(*j)).count();
    // Friction and offsets alone are few causes of a joint, however many joints have them: a search names each by its law.
    let plain = plain_state(problem, &parts);
    let plain_will_do = (0..N).all(|j| rms_nm(&plain, j) < AS_WELL * left_nm[j].max(noise_nm(j)));
    let everywhere = 2 * leaving > N || (2 * differing > N && !plain_will_do);
    let plain_fits = if everywhere || !pushes.is_empty() { None } else { PlainFits::of(problem) };
    let left = everywhere.then(|| Left {
        left_nm: (0..N).map(|j| problem.residual_along(&all.state, j, &parts)).collect(),
        weights: (0..N).map(|j| problem.columns.row_weights(j).to_vec()).collect(),
    });
    let in_many_joints = 3 * differing > N && !plain_will_do;
    (Wrongness { everywhere, in_many_joints, left_nm, plain_fits, pushes: pushes.to_vec() }, left)
}
