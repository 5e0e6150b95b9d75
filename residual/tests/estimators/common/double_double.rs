//! Numbers of 106 bits: unevaluated sums of two doubles (dekker1971, knuth1997), for references only.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo`, |lo| ≤ ulp(hi)/2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wide {
    /// Leading part.
    pub hi: f64,
    /// The rest.
    pub lo: f64,
}

impl Wide {
    /// A double, exactly.
    pub fn of(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }

    /// `a + b` exactly, |a| ≥ |b| not needed.
    fn exact_sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let back = hi - a;
        Self { hi, lo: (a - (hi - back)) + (b - back) }
    }

    /// Nearest double.
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (s, t) = (Self::exact_sum(self.hi, other.hi), Self::exact_sum(self.lo, other.lo));
        let u = Self::exact_sum(s.hi, s.lo + t.hi);
        Self::exact_sum(u.hi, u.lo + t.lo)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let hi = self.hi * other.hi;
        let lo = self.hi.mul_add(other.hi, -hi) + (self.hi * other.lo + self.lo * other.hi);
        Self::exact_sum(hi, lo)
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let rest = self - other * Self::of(first);
        let second = rest.hi / other.hi;
        let rest = rest - other * Self::of(second);
        Self::exact_sum(first, second) + Self::of(rest.hi / other.hi)
    }
}

/// Solves the symmetric positive definite system by L D Lᵀ.
pub fn solve(matrix: &[Vec<Wide>], rhs: &[Wide]) -> Vec<Wide> {
    let n = rhs.len();
    let (mut l, mut d) = (vec![vec![Wide::default(); n]; n], vec![Wide::default(); n]);
    for i in 0..n {
        for j in 0..=i {
            let mut sum = matrix[i][j];
            for k in 0..j {
                sum = sum - l[i][k] * l[j][k] * d[k];
            }
            if i == j {
                d[i] = sum;
            } else {
                l[i][j] = sum / d[j];
            }
        }
    }
    let mut x = rhs.to_vec();
    for i in 0..n {
        for k in 0..i {
            x[i] = x[i] - l[i][k] * x[k];
        }
    }
    for i in 0..n {
        x[i] = x[i] / d[i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] = x[i] - l[k][i] * x[k];
        }
    }
    x
}

#[test]
fn a_third_has_thirty_digits() {
    let third = Wide::of(1.0) / Wide::of(3.0);
    let rest = third * Wide::of(3.0) - Wide::of(1.0);
    assert!(rest.value().abs() < 1e-31 && third.lo != 0.0);
    let matrix = vec![vec![Wide::of(2.0), Wide::of(1.0)], vec![Wide::of(1.0), Wide::of(3.0)]];
    let x = solve(&matrix, &[Wide::of(3.0), Wide::of(5.0)]);
    assert!((x[0].value() - 0.8).abs() < 1e-16 && (x[1].value() - 1.4).abs() < 1e-15);
}
