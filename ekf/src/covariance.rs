//! Covariance of the augmented state, kept in the six independent 6×6 blocks.

use nalgebra::{Matrix6, SMatrix, Vector6};
use tribo_robot::{SpdFactor, minus_product_transposed, multiply_add, product, product_transposed};

/// Covariance of (v, x, h): twist, pose error, wrench. 18×18, symmetric; blocks named row then column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AugmentedCovariance {
    /// Twist, twist.
    pub vv: Matrix6<f64>,
    /// Twist, pose.
    pub vx: Matrix6<f64>,
    /// Twist, wrench.
    pub vh: Matrix6<f64>,
    /// Pose, pose.
    pub xx: Matrix6<f64>,
    /// Pose, wrench.
    pub xh: Matrix6<f64>,
    /// Wrench, wrench.
    pub hh: Matrix6<f64>,
}

/// `X = P Cᵀ L⁻ᵀ` and `X D⁻¹` of a pose measurement with `C P Cᵀ + R = S = L D Lᵀ`, by block of the state; the gain is `K = X D⁻¹ L⁻¹`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseGain {
    /// Rows of the twist, of both.
    pub v: (Matrix6<f64>, Matrix6<f64>),
    /// Rows of the pose, of both.
    pub x: (Matrix6<f64>, Matrix6<f64>),
    /// Rows of the wrench, of both.
    pub h: (Matrix6<f64>, Matrix6<f64>),
}

impl AugmentedCovariance {
    /// Block-diagonal covariance.
    pub fn diagonal(v: &Vector6<f64>, x: &Vector6<f64>, h: &Vector6<f64>) -> Self {
        let zero = Matrix6::zeros();
        Self {
            vv: Matrix6::from_diagonal(v),
            vx: zero,
            vh: zero,
            xx: Matrix6::from_diagonal(x),
            xh: zero,
            hh: Matrix6::from_diagonal(h),
        }
    }

    /// `F P Fᵀ + Q` over dt (s) with
    ///
    /// ```text
    /// F = [ I      0  −dt Λ⁻¹    ]      Q = diag(qv, 0, qh)
    ///     [ dt I   I  −dt²/2 Λ⁻¹ ]
    ///     [ 0      0   I         ]
    /// ```
    ///
    /// The process noise of one step is added to v and h alone; its leak into x within the step is of order dt³.
    #[inline]
    pub fn propagated(&self, lambda_inverse: &Matrix6<f64>, dt_s: f64, qv: &Vector6<f64>, qh: &Vector6<f64>) -> Self {
        let a = lambda_inverse * dt_s;
        let half = 0.5 * dt_s;
        // With v⁺ = v − A h, x⁺ = x + dt/2 (v + v⁺).
        let a_hh = product(&a, &self.hh);
        let a_hh_a = product_transposed(&a_hh, &a);
        let a_hv = product_transposed(&a, &self.vh);
        let v_new_v = self.vv - a_hv;
        let v_new_x = self.vx - product_transposed(&a, &self.xh);
        let vv = symmetric(|r, c| v_new_v[(r, c)] - a_hv[(c, r)] + a_hh_a[(r, c)]);
        // xx⁺ = xx + E + Eᵀ + dt²/4 (vv + v⁺v⁺),   E = dt/2 (vx + v⁺x) + dt²/4 v⁺v
        let e = (self.vx + v_new_x) * half + v_new_v * (half * half);
        let velocities = (self.vv + vv) * (half * half);
        let mut answer = Self {
            vv,
            vx: v_new_x + (v_new_v + vv) * half,
            vh: self.vh - a_hh,
            xx: self.xx + symmetric(|r, c| e[(r, c)] + e[(c, r)] + velocities[(r, c)]),
            xh: self.xh + (self.vh * dt_s - a_hh * half),
            hh: self.hh,
        };
        for i in 0..6 {
            answer.vv[(i, i)] += qv[i];
            answer.hh[(i, i)] += qh[i];
        }
        answer
    }

    /// Gain of a pose measurement, C = [0 I 0], S already factored.
    #[inline]
    pub fn pose_gain(&self, s: &SpdFactor<6>) -> PoseGain {
        PoseGain { v: s.right_half(&self.vx), x: s.right_half(&self.xx), h: s.right_half(&self.xh.transpose()) }
    }

    /// `to ← P − X D⁻¹ Xᵀ`, without a copy of P: what Joseph's form `(I − K C) P (I − K C)ᵀ + K R Kᵀ` is when K is the optimal gain, as it is here.
    ///
    /// Joseph's guards against a loss of symmetry, which is here by construction, and against a gain spoilt by rounding, which takes
    /// an R below rounding beside P: an encoder's is not. Six products of blocks instead of eighteen.
    #[inline]
    pub fn update_into(&self, to: &mut Self, gain: &PoseGain) {
        let PoseGain { v: (v, scaled_v), x: (x, scaled_x), h: (h, scaled_h) } = gain;
        minus_symmetric_product(&mut to.vv, &self.vv, scaled_v, v);
        minus_product_transposed(&mut to.vx, &self.vx, scaled_v, x);
        minus_product_transposed(&mut to.vh, &self.vh, scaled_v, h);
        minus_symmetric_product(&mut to.xx, &self.xx, scaled_x, x);
        minus_product_transposed(&mut to.xh, &self.xh, scaled_x, h);
        minus_symmetric_product(&mut to.hh, &self.hh, scaled_h, h);
    }

    /// The dense 18×18 matrix in the order v, x, h.
    pub fn to_dense(&self) -> SMatrix<f64, 18, 18> {
        let mut p = SMatrix::<f64, 18, 18>::zeros();
        let blocks = [
            [self.vv, self.vx, self.vh],
            [self.vx.transpose(), self.xx, self.xh],
            [self.vh.transpose(), self.xh.transpose(), self.hh],
        ];
        for (r, row) in blocks.iter().enumerate() {
            for (c, block) in row.iter().enumerate() {
                p.fixed_view_mut::<6, 6>(6 * r, 6 * c).copy_from(block);
            }
        }
        p
    }
}

/// `to ← S − A Bᵀ` of a symmetric S where `A Bᵀ` is symmetric up to rounding, which must not add up: computed on and below the
/// diagonal, two columns at a time, and mirrored.
#[inline]
fn minus_symmetric_product(to: &mut Matrix6<f64>, s: &Matrix6<f64>, a: &Matrix6<f64>, b: &Matrix6<f64>) {
    minus_below::<0>(to, s, a, b);
    minus_below::<2>(to, s, a, b);
    minus_below::<4>(to, s, a, b);
    for c in 0..6 {
        for r in c + 1..6 {
            to.data.0[r][c] = to.data.0[c][r];
        }
    }
}

/// Columns C and C + 1 of `S − A Bᵀ`, right from row C down.
#[inline]
fn minus_below<const C: usize>(to: &mut Matrix6<f64>, s: &Matrix6<f64>, a: &Matrix6<f64>, b: &Matrix6<f64>) {
    for c in C..C + 2 {
        let mut column = s.data.0[c];
        for k in 0..6 {
            let factor = b.data.0[k][c];
            for r in C..6 {
                column[r] = multiply_add(-a.data.0[k][r], factor, column[r]);
            }
        }
        to.data.0[c] = column;
    }
}

/// The symmetric matrix with these entries on and below its diagonal, r ≥ c.
#[inline]
fn symmetric(entry: impl Fn(usize, usize) -> f64) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    for c in 0..6 {
        for r in c..6 {
            let value = entry(r, c);
            matrix[(r, c)] = value;
            matrix[(c, r)] = value;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    type Dense = SMatrix<f64, 18, 18>;

    fn some_covariance() -> AugmentedCovariance {
        let root = Dense::from_fn(|r, c| ((r * 18 + c) as f64 * 0.7).sin());
        let p = root * root.transpose() + Dense::identity();
        let block = |r: usize, c: usize| p.fixed_view::<6, 6>(6 * r, 6 * c).into_owned();
        AugmentedCovariance {
            vv: block(0, 0),
            vx: block(0, 1),
            vh: block(0, 2),
            xx: block(1, 1),
            xh: block(1, 2),
            hh: block(2, 2),
        }
    }

    fn some_lambda_inverse() -> Matrix6<f64> {
        let root = Matrix6::from_fn(|r, c| ((r * 6 + c) as f64 * 1.1).cos());
        root * root.transpose()
    }

    /// Witness: the textbook on dense matrices.
    #[test]
    fn propagation_is_f_p_ft_plus_q() {
        let (mut p, lambda_inverse, dt) = (some_covariance(), some_lambda_inverse(), 0.1);
        let (qv, qh) = (Vector6::repeat(0.3), Vector6::repeat(0.7));
        let mut f = Dense::identity();
        f.fixed_view_mut::<6, 6>(0, 12).copy_from(&(lambda_inverse * -dt));
        f.fixed_view_mut::<6, 6>(6, 0).copy_from(&(Matrix6::identity() * dt));
        f.fixed_view_mut::<6, 6>(6, 12).copy_from(&(lambda_inverse * (-0.5 * dt * dt)));
        let mut expected = f * p.to_dense() * f.transpose();
        for i in 0..6 {
            expected[(i, i)] += 0.3;
            expected[(12 + i, 12 + i)] += 0.7;
        }
        p = p.propagated(&lambda_inverse, dt, &qv, &qh);
        assert!((p.to_dense() - expected).amax() < 1e-11 * expected.amax());
    }

    /// Witness: the dense Joseph form, which is right for any gain, at the textbook's gain.
    #[test]
    fn update_is_the_joseph_form() {
        let p = some_covariance();
        let r = Matrix6::from_diagonal(&Vector6::new(0.1, 0.2, 0.3, 0.4, 0.5, 0.6));
        let s = p.xx + r;
        let mut c = SMatrix::<f64, 6, 18>::zeros();
        c.fixed_view_mut::<6, 6>(0, 6).copy_from(&Matrix6::identity());
        let k = p.to_dense() * c.transpose() * s.try_inverse().unwrap();
        let keep = Dense::identity() - k * c;
        let expected = keep * p.to_dense() * keep.transpose() + k * r * k.transpose();
        let factor = SpdFactor::of(&s).unwrap();
        let gain = p.pose_gain(&factor);
        let mut updated = p;
        p.update_into(&mut updated, &gain);
        assert!((updated.to_dense() - expected).amax() < 1e-11 * expected.amax());
        // And the gain on a measurement is K.
        let nu = Vector6::new(0.3, -0.1, 0.7, 0.2, -0.5, 0.4);
        let y = factor.half(&nu).component_mul(factor.reciprocal_pivots());
        let moved = k * nu;
        for (block, row) in [(gain.v, 0), (gain.x, 6), (gain.h, 12)] {
            assert!((block.0 * y - moved.fixed_rows::<6>(row)).amax() < 1e-11);
        }
    }

    /// A million updates with next to no noise leave it positive definite.
    #[test]
    fn rounding_never_makes_it_indefinite() {
        let (mut p, lambda_inverse) = (some_covariance(), some_lambda_inverse());
        let r = Matrix6::identity() * 1e-10;
        for _ in 0..1_000_000 {
            let predicted = p.propagated(&lambda_inverse, 1e-3, &Vector6::repeat(1e-6), &Vector6::repeat(1e-2));
            let factor = SpdFactor::of(&(predicted.xx + r)).unwrap();
            predicted.update_into(&mut p, &predicted.pose_gain(&factor));
        }
        let dense = p.to_dense();
        let scale = dense.diagonal().map(|variance| 1.0 / variance.sqrt());
        let correlation = Dense::from_diagonal(&scale) * dense * Dense::from_diagonal(&scale);
        assert!(correlation.symmetric_eigenvalues().min() > 0.0);
        assert_eq!(p.vv, p.vv.transpose());
    }
}
