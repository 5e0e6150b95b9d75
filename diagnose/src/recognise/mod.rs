//! What the rigid arm says about a log: signs, order and unit of its torques and positions, gravity, side of the gears, robot.
//!
//! ```text
//! nats(h) = −max ln p(torques | h),     gain(h) = nats(as it is) − nats(h),     h: one thing wrong with the log
//! ```
//!
//! Every hypothesis explains the torques by the same generous regression (`fit.rs`): rigid arm, tilt, payload, and of each joint
//! offset, friction and rotor. Only what such an arm cannot be, and what a turned sign, swapped columns or another unit makes
//! good at once, is named; after the best is taken in, the others are asked again.
//! Leaves out: everything that is a small error of the model, which is what a diagnosis is for.

mod fit;
mod hypothesis;
mod samples;
mod words;

use rayon::prelude::*;
use tribo_logs::RobotLog;
use tribo_logs::recognise::Remark;

use self::fit::{Columns, Fit, MOVES, fit};
use self::hypothesis::{Change, Hypothesis};
use self::samples::Samples;
pub use crate::diagnosable::recognise;
use tribo_regression::Nominal;

/// Gain (nats) from which a hypothesis is named.
///
/// On 200 good simulated logs and 16 real ones no hypothesis that [`Round::convinces`] gains that much; the mutilations of the tests
/// gained 73 or more when it was chosen.
const NAMED_NATS: f64 = 30.0;
/// The same for the side of the gears, of which only a warning says something: at most 0 on good logs, 34 at least on the others.
const SIDE_NATS: f64 = 20.0;
/// By how much less must be left of the torque of one joint at least, and how much of its variance before at least and after at most.
const JOINT_GAIN: f64 = 2.0;
const NOT_EXPLAINED: f64 = 0.15;
const WELL_ENOUGH: f64 = 0.3;
/// By how much less must be left in all by another arm, or another unit; and for gravity to be surely elsewhere than in the model, of
/// which priors alone only warn.
const ARM_GAIN: f64 = 1.5;
/// The same for one joint's torque or position that is explained like noise as it is and well with the opposite sign: at most 1 where the
/// sign is right, 6 at least where it is not, even of a joint that carries nothing and moves little.
const SIGN_NATS: f64 = 4.0;
/// Natural logarithm of the largest factor by which the torque of one joint is off, where only what its weight would be says so.
const LARGEST_FACTOR_LN: f64 = 2.5;
/// Share of the arm's weight that torques hold below which it was surely left out of them.
const WEIGHTLESS: f64 = 0.25;
/// Gain (nats) by which another arm is named although joints of this motion stay unexplained.
const OTHER_ARM_NATS: f64 = 150.0;
/// Lead (nats) over others that say something else.
const LEAD_NATS: f64 = 6.0;
/// Range of a position that may be in degrees, as far as a joint turns in radians without a turn round.
const FEWEST_DEGREES: f64 = 2.0 * std::f64::consts::PI;
/// Things that may be wrong at the same time.
const MOST_CHANGES: usize = 3;
/// Joints that may stay unexplained: what a second fault explains, and no contact all over the arm.
const MOST_UNEXPLAINED: usize = 2;
/// Nats that tilt, payload, friction and rotors of an arm cost against their priors, at most; and by how much less they must cost where
/// nothing else speaks for a hypothesis.
const PLAUSIBLE_NATS: f64 = 15.0;
const IMPLAUSIBLE_NATS: f64 = 40.0;
/// Gain (nats) that convinces where a joint is explained of which the log as it is leaves as much as a constant would.
const DECISIVE_NATS: f64 = 60.0;
const AS_A_CONSTANT: f64 = 0.7;
/// Part of the variance that is left of a turned joint's torque at most where the gain decides.
const HALF: f64 = 0.5;
/// By how much more a hypothesis may leave of any torque that is not explained well.
const NO_WORSE: f64 = 1.1;

/// The remarks of [`recognise`].
pub(crate) fn by_the_arm<const N: usize>(log: &RobotLog, nominal: &Nominal<N>) -> Vec<Remark> {
    if log.joints() != N {
        return Vec::new();
    }
    let nominal = nominal.with_rigid_effects_in_the_arm();
    let Some(samples) = Samples::<N>::of(log) else { return Vec::new() };
    let names = &nominal.arm.joint_names;
    let constant = samples.constant_torques();
    if !constant.is_empty() {
        return vec![words::constant(constant, names)];
    }
    let mut believed = Hypothesis::as_it_is(&nominal);
    let (mut changes, mut remarks) = (Vec::new(), Vec::new());
    while changes.len() < MOST_CHANGES {
        let Some(round) = Round::of(&samples, &believed, &nominal) else { break };
        let found = round.found();
        // What another hypothesis does not explain either is not named by it.
        let best = found.as_ref().map_or(&round.before, |found| &found.after);
        if changes.is_empty() && best.explains_nothing() {
            remarks.push(words::unexplained(&round.before, names));
            break;
        }
        let Some(found) = found.filter(|found| !changes.contains(&found.change)) else { break };
        let holds_no_weight = || samples.weight_share(&nominal.arm).is_some_and(|share| share.abs() < WEIGHTLESS);
        let weightless = matches!(found.change, Change::NoGravity) && holds_no_weight();
        remarks.push(words::remark(&found, weightless, names));
        believed = believed.with(&found.change, &nominal);
        changes.push(found.change);
    }
    remarks
}

/// A hypothesis that explains the log better, and those that do nearly as well.
struct Found<const N: usize> {
    change: Change,
    before: Fit<N>,
    after: Fit<N>,
    rivals: Vec<Change>,
    /// Whether what it explains is more than the error of a good log.
    surely: bool,
}

/// All hypotheses about a log, on top of what is believed already.
struct Round<const N: usize> {
    before: Fit<N>,
    tried: Vec<(Change, Fit<N>)>,
}

impl<const N: usize> Round<N> {
    fn of(samples: &Samples<N>, believed: &Hypothesis<N>, nominal: &Nominal<N>) -> Option<Self> {
        let columns = Columns::of(samples, believed);
        let before = fit(samples, believed, &columns)?;
        let well = before.unexplained.iter().all(|left| *left < NOT_EXPLAINED) && before.penalty_nats < PLAUSIBLE_NATS;
        let torques = hypothesis::of_torques::<N>().into_iter().chain(factors(samples, believed, &columns));
        let changes: Vec<Change> = torques
            .chain(hypothesis::of_motion(nominal))
            .filter(|change| !well || change.is_of_the_whole_arm())
            .filter(|change| reaches(samples, change))
            .collect();
        let tried = changes
            .into_par_iter()
            .filter_map(|change| {
                let changed = believed.with(&change, nominal);
                let fitted = match changed.moves_as(believed) {
                    true => fit(samples, &changed, &columns),
                    false => fit(samples, &changed, &Columns::of(samples, &changed)),
                };
                Some((change, fitted?))
            })
            .collect();
        Some(Self { before, tried })
    }

    /// The best hypothesis that convinces, if its gain is clear.
    fn found(&self) -> Option<Found<N>> {
        let clear = |(change, after): &(Change, Fit<N>), unexplained: &[f64; N]| {
            let gain = self.before.nats - after.nats;
            let needed = if matches!(change, Change::OtherSide(_)) { SIDE_NATS } else { NAMED_NATS };
            gain > needed && self.convinces(change, after, unexplained)
                || gain > SIGN_NATS && self.turns_noise_into_sense(change, after, unexplained)
        };
        let clears = self.tried.iter().filter(|tried| clear(tried, &self.before.unexplained));
        let best = clears.min_by(|a, b| a.1.nats.total_cmp(&b.1.nats))?;
        let (change, after) = best;
        let near = |fit: &Fit<N>| fit.nats - after.nats < LEAD_NATS;
        let rivals =
            self.tried.iter().filter(|(other, fit)| other != change && near(fit)).map(|(other, _)| other.clone());
        Some(Found {
            change: change.clone(),
            before: self.before.clone(),
            after: after.clone(),
            rivals: rivals.collect(),
            surely: clear(best, &self.before.blamed),
        })
    }
}

impl<const N: usize> Round<N> {
    /// Whether a hypothesis explains what was not explained, and does not only squeeze out the last percent or move it elsewhere; `unexplained` is what was
    /// not explained of each joint.
    fn convinces(&self, change: &Change, after: &Fit<N>, unexplained: &[f64; N]) -> bool {
        match change {
            // What the priors of tilt and rotors alone speak against.
            Change::OtherSide(_) | Change::NoGravity | Change::Gravity(_) => true,
            Change::OtherRobot(_) => {
                self.before.leaves_over(after, ARM_GAIN) || self.before.nats - after.nats > OTHER_ARM_NATS
            }
            _ => {
                let (before, after) = (&self.before, after);
                let worse = self.worsens(after);
                let explains_from = |least: f64| {
                    (0..N).any(|j| {
                        unexplained[j] > least
                            && before.left[j] > JOINT_GAIN * after.left[j]
                            && after.unexplained[j] < WELL_ENOUGH
                    })
                };
                let decisive = before.nats - after.nats > DECISIVE_NATS && explains_from(AS_A_CONSTANT);
                let many = |fit: &Fit<N>, least: f64| fit.unexplained.iter().filter(|left| **left > least).count();
                let fewer = many(after, NOT_EXPLAINED) < many(before, NOT_EXPLAINED)
                    && many(after, WELL_ENOUGH) <= MOST_UNEXPLAINED;
                // The weight of the arm on a turned joint is an offset that no arm has; a factor on everything is nearly a heavy payload.
                let cheaper = before.penalty_nats - after.penalty_nats > IMPLAUSIBLE_NATS;
                let plausible = match change {
                    Change::JointTorqueFactor(_, factor) => cheaper && factor.ln().abs() < LARGEST_FACTOR_LN,
                    Change::TorqueFactor(_) | Change::AllTorqueSigns => cheaper || before.leaves_over(after, ARM_GAIN),
                    _ => cheaper,
                };
                !worse && (explains_from(NOT_EXPLAINED) && fewer || plausible || decisive)
            }
        }
    }
}

impl<const N: usize> Round<N> {
    /// Whether more is left of a torque that is not explained well.
    fn worsens(&self, after: &Fit<N>) -> bool {
        let more = |j: usize| after.left[j] > NO_WORSE * self.before.left[j] && after.unexplained[j] > NOT_EXPLAINED;
        (0..N).any(more)
    }

    /// Whether the joint whose sign is turned goes from as good as noise to explained, and nothing else gets worse. Friction alone does
    /// that: as it is, the joint would give energy.
    fn turns_noise_into_sense(&self, change: &Change, after: &Fit<N>, unexplained: &[f64; N]) -> bool {
        let (Change::TorqueSign(j) | Change::PositionSign(j)) = change else { return false };
        let moves = self.before.moves[*j] > MOVES;
        let enough = if self.before.nats - after.nats > DECISIVE_NATS { HALF } else { WELL_ENOUGH };
        moves && unexplained[*j] > AS_A_CONSTANT && after.unexplained[*j] < enough && !self.worsens(after)
    }
}

/// Whether positions reach far enough for a hypothesis that takes them for degrees: of a joint that turns by three, nothing could be said.
fn reaches<const N: usize>(samples: &Samples<N>, change: &Change) -> bool {
    let far = |j: usize| samples.range(|at| at.q[j]) > FEWEST_DEGREES;
    match change {
        Change::JointDegrees(j) => far(*j),
        Change::Degrees => (0..N).any(far),
        _ => true,
    }
}

/// Factors between measured and rigid torque that are far from 1.
fn factors<const N: usize>(samples: &Samples<N>, believed: &Hypothesis<N>, columns: &Columns<N>) -> Vec<Change> {
    let products = fit::torque_products(samples, believed, columns);
    // Together the joints that carry the arm decide, of which friction is the smallest part.
    let (cross, square) = products.iter().fold((0.0, 0.0), |sum, joint| (sum.0 + joint.0, sum.1 + joint.1));
    let mut changes: Vec<Change> = [1e3, 1e-3, cross / square].into_iter().map(Change::TorqueFactor).collect();
    changes
        .extend(products.iter().enumerate().map(|(j, (cross, square))| Change::JointTorqueFactor(j, cross / square)));
    let far = |factor: f64| factor > 0.0 && (0.6..9.0).contains(&factor.ln().abs());
    changes.retain(|change| matches!(change, Change::TorqueFactor(k) | Change::JointTorqueFactor(_, k) if far(*k)));
    changes
}
