//! The exact solver against a certificate of 106 bits, on ten thousand random programmes.
//!
//! For a strictly convex programme the conditions of Karush, Kuhn and Tucker are met by the minimiser only. Each answer's
//! active set is solved again in double-double arithmetic and its conditions are checked there; the answer must then be
//! within 1e-8 of that minimiser. Bounds are ordinary, equal, infinite, and met exactly by the data; noise and prior vary
//! over two orders of magnitude and more; consecutive programmes warm-start each other, as in the tick.

use crate::common::double_double::{Wide, solve};
use crate::common::reference_stream::ReferenceStream;
use nalgebra::{SMatrix, SVector};
use tribo_residual::{BoxOutcome, BoxQp, BoxSolution};

/// Largest error allowed (Nm): what a force controller would call exact.
const TOLERANCE: f64 = 1e-8;
/// Condition that still counts as met in the certificate: data met exactly by a bound leave rounding of d itself.
const TIE: f64 = 1e-12;

struct Programme<const N: usize> {
    c: SMatrix<f64, N, N>,
    d: SVector<f64, N>,
    lower: SVector<f64, N>,
    upper: SVector<f64, N>,
}

impl<const N: usize> Programme<N> {
    fn random(stream: &mut ReferenceStream) -> Self {
        let jacobian = SMatrix::<f64, 6, N>::from_fn(|_, _| stream.normal());
        let prior = SVector::<f64, 6>::from_fn(|_, _| 10_f64.powf(stream.range(-1.0, 1.5)).powi(2));
        let mut c = jacobian.transpose() * SMatrix::from_diagonal(&prior) * jacobian;
        let (mut d, mut lower, mut upper) = (SVector::zeros(), SVector::zeros(), SVector::zeros());
        for i in 0..N {
            c[(i, i)] += 10_f64.powf(stream.range(-1.5, 0.5)).powi(2);
            d[i] = stream.normal() * 10_f64.powf(stream.range(-1.0, 1.0));
            let (a, b) = (stream.normal(), stream.normal());
            (lower[i], upper[i]) = (a.min(b), a.max(b));
            match (stream.u() * 10.0) as usize {
                0 => upper[i] = lower[i],
                1 => lower[i] = f64::NEG_INFINITY,
                2 => upper[i] = f64::INFINITY,
                3 => (lower[i], upper[i]) = (f64::NEG_INFINITY, f64::INFINITY),
                4 => d[i] = lower[i],
                5 => (lower[i], upper[i]) = (0.0, 0.0),
                6 => upper[i] = lower[i] + 1e-9,
                _ => {}
            }
        }
        // Symmetric to the last bit, as the certificate reads one triangle only.
        Self { c: (c + c.transpose()) * 0.5, d, lower, upper }
    }

    /// The minimiser of the answer's active set in 106 bits, and the worst broken condition.
    fn certificate(&self, answer: &BoxSolution<N>) -> (SVector<f64, N>, f64) {
        let active: Vec<usize> = (0..N).filter(|i| answer.active >> i & 1 == 1).collect();
        let bound = |i: usize| {
            let nearer_lower = (answer.t[i] - self.lower[i]).abs() <= (answer.t[i] - self.upper[i]).abs();
            if nearer_lower { self.lower[i] } else { self.upper[i] }
        };
        let block: Vec<Vec<Wide>> =
            active.iter().map(|&i| active.iter().map(|&k| Wide::of(self.c[(i, k)])).collect()).collect();
        let push: Vec<Wide> = active.iter().map(|&i| Wide::of(self.d[i]) - Wide::of(bound(i))).collect();
        let multiplier = solve(&block, &push);
        let (mut t, mut worst) = (self.d, 0.0_f64);
        for i in 0..N {
            if let Some(n) = active.iter().position(|&k| k == i) {
                t[i] = bound(i);
                let pull = multiplier[n].value() * self.c[(i, i)];
                if t[i] != self.upper[i] {
                    worst = worst.max(pull);
                }
                if t[i] != self.lower[i] {
                    worst = worst.max(-pull);
                }
            } else {
                let terms = active.iter().zip(&multiplier).map(|(&k, &m)| Wide::of(self.c[(i, k)]) * m);
                t[i] = terms.fold(Wide::of(self.d[i]), |sum, term| sum - term).value();
                worst = worst.max(self.lower[i] - t[i]).max(t[i] - self.upper[i]);
            }
        }
        (t, worst)
    }
}

fn worst_of<const N: usize>(count: usize, seed: u64) -> (f64, f64, u32) {
    let (mut stream, mut qp) = (ReferenceStream::new(seed), BoxQp::<N>::default());
    let (mut error, mut broken, mut pivots) = (0.0_f64, 0.0_f64, 0);
    for _ in 0..count {
        let programme = Programme::<N>::random(&mut stream);
        qp.set_covariance(&programme.c);
        let answer = qp.solve(&programme.d, &programme.lower, &programme.upper);
        assert_eq!(answer.outcome, BoxOutcome::Converged);
        let (t, worst) = programme.certificate(&answer);
        error = error.max((t - answer.t).amax());
        broken = broken.max(worst / (1.0 + programme.d.amax()));
        pivots = pivots.max(answer.pivots);
    }
    println!("N = {N}: {count} programmes, error {error:.1e} Nm, condition {broken:.1e}, pivots {pivots}");
    (error, broken, pivots)
}

#[test]
fn ten_thousand_programmes_are_solved_exactly() {
    for (error, broken, _) in
        [worst_of::<7>(10_000, 1), worst_of::<14>(10_000, 2), worst_of::<1>(1000, 3), worst_of::<3>(5000, 4)]
    {
        assert!(error < TOLERANCE && broken < TIE, "{error:e} {broken:e}");
    }
}

/// Brute force without any certificate: all 3^4 active sets, the feasible one of least cost.
#[test]
fn enumeration_finds_the_same_minimiser() {
    let (mut stream, mut qp) = (ReferenceStream::new(5), BoxQp::<4>::default());
    for _ in 0..300 {
        let programme = Programme::<4>::random(&mut stream);
        let inverse = programme.c.cholesky().unwrap().inverse();
        let mut best = (f64::INFINITY, SVector::<f64, 4>::zeros());
        for code in 0..81_usize {
            let side = |i: usize| code / 3_usize.pow(i as u32) % 3;
            let bound = |i: usize| [programme.d[i], programme.lower[i], programme.upper[i]][side(i)];
            let mut block = SMatrix::<f64, 4, 4>::identity();
            let push = SVector::<f64, 4>::from_fn(|i, _| programme.d[i] - bound(i));
            for i in (0..4).filter(|&i| side(i) > 0) {
                for k in (0..4).filter(|&k| side(k) > 0) {
                    block[(i, k)] = programme.c[(i, k)];
                }
            }
            let multiplier = block.cholesky().unwrap().solve(&push);
            let free = programme.d - programme.c * multiplier;
            let t = SVector::<f64, 4>::from_fn(|i, _| if side(i) > 0 { bound(i) } else { free[i] });
            let inside = (0..4).all(|i| t[i] >= programme.lower[i] - 1e-12 && t[i] <= programme.upper[i] + 1e-12);
            let cost = (programme.d - t).dot(&(inverse * (programme.d - t)));
            if inside && t.iter().all(|value| value.is_finite()) && cost < best.0 {
                best = (cost, t);
            }
        }
        qp.set_covariance(&programme.c);
        let answer = qp.solve(&programme.d, &programme.lower, &programme.upper);
        assert!((answer.t - best.1).amax() < 1e-7, "{:?} {best:?}", answer.t);
    }
}

#[test]
fn what_is_not_positive_definite_is_named() {
    let mut qp = BoxQp::<2>::default();
    qp.set_covariance(&SMatrix::<f64, 2, 2>::new(1.0, 2.0, 2.0, 1.0));
    let (d, zero) = (SVector::<f64, 2>::new(3.0, 3.0), SVector::<f64, 2>::zeros());
    assert_eq!(qp.solve(&d, &zero, &zero).outcome, BoxOutcome::NotPositiveDefinite);
    qp.set_covariance(&SMatrix::identity());
    assert_eq!(qp.solve(&(d * f64::NAN), &zero, &zero).outcome, BoxOutcome::NotPositiveDefinite);
    let answer = qp.solve(&d, &zero, &SVector::<f64, 2>::repeat(1.0));
    assert_eq!((answer.outcome, answer.t), (BoxOutcome::Converged, SVector::repeat(1.0)));
}
