//! How well the rigid arm with plain friction explains the torques.
//!
//! ```text
//! tau_j = [M qdd + C qd + g](q, qd, qdd)_j + δg · G_j + δπ · Y_j + o_j + c_j tanh(qd_j/ε) + v_j qd_j + r_j qdd_j + e_j,   e_j ~ N(0, σ_j²)
//! ```
//!
//! δg: tilt of the base; δπ: mass and first moment of a payload; o, c, v, r: offset, Coulomb and viscous friction and rotor of
//! each joint. Priors say how large these are on arms, σ_j is what is left. Friction takes energy: where c and v of a joint
//! would give some, both are zero. The score is the negative logarithm of the posterior density at its maximum, in nats, with
//! correlated samples counted as a few per second.

use nalgebra::{DMatrix, DVector, SVector, Vector3};
use tribo_robot::{Arm, gravity_torque, inverse_dynamics_regressor, rnea};

use super::hypothesis::Hypothesis;
use super::samples::{Instant, Samples};

/// Shared parameters: gravity, mass, first moment.
const SHARED: usize = 7;
/// Own parameters of a joint: offset, Coulomb, viscous, rotor.
const OWN: usize = 4;
/// Deviations of the shared ones: base tilt as gravity (m/s²), payload (kg), first moment (kg m).
const SHARED_SD: [f64; SHARED] = [0.8, 0.8, 0.8, 2.0, 0.3, 0.3, 0.3];
/// Deviations over the torque limit of a joint: offset, Coulomb (Nm), viscous (Nm s/rad).
const OVER_LIMIT: [f64; 3] = [0.05, 0.3, 0.5];
/// Deviation of a rotor over its nominal value, and at least (kg m²).
const ROTOR_SD: [f64; 2] = [0.3, 0.05];
/// Width of the smooth sign (rad/s): that of a speed which the smoother still resolves.
const SIGN_RAD_S: f64 = 0.02;
/// Independent samples per second of log, least and most in all.
const SAMPLES_PER_S: f64 = 2.0;
const INDEPENDENT: [f64; 2] = [10.0, 60.0];
/// Rounds of weights.
const ROUNDS: usize = 5;
/// Residuals beyond so many deviations count less (Huber).
const FAR: f64 = 2.5;
/// Squares of residuals over their variance count up to this.
const FAR_SQUARE: f64 = 9.0;
/// Smallest σ_j over the RMS of the measured torque: nothing is explained better than this.
const FLOOR: f64 = 0.02;
/// Error of the arm, its friction and its sensors that no log is blamed for: ripples, cables, what a link carries besides; over the torque limit of the
/// joint and, since limits of robot files are often made up, over the largest torque (RMS) of any. Of a wrist that carries nothing it is all there is.
const BLAMELESS: f64 = 0.025;
/// Share of the instants at which a joint moves at least, of which something is said.
pub(super) const MOVES: f64 = 0.1;
/// Part of the variance of a torque that is left where the arm says nothing of it: on good logs in which all joints move, of half of them
/// at most.
const NOTHING: f64 = 0.9;
/// Torque limit (Nm) of joints of which none is known.
const UNKNOWN_LIMIT_NM: f64 = 60.0;

/// One regression.
#[derive(Clone, Debug)]
pub(super) struct Fit<const N: usize> {
    /// Negative log posterior (nats).
    pub nats: f64,
    /// What the parameters cost of it, as against their priors.
    pub penalty_nats: f64,
    /// What is left of each joint's torque, in the unit of the log; index: column of the log.
    pub left: [f64; N],
    /// That over the RMS of the column about its mean, squared.
    pub unexplained: [f64; N],
    /// The same of what is more than the error of a good log: what a fault of the log may have to explain.
    pub blamed: [f64; N],
    /// Correlation of the measured torque of each joint (as meant) with the explained one.
    pub correlation: [f64; N],
    /// Share of the instants at which each joint moves [-].
    pub moves: [f64; N],
}

impl<const N: usize> Fit<N> {
    /// Joints that move, of whose torque it says no more than a constant would.
    pub fn explains_nothing_of(&self) -> Vec<usize> {
        (0..N).filter(|&j| self.moves[j] > MOVES && self.unexplained[j] > NOTHING).collect()
    }

    /// Whether these are most joints of an arm that moves as a whole: where one joint moves after the other, or alone, a push or a small
    /// error of the model is all that most torques show.
    pub fn explains_nothing(&self) -> bool {
        let moving = self.moves.iter().filter(|share| **share > MOVES).count();
        moving + 1 >= N && 2 * self.explains_nothing_of().len() > N
    }

    /// Whether another fit leaves this many times less of all torques together (RMS).
    pub fn leaves_over(&self, other: &Self, times: f64) -> bool {
        let squares = |fit: &Self| fit.left.iter().map(|x| x * x).sum::<f64>();
        squares(self) > times.powi(2) * squares(other)
    }
}

/// Regressors of one hypothesis about the motion.
pub(super) struct Columns<const N: usize> {
    /// Rigid torque.
    rigid: Vec<SVector<f64, N>>,
    /// Shared columns.
    shared: Vec<[SVector<f64, N>; SHARED]>,
    /// Speed and acceleration.
    motion: Vec<Instant<N>>,
    /// Smooth sign of the speed.
    sign: Vec<SVector<f64, N>>,
}

impl<const N: usize> Columns<N> {
    pub fn of(samples: &Samples<N>, hypothesis: &Hypothesis<N>) -> Self {
        let arm = &hypothesis.arm;
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let tilted: Vec<Arm<N>> = axes.into_iter().map(|axis| Arm { gravity_m_s2: axis, ..arm.clone() }).collect();
        let motion: Vec<Instant<N>> = samples.instants.iter().map(|at| hypothesis.of(at)).collect();
        let shared = motion
            .iter()
            .map(|at| {
                let body = inverse_dynamics_regressor(arm, &at.q, &at.qd, &at.qdd)[N - 1];
                std::array::from_fn(|k| match tilted.get(k) {
                    Some(arm) => gravity_torque(arm, &at.q),
                    None => body.column(k - tilted.len()).into_owned(),
                })
            })
            .collect();
        let rigid = motion.iter().map(|at| rnea(arm, &at.q, &at.qd, &at.qdd)).collect();
        let sign = motion.iter().map(|at| at.qd.map(|qd| (qd / SIGN_RAD_S).tanh())).collect();
        Self { rigid, shared, motion, sign }
    }
}

/// Explains the torques as a hypothesis means them by the columns of its motion.
pub(super) fn fit<const N: usize>(
    samples: &Samples<N>,
    hypothesis: &Hypothesis<N>,
    columns: &Columns<N>,
) -> Option<Fit<N>> {
    let count = samples.instants.len();
    let independent = (SAMPLES_PER_S * samples.duration_s).clamp(INDEPENDENT[0], INDEPENDENT[1]);
    let tau: Vec<SVector<f64, N>> = samples.instants.iter().map(|at| hypothesis.of(at).tau_nm).collect();
    let scale = |j: usize| -> (f64, f64) {
        let mean = tau.iter().map(|tau| tau[j]).sum::<f64>() / count as f64;
        let square = tau.iter().map(|tau| tau[j] * tau[j]).sum::<f64>() / count as f64;
        (square.sqrt(), (square - mean * mean).max(0.0).sqrt())
    };
    let sizes: [(f64, f64); N] = std::array::from_fn(scale);
    let largest = sizes.iter().map(|size| size.0).fold(0.0, f64::max);
    let blameless: [f64; N] = std::array::from_fn(|j| BLAMELESS * limit_nm(&hypothesis.arm, j).min(largest));
    let floor: [f64; N] = std::array::from_fn(|j| (FLOOR * sizes[j].0).max(1e-9));
    let prior = prior_sd(&hypothesis.arm);

    let mut sigma: [f64; N] = std::array::from_fn(|j| sizes[j].1.max(floor[j]));
    // Variance of each torque: σ² and, of a joint at rest, that of a friction which is anything within its bounds.
    let mut variance: Vec<SVector<f64, N>> = vec![SVector::from_fn(|j, _| sigma[j].powi(2)); count];
    let mut far: Vec<SVector<f64, N>> = vec![SVector::repeat(1.0); count];
    let mut gives_energy = [false; N];
    let mut theta = DVector::zeros(SHARED + OWN * N);
    let mut explained: Vec<SVector<f64, N>> = Vec::new();
    for round in 0..=ROUNDS {
        let weights: Vec<SVector<f64, N>> =
            far.iter().zip(&variance).map(|(far, v)| far.component_div(v) * (independent / count as f64)).collect();
        theta = solve(&tau, columns, &weights, &prior, &gives_energy)?;
        explained = (0..count).map(|k| predicted(columns, k, &theta)).collect();
        for j in 0..N {
            let (dry, viscous) = (theta[SHARED + OWN * j + 1], theta[SHARED + OWN * j + 2]);
            let speeds = columns.motion.iter().zip(&columns.sign).map(|(at, sign)| (at.qd[j], sign[j]));
            let power: f64 = speeds.map(|(qd, sign)| (dry * sign + viscous * qd) * qd).sum();
            gives_energy[j] |= power < 0.0 && round < ROUNDS;
            let at_rest = |k: usize| {
                let moving = columns.sign[k][j];
                if gives_energy[j] { 0.0 } else { dry.max(0.0).powi(2) * (1.0 - moving * moving) / 3.0 }
            };
            let (mut squares, mut weights) = (0.0, 0.0);
            for k in 0..count {
                let weight = sigma[j].powi(2) / (sigma[j].powi(2) + at_rest(k));
                squares += weight * (tau[k][j] - explained[k][j]).powi(2);
                weights += weight;
            }
            sigma[j] = (squares / weights).sqrt().max(floor[j]);
            (0..count).for_each(|k| variance[k][j] = sigma[j].powi(2) + at_rest(k));
        }
        for k in 0..count {
            let distance = |j: usize| (tau[k][j] - explained[k][j]).abs().max(1e-12) / variance[k][j].sqrt();
            far[k] = SVector::from_fn(|j, _| (FAR / distance(j)).min(1.0));
        }
    }
    let penalty = 0.5 * theta.iter().zip(&prior).map(|(value, sd)| (value / sd).powi(2)).sum::<f64>();
    let mut misfit = 0.0;
    for (k, variance) in variance.iter().enumerate() {
        for j in 0..N {
            let square = (tau[k][j] - explained[k][j]).powi(2) / variance[j];
            misfit += 0.5 * (variance[j].ln() + square.min(FAR_SQUARE)) - hypothesis.torque[j].1.abs().ln();
        }
    }
    let nats = independent * misfit / count as f64 + penalty;
    let mut left = [0.0; N];
    let (mut unexplained, mut blamed) = ([0.0; N], [0.0; N]);
    for j in 0..N {
        let (source, factor) = hypothesis.torque[j];
        left[source] = sigma[j] / factor.abs();
        let size = sizes[j].1.max(floor[j]);
        unexplained[source] = (sigma[j] / size).powi(2);
        blamed[source] = (sigma[j].powi(2) - blameless[j].powi(2)).max(0.0) / size.powi(2);
    }
    let correlation = std::array::from_fn(|j| correlation(tau.iter().map(|x| x[j]), explained.iter().map(|x| x[j])));
    let moves = std::array::from_fn(|j| columns.sign.iter().map(|sign| sign[j].powi(2)).sum::<f64>() / count as f64);
    nats.is_finite().then_some(Fit { nats, penalty_nats: penalty, left, unexplained, blamed, correlation, moves })
}

/// Torque limit of a joint (Nm).
fn limit_nm<const N: usize>(arm: &Arm<N>, joint: usize) -> f64 {
    Some(arm.limits.tau_max_nm[joint]).filter(|nm| nm.is_finite() && *nm > 0.0).unwrap_or(UNKNOWN_LIMIT_NM)
}

/// How large each parameter is on arms.
fn prior_sd<const N: usize>(arm: &Arm<N>) -> Vec<f64> {
    let own = (0..N).flat_map(|j| {
        let limit = limit_nm(arm, j);
        let rotor = (ROTOR_SD[0] * arm.rotor_inertia_kg_m2[j]).max(ROTOR_SD[1]);
        [OVER_LIMIT[0] * limit, OVER_LIMIT[1] * limit, OVER_LIMIT[2] * limit, rotor]
    });
    SHARED_SD.into_iter().chain(own).collect()
}

/// Columns of one joint at one instant: index of the parameter, value.
fn row<const N: usize>(columns: &Columns<N>, k: usize, j: usize) -> [(usize, f64); SHARED + OWN] {
    let at = &columns.motion[k];
    let own = [1.0, columns.sign[k][j], at.qd[j], at.qdd[j]];
    std::array::from_fn(|i| match i.checked_sub(SHARED) {
        None => (i, columns.shared[k][i][j]),
        Some(o) => (SHARED + OWN * j + o, own[o]),
    })
}

fn predicted<const N: usize>(columns: &Columns<N>, k: usize, theta: &DVector<f64>) -> SVector<f64, N> {
    SVector::from_fn(|j, _| columns.rigid[k][j] + row(columns, k, j).iter().map(|(i, x)| theta[*i] * x).sum::<f64>())
}

/// Weighted least squares with priors; Coulomb and viscous friction of joints that would give energy are left out.
fn solve<const N: usize>(
    tau: &[SVector<f64, N>],
    columns: &Columns<N>,
    weights: &[SVector<f64, N>],
    prior: &[f64],
    without_friction: &[bool; N],
) -> Option<DVector<f64>> {
    let size = prior.len();
    let mut gram = DMatrix::<f64>::from_diagonal(&DVector::from_iterator(size, prior.iter().map(|sd| sd.powi(-2))));
    let mut right = DVector::<f64>::zeros(size);
    for (k, tau) in tau.iter().enumerate() {
        for j in 0..N {
            let weight = weights[k][j];
            let error = tau[j] - columns.rigid[k][j];
            let mut row = row(columns, k, j);
            if without_friction[j] {
                (row[SHARED + 1].1, row[SHARED + 2].1) = (0.0, 0.0);
            }
            for (place, (a, x)) in row.into_iter().enumerate() {
                right[a] += weight * x * error;
                // The factorisation reads the lower triangle.
                for (b, y) in &row[..=place] {
                    gram[(a, *b)] += weight * x * y;
                }
            }
        }
    }
    Some(gram.cholesky()?.solve(&right))
}

fn correlation(a: impl Iterator<Item = f64> + Clone, b: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = a.clone().count().max(1) as f64;
    let (mean_a, mean_b) = (a.clone().sum::<f64>() / count, b.clone().sum::<f64>() / count);
    let (mut cross, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.zip(b) {
        cross += (a - mean_a) * (b - mean_b);
        aa += (a - mean_a).powi(2);
        bb += (b - mean_b).powi(2);
    }
    let correlation = cross / (aa * bb).sqrt();
    if correlation.is_finite() { correlation } else { 0.0 }
}

/// `(|Σ measured · rigid|, Σ rigid²)` of each joint: their ratio is the factor between both, but for friction.
pub(super) fn torque_products<const N: usize>(
    samples: &Samples<N>,
    hypothesis: &Hypothesis<N>,
    columns: &Columns<N>,
) -> [(f64, f64); N] {
    std::array::from_fn(|j| {
        let (mut cross, mut square) = (0.0, 0.0);
        for (at, rigid) in samples.instants.iter().zip(&columns.rigid) {
            cross += hypothesis.of(at).tau_nm[j] * rigid[j];
            square += rigid[j] * rigid[j];
        }
        (f64::abs(cross), square)
    })
}
