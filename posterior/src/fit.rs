//! Posterior of the parameters, scales by evidence, and the evidence of a set of families.
//!
//! ```text
//! Λ = Σ_j A_jᵀA_j/(κ_j σ_j²) + Q/α²,   μ = Λ⁻¹h
//! γ_f = d_f − tr(Q_f S_ff)/α_f²,   α_f² ← (μ_fᵀQ_fμ_f + .1 α0²)/(γ_f + 1)
//! β_fj² ← (μ_fjᵀQ_fjμ_fj/α_f² + 3)/(γ_fj + 3): the joint's own factor on the family's scale
//! ln Z = −½(Σ w bᵀb − μᵀh) − ½ Σ (n/κ_j) ln 2πσ_j² − ½(ln|Λ| − ln|Q/α²|) − ½ Σ (ln(α_f/α0)/1.5)² + Σ ln odds_f
//! ```
//!
//! Scales and noise are alternated (mackay1992); κ is that of the fit of all families and stays.

use nalgebra::{DMatrix, DVector, SVector};

use crate::body::log_det;
use crate::prior::{Family, LINK_SCALE};
use crate::problem::{LARGEST_GAIN, NormalEquations, Place, Problem, State};
use crate::spd;
use crate::tempering::kappa;

/// Families, pins and what is known of noise and scales when a fit begins.
#[derive(Clone, Debug)]
pub struct Start {
    /// Families that may be other than zero.
    pub families: Vec<Family>,
    /// Parameters that physics holds at a value.
    pub pinned: Vec<(usize, f64)>,
    /// κ of each joint; `None` asks the residual.
    pub kappa: Option<Vec<f64>>,
    /// Scales to begin with, in the order of `families`; empty is 1.
    pub scales: Vec<f64>,
    /// σ² of each joint to begin with (Nm²); empty is that of b.
    pub variances: Vec<f64>,
}

impl Start {
    /// Families, and nothing known.
    pub fn of(families: &[Family]) -> Self {
        Self { families: families.to_vec(), pinned: Vec::new(), kappa: None, scales: Vec::new(), variances: Vec::new() }
    }
}

/// A posterior.
#[derive(Clone, Debug)]
pub struct Fit {
    /// What it was fitted from.
    pub start: Start,
    /// Posterior mean of every parameter; those out of the fit are 0.
    pub state: State,
    /// Parameters in the fit.
    pub active: Vec<usize>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Scales of the families.
    pub scales: Vec<f64>,
    /// Factor on its family's scale of every parameter.
    pub factors: Vec<f64>,
    /// σ² of each joint (Nm²).
    pub variances: Vec<f64>,
    /// Correlated samples that count as one, of each joint [-].
    pub kappa: Vec<f64>,
    /// Logarithm of the evidence (nat).
    pub log_evidence: f64,
}

impl Fit {
    /// Posterior standard deviation of a parameter, 0 if it is not in the fit.
    pub fn sd(&self, parameter: usize) -> f64 {
        let place = self.active.iter().position(|active| *active == parameter);
        place.map_or(0.0, |i| self.covariance[(i, i)].max(0.0).sqrt())
    }

    /// Posterior covariance of two parameters, 0 if one is not in the fit.
    pub fn covariance_of(&self, a: usize, b: usize) -> f64 {
        let place = |i: usize| self.active.iter().position(|active| *active == i);
        place(a).zip(place(b)).map_or(0.0, |(a, b)| self.covariance[(a, b)])
    }

    /// Σ of some parameters, with its posterior standard deviation.
    pub fn sum(&self, parameters: &[usize]) -> (f64, f64) {
        let variance: f64 = parameters.iter().flat_map(|a| parameters.iter().map(|b| self.covariance_of(*a, *b))).sum();
        (parameters.iter().map(|i| self.state[*i]).sum(), variance.max(0.0).sqrt())
    }

    /// Scale of a family, if it is in the fit.
    pub fn scale(&self, family: Family) -> Option<f64> {
        self.start.families.iter().position(|other| *other == family).map(|i| self.scales[i])
    }
}

impl Fit {
    /// The same with gains and links as unsure as whoever asks for a body's mass must take them to be:
    ///
    /// ```text
    /// Λ' = Λ − Q_g/α_g² + Q_g/max(α_g, 1)² − Q_l/α_l² + Q_l/d²,   d = 0.04
    /// ```
    ///
    /// Gains as before any log: a scale by evidence that says "no gain here" makes a mass look surer than it is, for gains that are all off by
    /// little, and less or more mass, load the joints nearly alike. Links that are more wrong than is usual: on 37 payloads of arms whose links were
    /// off by 3 to 5 % the errors were 1.2 standard deviations, 1.3 of those that the answer was sure of.
    pub fn with_doubts(&self, problem: &Problem) -> Self {
        let Some(information) = spd::inverse(&self.covariance) else { return self.clone() };
        let mut information = information.matrix;
        let of_family = |family: Family| -> Vec<(usize, usize)> {
            let own = |(_, i): &(usize, usize)| problem.places[*i].family() == family;
            self.active.iter().copied().enumerate().filter(own).collect()
        };
        for (k, i) in of_family(Family::Gain) {
            let own = self.scale(Family::Gain).unwrap_or(1.0) * self.factors[i];
            information[(k, k)] += problem.precision[(i, i)] * (own.max(1.0).powi(-2) - own.powi(-2));
        }
        let links = of_family(Family::Links);
        for &(row, r) in &links {
            for &(column, c) in &links {
                information[(row, column)] +=
                    problem.precision[(r, c)] * (DOUBTED_LINKS.powi(-2) - LINK_SCALE.powi(-2));
            }
        }
        match spd::inverse(&information) {
            Some(inverse) => Self { covariance: inverse.matrix, ..self.clone() },
            None => self.clone(),
        }
    }

    /// Other families at the noise colour, the scales and the pins of this fit.
    pub fn lend(&self, problem: &Problem, families: Vec<Family>) -> Start {
        let pinned = self.start.pinned.iter().copied();
        Start {
            pinned: pinned.filter(|(i, _)| families.contains(&problem.places[*i].family())).collect(),
            kappa: Some(self.kappa.clone()),
            scales: families.iter().map(|family| self.scale(*family).unwrap_or(1.0)).collect(),
            variances: self.variances.clone(),
            families,
        }
    }
}

/// Most rounds of scales and noise.
const ROUNDS: usize = 25;
/// Rounds at the end in which κ stands still.
const QUIET_ROUNDS: usize = 6;
/// Rounds between two looks at κ.
const KAPPA_EVERY: usize = 3;
/// Relative change of every scale and variance below which rounds end.
const SETTLED: f64 = 5e-3;
/// Weight of the usual scale in the update of a scale.
const USUAL_WEIGHT: f64 = 0.1;
/// Standard deviation of a scale's logarithm.
const SCALE_SD: f64 = 1.5;
/// Weight of the family's scale in a joint's own.
const FACTOR_WEIGHT: f64 = 3.0;
/// Least and largest factor of a joint on its family's scale.
const FACTORS: [f64; 2] = [0.05, 3.0];
/// Least scale over the usual.
const LEAST_SCALE: f64 = 1e-4;
/// κ before the first look.
const FIRST_KAPPA: f64 = 3.0;
/// Least σ over the RMS of b: arithmetic is no better.
const LEAST_SIGMA: f64 = 1e-5;

/// Scale of the links where a body's mass is asked for.
const DOUBTED_LINKS: f64 = 0.04;

/// The usual scale of a family.
fn usual(family: Family) -> f64 {
    if family == Family::Links { LINK_SCALE } else { 1.0 }
}

/// Weighted sums over joints for the active parameters.
struct Weighted {
    gram: DMatrix<f64>,
    score: DVector<f64>,
}

/// Where each parameter stands among the active ones.
fn places_of(problem: &Problem, active: &[usize]) -> Vec<Option<usize>> {
    let mut places = vec![None; problem.places.len()];
    active.iter().enumerate().for_each(|(i, parameter)| places[*parameter] = Some(i));
    places
}

/// A joint's equations for the active parameters alone, with the pinned ones taken to the other side.
struct Active {
    index: Vec<usize>,
    gram: DMatrix<f64>,
    score: DVector<f64>,
    square: f64,
}

fn active_equations(equations: &NormalEquations, places: &[Option<usize>], pinned: &[(usize, f64)]) -> Vec<Active> {
    equations
        .joints
        .iter()
        .map(|joint| {
            let local: Vec<usize> = (0..joint.index.len()).filter(|l| places[joint.index[*l]].is_some()).collect();
            let held: Vec<(usize, f64)> = pinned
                .iter()
                .filter(|(_, value)| *value != 0.0)
                .filter_map(|(i, value)| Some((joint.index.iter().position(|other| other == i)?, *value)))
                .collect();
            let mut square = joint.square;
            for (a, value) in &held {
                square -= 2.0 * value * joint.score[*a];
                square += held.iter().map(|(b, other)| value * other * joint.gram[(*a, *b)]).sum::<f64>();
            }
            let score = |l: usize| joint.score[l] - held.iter().map(|(h, v)| v * joint.gram[(l, *h)]).sum::<f64>();
            Active {
                index: local.iter().filter_map(|l| places[joint.index[*l]]).collect(),
                gram: DMatrix::from_fn(local.len(), local.len(), |r, c| joint.gram[(local[r], local[c])]),
                score: DVector::from_fn(local.len(), |r, _| score(local[r])),
                square,
            }
        })
        .collect()
}

fn weighted(joints: &[Active], weights: &[f64], count: usize) -> Weighted {
    let mut sum = Weighted { gram: DMatrix::zeros(count, count), score: DVector::zeros(count) };
    for (joint, weight) in joints.iter().zip(weights) {
        for (c, &column) in joint.index.iter().enumerate() {
            sum.score[column] += weight * joint.score[c];
            for (r, &row) in joint.index.iter().enumerate() {
                sum.gram[(row, column)] += weight * joint.gram[(r, c)];
            }
        }
    }
    sum
}

/// The posterior given normal equations; `parts` are the rows behind them, which are asked for κ.
pub(crate) fn fit(problem: &Problem, equations: &NormalEquations, parts: &[usize], start: &Start) -> Option<Fit> {
    let joints = problem.joints();
    let pinned = |i: &usize| start.pinned.iter().any(|(pin, _)| pin == i);
    let active: Vec<usize> = (0..problem.places.len())
        .filter(|i| start.families.contains(&problem.places[*i].family()) && !pinned(i))
        .collect();
    let family_of: Vec<usize> = active
        .iter()
        .map(|i| start.families.iter().position(|f| *f == problem.places[*i].family()).unwrap_or(0))
        .collect();
    let equations_of = active_equations(equations, &places_of(problem, &active), &start.pinned);
    let unit = DMatrix::from_fn(active.len(), active.len(), |r, c| problem.precision[(active[r], active[c])]);
    let samples = equations.samples.max(1) as f64;
    let least: Vec<f64> =
        equations_of.iter().map(|joint| (LEAST_SIGMA.powi(2) * joint.square / samples).max(1e-12)).collect();

    let mut scales: Vec<f64> = if start.scales.len() == start.families.len() {
        start.scales.clone()
    } else {
        start.families.iter().map(|family| usual(*family)).collect()
    };
    let mut variances: Vec<f64> = if start.variances.len() == joints {
        start.variances.clone()
    } else {
        equations_of.iter().zip(&least).map(|(joint, least)| (joint.square / samples).max(*least)).collect()
    };
    let mut kappas = start.kappa.clone().unwrap_or_else(|| vec![FIRST_KAPPA; joints]);
    let (mut mean, mut covariance) = (DVector::zeros(active.len()), DMatrix::zeros(0, 0));
    // Joints of one family differ: each has a factor of its own on the family's scale.
    let mut factors = vec![1.0; active.len()];
    let prior = |scales: &[f64], factors: &[f64]| {
        let of = |i: usize| scales[family_of[i]] * factors[i];
        DMatrix::from_fn(active.len(), active.len(), |r, c| unit[(r, c)] / (of(r) * of(c)))
    };
    let weights_of = |kappas: &[f64], variances: &[f64]| -> Vec<f64> {
        kappas.iter().zip(variances).map(|(k, v)| 1.0 / (k * v)).collect()
    };
    for round in 0..ROUNDS {
        let sum = weighted(&equations_of, &weights_of(&kappas, &variances), active.len());
        covariance = spd::inverse(&(&sum.gram + prior(&scales, &factors)))?.matrix;
        mean = &covariance * &sum.score;
        let before = (scales.clone(), variances.clone());
        // Noise.
        for (j, joint) in equations_of.iter().enumerate() {
            let own = DVector::from_fn(joint.index.len(), |i, _| mean[joint.index[i]]);
            let left = joint.square - 2.0 * own.dot(&joint.score) + (own.transpose() * &joint.gram * &own)[0];
            variances[j] = (left / samples).max(least[j]);
        }
        if start.kappa.is_none() && round % KAPPA_EVERY == KAPPA_EVERY - 1 && round + QUIET_ROUNDS < ROUNDS {
            let state = state_of(problem, &active, &mean, &start.pinned);
            kappas = (0..joints).map(|j| kappa(&problem.residual_along(&state, j, parts))).collect();
        }
        // Scales.
        for (f, family) in start.families.iter().enumerate() {
            let rules = family.prior(problem.scale.link_side);
            let own: Vec<usize> = (0..active.len()).filter(|i| family_of[*i] == f).collect();
            if !rules.scaled || own.is_empty() {
                continue;
            }
            let usual = usual(*family);
            let (mut square, mut trace) = (0.0, 0.0);
            for r in &own {
                for c in &own {
                    let unit = unit[(*r, *c)] / (factors[*r] * factors[*c]);
                    square += mean[*r] * unit * mean[*c];
                    trace += unit * covariance[(*r, *c)];
                }
            }
            let told = (own.len() as f64 - trace / scales[f].powi(2)).max(0.0);
            let scale = ((square + USUAL_WEIGHT * usual * usual) / (told + 1.0)).sqrt();
            scales[f] = scale.clamp(LEAST_SCALE * usual, rules.most_scale * usual);
            for joint in 0..joints {
                let of_joint: Vec<usize> =
                    own.iter().copied().filter(|i| problem.places[active[*i]].joint() == Some(joint)).collect();
                let (mut square, mut trace) = (0.0, 0.0);
                for i in &of_joint {
                    square += mean[*i] * unit[(*i, *i)] * mean[*i] / scales[f].powi(2);
                    trace += unit[(*i, *i)] * covariance[(*i, *i)] / (scales[f] * factors[*i]).powi(2);
                }
                let told = (of_joint.len() as f64 - trace).max(0.0);
                let factor = ((square + FACTOR_WEIGHT) / (told + FACTOR_WEIGHT)).sqrt();
                of_joint.iter().for_each(|i| factors[*i] = factor.clamp(FACTORS[0], FACTORS[1]));
            }
        }
        let moved = |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a / b - 1.0).abs() > SETTLED);
        let settled = !moved(&before.0, &scales) && !moved(&before.1, &variances);
        if settled && (start.kappa.is_some() || round + QUIET_ROUNDS >= ROUNDS || round >= 2 * KAPPA_EVERY) {
            break;
        }
    }

    let weights = weights_of(&kappas, &variances);
    let sum = weighted(&equations_of, &weights, active.len());
    let prior = prior(&scales, &factors);
    let posterior = spd::inverse(&(&sum.gram + &prior))?;
    mean.copy_from(&(&posterior.matrix * &sum.score));
    covariance.clone_from(&posterior.matrix);
    let squares: f64 = equations_of.iter().zip(&weights).map(|(joint, weight)| weight * joint.square).sum();
    let spread: f64 = kappas
        .iter()
        .zip(&variances)
        .map(|(kappa, variance)| samples / kappa * (2.0 * std::f64::consts::PI * variance).ln())
        .sum();
    let occam = posterior.log_det + spd::inverse(&prior).map_or(0.0, |inverse| -inverse.log_det);
    let hyper: f64 = start
        .families
        .iter()
        .zip(&scales)
        .map(|(family, scale)| {
            let rules = family.prior(problem.scale.link_side);
            rules.log10_odds * std::f64::consts::LN_10 - 0.5 * ((scale / usual(*family)).ln() / SCALE_SD).powi(2)
        })
        .sum();
    let mut all_factors = vec![1.0; problem.places.len()];
    active.iter().zip(&factors).for_each(|(i, factor)| all_factors[*i] = *factor);
    let log_evidence = -0.5 * (squares - mean.dot(&sum.score)) - 0.5 * spread - 0.5 * occam + hyper;
    let state = state_of(problem, &active, &mean, &start.pinned);
    Some(Fit {
        start: start.clone(),
        state,
        active,
        covariance,
        scales,
        factors: all_factors,
        variances,
        kappa: kappas,
        log_evidence,
    })
}

/// Every parameter, from the active and the pinned ones.
fn state_of(problem: &Problem, active: &[usize], mean: &DVector<f64>, pinned: &[(usize, f64)]) -> State {
    let mut state = DVector::zeros(problem.places.len());
    pinned.iter().for_each(|(i, value)| state[*i] = *value);
    active.iter().enumerate().for_each(|(k, i)| state[*i] = mean[k]);
    state
}

/// Weight of the barrier that keeps every link a body.
const BARRIER: f64 = 0.05;
/// Newton steps.
const STEPS: usize = 60;

/// The posterior mean with every link a body: Newton's method on
///
/// ```text
/// ½ θᵀΛθ − hᵀθ − ε Σ_k ln det P_k(θ),   ε = 0.05
/// ```
///
/// with backtracking, from links of typical size where the nominal ones are no bodies. What is fitted is what is written.
pub(crate) fn feasible(problem: &Problem, equations: &NormalEquations, fit: &Fit) -> Option<Fit> {
    let Some(first) = fit.active.iter().position(|i| matches!(problem.places[*i], Place::Link(..))) else {
        return Some(fit.clone());
    };
    let places = places_of(problem, &fit.active);
    let equations_of = active_equations(equations, &places, &fit.start.pinned);
    let weights: Vec<f64> = fit.kappa.iter().zip(&fit.variances).map(|(k, v)| 1.0 / (k * v)).collect();
    let sum = weighted(&equations_of, &weights, fit.active.len());
    let scale = |i: usize| {
        let parameter = fit.active[i];
        fit.scale(problem.places[parameter].family()).unwrap_or(1.0) * fit.factors[parameter]
    };
    let prior = DMatrix::from_fn(fit.active.len(), fit.active.len(), |r, c| {
        problem.precision[(fit.active[r], fit.active[c])] / (scale(r) * scale(c))
    });
    let curvature = &sum.gram + prior;
    let links = problem.links.len();
    let block = |k: usize| first + 10 * k;
    let own = |x: &DVector<f64>, k: usize| problem.links[k] + SVector::<f64, 10>::from_fn(|i, _| x[block(k) + i]);
    let objective = |x: &DVector<f64>| -> Option<f64> {
        let mut value = 0.5 * (x.transpose() * &curvature * x)[0] - sum.score.dot(x);
        for k in 0..links {
            value -= BARRIER * log_det(&own(x, k))?.0;
        }
        Some(value)
    };
    let mut x = DVector::zeros(fit.active.len());
    for k in 0..links {
        if log_det(&problem.links[k]).is_none() {
            let typical = crate::body::parameters(&problem.typical[k]) - problem.links[k];
            x.rows_mut(block(k), 10).copy_from(&typical);
        }
    }
    let mut value = objective(&x)?;
    let mut covariance = None;
    for _ in 0..STEPS {
        let mut gradient = &curvature * &x - &sum.score;
        let mut hessian = curvature.clone();
        for k in 0..links {
            let pi = own(&x, k);
            let slope = log_det(&pi)?.1;
            let metric = crate::body::metric(&crate::body::pseudo_inertia(&pi))?;
            for r in 0..10 {
                gradient[block(k) + r] -= BARRIER * slope[r];
                for c in 0..10 {
                    hessian[(block(k) + r, block(k) + c)] += BARRIER * metric[(r, c)];
                }
            }
        }
        let inverse = spd::inverse(&hessian)?.matrix;
        let step = -(&inverse * &gradient);
        let decrease = gradient.dot(&step);
        covariance = Some(inverse);
        if -decrease < 1e-8 {
            break;
        }
        let mut length = 1.0;
        loop {
            let next = &x + &step * length;
            match objective(&next) {
                Some(better) if better < value + 1e-4 * length * decrease => {
                    (x, value) = (next, better);
                    break;
                }
                _ if length < 1e-9 => break,
                _ => length *= 0.5,
            }
        }
        if length < 1e-9 {
            break;
        }
    }
    let state = state_of(problem, &fit.active, &x, &fit.start.pinned);
    Some(Fit { state, covariance: covariance.unwrap_or_else(|| fit.covariance.clone()), ..fit.clone() })
}

/// Rounds in which the gains are made linear anew.
pub(super) const RELINEARISATIONS: usize = 3;
/// Times that physics may pin parameters.
const PINNINGS: usize = 8;

/// The posterior of some families over some parts, bilinear in the gains, every link a body, signs as physics has them.
///
/// A payload of negative mass, a spring that pushes, friction that falls with the load, dry or viscous friction below zero, a rotor of negative inertia and a torque
/// signal that is off by more than half do not exist: such a family or parameter is left out and everything fitted anew. Returns the state that the last equations were
/// linear about too.
pub fn posterior(problem: &Problem, parts: &[usize], start: &Start) -> Option<(Fit, State)> {
    use crate::joint_term::JointTerm;
    let mut start = start.clone();
    for _ in 0..PINNINGS {
        let (found, about) = bilinear(problem, parts, &start)?;
        let lightest = problem.index(Place::Payload(0)).filter(|i| found.active.contains(i));
        if lightest.is_some_and(|i| found.state[i] < 0.0) {
            let scales = start.scales.len() == start.families.len();
            let payload = start.families.iter().position(|family| *family == Family::Payload);
            if let Some(payload) = payload {
                start.families.remove(payload);
                if scales {
                    start.scales.remove(payload);
                }
            }
            continue;
        }
        // 0 − x, so that what is held at nothing is no −0.
        let least = |place: Place| match place {
            // Friction that came before the motion would drive it.
            Place::Own(_, JointTerm::Spring | JointTerm::Load | JointTerm::Presliding(_) | JointTerm::Lead(_)) => 0.0,
            // It would drive a joint that is slow enough; what grows with speed from nothing bends.
            Place::Own(j, JointTerm::Coulomb) => 0.0 - problem.dry_nm[j],
            // It would drive a joint that is fast enough; what falls with speed within the log bends.
            Place::Own(j, JointTerm::Viscous) => 0.0 - problem.viscous_nm_s_per_rad[j],
            Place::Own(j, JointTerm::Rotor) => 0.0 - problem.rotor_kg_m2[j],
            _ => f64::NEG_INFINITY,
        };
        let below = found.active.iter().map(|i| (*i, least(problem.places[*i])));
        let pins: Vec<(usize, f64)> = below.filter(|(i, least)| found.state[*i] < *least).collect();
        // Friction and gains are told apart by gravity alone: where a joint feels none, a gain may run away.
        let runaway = found
            .active
            .iter()
            .filter(|i| matches!(problem.places[**i], Place::Gain(_)) && found.state[**i].abs() > LARGEST_GAIN);
        let pins: Vec<(usize, f64)> = if pins.is_empty() { runaway.map(|i| (*i, 0.0)).collect() } else { pins };
        if pins.is_empty() {
            return Some((found, about));
        }
        start.pinned.extend(pins);
    }
    bilinear(problem, parts, &start)
}

fn bilinear(problem: &Problem, parts: &[usize], start: &Start) -> Option<(Fit, State)> {
    let mut about = plain_state(problem, parts);
    let mut equations = problem.normal_equations(&about, parts);
    let mut found = fit(problem, &equations, parts, start)?;
    let bilinear = [Family::Gain, Family::Payload].iter().any(|family| start.families.contains(family));
    let mut scaled = start.clone();
    for _ in 0..if bilinear { RELINEARISATIONS } else { 0 } {
        about.clone_from(&found.state);
        equations = problem.normal_equations(&about, parts);
        (scaled.scales, scaled.variances) = (found.scales.clone(), found.variances.clone());
        found = fit(problem, &equations, parts, &scaled)?;
    }
    Some((feasible(problem, &equations, &found)?, about))
}

/// Ridge of the plain fit, relative to the square of each column.
const PLAIN_RIDGE: f64 = 1e-9;

/// Coulomb + viscous + offset per joint by least squares: where the gains are made linear first, and the baseline that any
/// user reaches in an afternoon.
pub fn plain_state(problem: &Problem, parts: &[usize]) -> State {
    use crate::joint_term::JointTerm;
    let mut state = DVector::zeros(problem.places.len());
    for j in 0..problem.joints() {
        let columns = &problem.columns.joints[j];
        let terms = [JointTerm::Offset, JointTerm::Coulomb, JointTerm::Viscous].map(JointTerm::place);
        let mut gram = DMatrix::<f64>::zeros(columns.matrix.ncols(), columns.matrix.ncols());
        parts.iter().for_each(|part| gram += &problem.columns.grams[*part][j]);
        let square = DMatrix::from_fn(3, 3, |r, c| {
            let value = gram[(terms[r], terms[c])];
            if r == c { value * (1.0 + PLAIN_RIDGE) + f64::MIN_POSITIVE } else { value }
        });
        let score =
            DVector::from_fn(3, |r, _| gram[(terms[r], columns.measured())] - gram[(terms[r], columns.nominal())]);
        let Some(inverse) = spd::inverse(&square) else { continue };
        let found = inverse.matrix * score;
        for (k, term) in [JointTerm::Offset, JointTerm::Coulomb, JointTerm::Viscous].into_iter().enumerate() {
            if let Some(i) = problem.index(Place::Own(j, term)) {
                state[i] = found[k];
            }
        }
    }
    state
}
