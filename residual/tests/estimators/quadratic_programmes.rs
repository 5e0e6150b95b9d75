//! Friction-band programmes against DAQP (dual active set, arnstrom2022) and quadprog (goldfarb1983).
//!
//! The witnesses get the programme as linderoth2013 (11) prints it, in force and friction together, with weights that are
//! inverses. [`ForceSolver`] eliminates the force first and inverts neither covariance: if its elimination were wrong, the
//! solutions would differ. Steps 1–5 of the confidence limits are written a second time around the witness.

#![allow(clippy::expect_used, reason = "a test fails by panicking, in its helpers too")]

use crate::common::published_instances::{LAMBDA, instance, prior};
use crate::common::reference_stream::ReferenceStream;
use crate::python_witness::{answer, numbers, python};
use nalgebra::{SMatrix, SVector};
use serde_json::{Value, json};
use tribo_residual::{ForcePrior, ForceProblem, ForceSolver};

/// Of the prior's deviation for forces and limits, of 1 Nm + the largest friction for frictions; measured are 6e-12.
const TOLERANCE: f64 = 1e-9;

/// Solves the programmes of the file with the solver that it names; prints force, friction, covariance and limits of each.
const WITNESS: &str = r#"
import json, sys, numpy as np
question = json.load(open(sys.argv[1]))

# Bands narrower than rounding (of a sliding joint) are equalities: quadprog calls two sides 2e-15 apart inconsistent.
def equalities(lower, upper):
    return upper - lower < 1e-12

if question["solver"] == "daqp":
    import daqp
    def solve(H, f, lower, upper):
        n, m = len(f), len(lower)
        A = np.hstack([np.zeros((m, n - m)), np.eye(m)])
        sense = np.where(equalities(lower, upper), 5, 0).astype(np.int32)
        # Its defaults for violations are 1e-6 and 1e-12.
        z, _, end, info = daqp.solve(H, f, A, np.minimum(upper, 1e30), np.maximum(lower, -1e30), sense, primal_tol=1e-12)
        assert end == 1, end
        return z, np.array(info["lam"]) != 0
else:
    import quadprog
    def solve(H, f, lower, upper):
        n, m = len(f), len(lower)
        equal = equalities(lower, upper)
        rows = [(i, 1.0, lower[i]) for i in range(m) if equal[i]]
        rows += [(i, 1.0, lower[i]) for i in range(m) if not equal[i] and np.isfinite(lower[i])]
        rows += [(i, -1.0, -upper[i]) for i in range(m) if not equal[i] and np.isfinite(upper[i])]
        if not rows:
            return np.linalg.solve(H, -f), np.zeros(m, bool)
        C = np.zeros((n, len(rows)))
        for k, (i, sign, _) in enumerate(rows):
            C[n - m + i, k] = sign
        solution = quadprog.solve_qp(H, -f, C, np.array([bound for *_, bound in rows]), int(equal.sum()))
        active = np.zeros(m, bool)
        for k in np.flatnonzero(solution[4]):
            active[rows[k][0]] = True
        return solution[0], active

def bounds(list, infinite):
    return np.array([infinite if bound is None else bound for bound in list])

answers = []
for case in question["cases"]:
    J, torque = np.array(case["jacobian"]).T, np.array(case["torque"])
    lower, upper = bounds(case["lower"], -np.inf), bounds(case["upper"], np.inf)
    R, prior, mean = np.array(case["covariance"]), np.array(case["prior"]), np.array(case["mean"])
    weight, prior_weight, m = np.linalg.inv(R), np.linalg.inv(prior), len(mean)
    # F = mean + P u with P P' = prior: newtons and newton metres in one unit. torque - J'F - t = torque - J'mean - G z, z = (u, t)
    P = np.linalg.cholesky(prior)
    G = np.hstack([J.T @ P, np.eye(len(torque))])
    H = G.T @ weight @ G
    H[:m, :m] += np.eye(m)
    H = 0.5 * (H + H.T)

    def programme(gradient):
        f = -G.T @ weight @ (torque - J.T @ mean)
        f[:m] -= P.T @ gradient
        z, active = solve(H, f, lower, upper)
        return mean + P @ z[:m], z[m:], active | equalities(lower, upper)

    def covariance(joints):
        return np.linalg.inv(J[:, joints] @ np.linalg.inv(R[np.ix_(joints, joints)]) @ J[:, joints].T + prior_weight)

    F, t, active = programme(np.zeros(m))
    limits = []
    for v in np.array(case["directions"]):
        informative = np.zeros(len(torque), bool)
        while True:
            sigma = np.sqrt(v @ covariance(informative) @ v)
            force, _, seen = programme(case["lambda"] / sigma * v)
            if not (seen & ~informative).any():
                break
            informative |= seen
        limits.append([v @ force, sigma])
    answers.append({"force": F.tolist(), "friction": t.tolist(), "covariance": covariance(active).ravel().tolist(), "limits": limits})
print(json.dumps(answers))
"#;

fn question<const N: usize>(
    problem: &ForceProblem<N, 6>,
    prior: &ForcePrior<6>,
    directions: &[SVector<f64, 6>],
) -> Value {
    let rows = |matrix: &[f64], height: usize| matrix.chunks(height).map(<[f64]>::to_vec).collect::<Vec<_>>();
    json!({
        "torque": problem.torque.as_slice(), "lower": problem.lower.as_slice(), "upper": problem.upper.as_slice(),
        "jacobian": rows(problem.jacobian.as_slice(), 6), "covariance": rows(problem.covariance.as_slice(), N),
        "prior": rows(prior.covariance.as_slice(), 6), "mean": prior.mean.as_slice(), "lambda": LAMBDA,
        "directions": directions.iter().map(|v| v.as_slice().to_vec()).collect::<Vec<_>>(),
    })
}

/// A problem whose bands are ordinary, of zero or hardly any width, open on one side or both, or met exactly by the torque;
/// noise is correlated, and prior over noise spans two orders of magnitude.
fn random<const N: usize>(stream: &mut ReferenceStream) -> (ForceProblem<N, 6>, ForcePrior<6>) {
    let normal = |stream: &mut ReferenceStream| SVector::<f64, 6>::from_fn(|_, _| stream.normal());
    let sd = SVector::<f64, 6>::from_fn(|_, _| 10_f64.powf(stream.range(-1.0, 1.0)));
    let tilt = normal(stream) * 0.1;
    let prior = ForcePrior {
        mean: normal(stream),
        covariance: SMatrix::from_diagonal(&sd.component_mul(&sd)) + tilt * tilt.transpose(),
    };
    let jacobian = SMatrix::<f64, 6, N>::from_fn(|_, _| stream.normal());
    let shared = SVector::<f64, N>::from_fn(|_, _| 0.1 * stream.normal());
    let noise = SVector::<f64, N>::from_fn(|_, _| 10_f64.powf(stream.range(-1.0, 0.0)));
    let covariance = SMatrix::from_diagonal(&noise.component_mul(&noise)) + shared * shared.transpose();
    let mut torque = jacobian.tr_mul(&normal(stream));
    let (mut lower, mut upper) = (SVector::<f64, N>::zeros(), SVector::<f64, N>::zeros());
    for i in 0..N {
        let (a, b) = (stream.normal(), stream.normal());
        (lower[i], upper[i]) = (a.min(b), a.max(b));
        match (stream.u() * 10.0) as usize {
            0 => upper[i] = lower[i],
            1 => lower[i] = f64::NEG_INFINITY,
            2 => upper[i] = f64::INFINITY,
            3 => (lower[i], upper[i]) = (f64::NEG_INFINITY, f64::INFINITY),
            4 => torque[i] = jacobian.column(i).dot(&prior.mean) + lower[i],
            5 => (lower[i], upper[i]) = (0.0, 0.0),
            6 => upper[i] = lower[i] + 1e-9,
            _ => {}
        }
    }
    (ForceProblem { torque, jacobian, lower, upper, covariance }, prior)
}

fn off(ours: &[f64], theirs: &[f64], scale: impl Fn(usize) -> f64) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    (0..ours.len()).map(|i| (ours[i] - theirs[i]).abs() / scale(i)).fold(0.0, f64::max)
}

/// Answers of each witness that is there, by its name.
fn witnesses(cases: &[Value]) -> Vec<(&'static str, Vec<Value>)> {
    let mut found = Vec::new();
    for solver in ["daqp", "quadprog"] {
        let Some(python) =
            python(&format!("numpy, {solver}"), &format!("friction-band programmes are UNTESTED against {solver}"))
        else {
            continue;
        };
        let answers = answer(&python, WITNESS, &json!({"solver": solver, "cases": cases}));
        found.push((solver, answers.as_array().expect("a list").clone()));
    }
    found
}

/// Errors of force, friction, covariance and limits of one problem.
fn errors<const N: usize>(
    (problem, prior): &(ForceProblem<N, 6>, ForcePrior<6>),
    directions: &[SVector<f64, 6>],
    witness: &Value,
) -> [f64; 4] {
    let mut solver = ForceSolver::new(*prior);
    let ours = solver.estimate(problem).expect("solvable");
    let sd = prior.covariance.diagonal().map(f64::sqrt);
    let friction_nm = 1.0 + ours.friction.t.amax();
    let limits = directions.iter().zip(witness["limits"].as_array().expect("a list")).map(|(v, theirs)| {
        let limit = solver.limit(v, LAMBDA).expect("solvable");
        let prior_sd = v.dot(&(prior.covariance * v)).sqrt();
        off(&[limit.value, limit.sigma], &numbers(theirs), |_| prior_sd)
    });
    let limits = limits.fold(0.0, f64::max);
    [
        off(ours.force.as_slice(), &numbers(&witness["force"]), |i| sd[i]),
        off(ours.friction.t.as_slice(), &numbers(&witness["friction"]), |_| friction_nm),
        off(ours.covariance.as_slice(), &numbers(&witness["covariance"]), |i| sd[i / 6] * sd[i % 6]),
        limits,
    ]
}

fn agree<const N: usize>(problems: &[(ForceProblem<N, 6>, ForcePrior<6>)], directions: &[SVector<f64, 6>]) {
    let cases: Vec<Value> = problems.iter().map(|(problem, prior)| question(problem, prior, directions)).collect();
    for (name, answers) in witnesses(&cases) {
        let mut worst = [0.0_f64; 4];
        for (k, (problem, witness)) in problems.iter().zip(&answers).enumerate() {
            let now = errors(problem, directions, witness);
            assert!(now.iter().all(|off| *off < TOLERANCE), "{name}, {N} joints, {k}: {now:?}\n{problem:?}");
            worst = std::array::from_fn(|i| worst[i].max(now[i]));
        }
        let worst = worst.map(|off| format!("{off:.1e}")).join(", ");
        let (count, limits) = (problems.len(), directions.len());
        println!("{name}: force, friction, covariance, {limits} limits of {count} x {N} joints within {worst}");
    }
}

#[test]
fn programmes_with_degenerate_bands_have_the_solutions_of_the_witnesses() {
    let mut stream = ReferenceStream::new(21);
    let askew = [[0.6, -0.8, 0.0, 0.0, 0.0, 0.0], [0.1, 0.5, -0.3, 0.7, -0.2, 0.3]].map(SVector::from);
    agree(&(0..300).map(|_| random::<7>(&mut stream)).collect::<Vec<_>>(), &askew);
    agree(&(0..300).map(|_| random::<14>(&mut stream)).collect::<Vec<_>>(), &askew);
}

#[test]
fn estimates_and_limits_of_a_panda_are_those_of_the_witnesses() {
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    let axes = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]
        .map(|i| SVector::<f64, 6>::from_fn(|r, _| if r == i / 2 { sign(i) } else { 0.0 }));
    agree(&(0..100).map(|k| (instance(k), prior())).collect::<Vec<_>>(), &axes);
}
