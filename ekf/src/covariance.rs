//! Covariance of the augmented state, kept in the six independent 6×6 blocks.

use nalgebra::{Cholesky, Const, Matrix6, SMatrix, Vector6};

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

/// Gain of a pose measurement, by block of the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseGain {
    /// On the twist.
    pub v: Matrix6<f64>,
    /// On the pose.
    pub x: Matrix6<f64>,
    /// On the wrench.
    pub h: Matrix6<f64>,
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

    /// `P ← F P Fᵀ + Q` over dt (s) with
    ///
    /// ```text
    /// F = [ I      0  −dt Λ⁻¹    ]      Q = diag(qv, 0, qh)
    ///     [ dt I   I  −dt²/2 Λ⁻¹ ]
    ///     [ 0      0   I         ]
    /// ```
    ///
    /// The process noise of one step is added to v and h alone; its leak into x within the step is of order dt³.
    #[inline]
    pub fn propagate(&mut self, lambda_inverse: &Matrix6<f64>, dt_s: f64, qv: &Vector6<f64>, qh: &Vector6<f64>) {
        let a = lambda_inverse * dt_s;
        let half = 0.5 * dt_s;
        // Rows of F P, with the columns of P as they were.
        let a_hh = a * self.hh;
        let a_hv = a * self.vh.transpose();
        let a_hx = a * self.xh.transpose();
        let row_vh = self.vh - a_hh;
        let row_xh = self.xh + self.vh * dt_s - a_hh * half;
        let row_vv = self.vv - a_hv;
        let row_xv = self.vx.transpose() + self.vv * dt_s - a_hv * half;
        let row_xx = self.xx + self.vx * dt_s - a_hx * half;
        // Times Fᵀ.
        let row_xh_at = row_xh * a.transpose();
        self.vv = row_vv - row_vh * a.transpose();
        self.vx = (row_xv - row_xh_at).transpose();
        self.xx = row_xx + row_xv * dt_s - row_xh_at * half;
        self.vh = row_vh;
        self.xh = row_xh;
        for i in 0..6 {
            self.vv[(i, i)] += qv[i];
            self.hh[(i, i)] += qh[i];
        }
        self.symmetrize();
    }

    /// Gain of a pose measurement, `K = P Cᵀ S⁻¹`, C = [0 I 0], S already factored.
    #[inline]
    pub fn pose_gain(&self, s: &Cholesky<f64, Const<6>>) -> PoseGain {
        let s_inverse = s.inverse();
        PoseGain { v: self.vx * s_inverse, x: self.xx * s_inverse, h: self.xh.transpose() * s_inverse }
    }

    /// Joseph form `P ← (I − K C) P (I − K C)ᵀ + K R Kᵀ`, right for any gain K. `s` = P_xx + R.
    #[inline]
    pub fn joseph_update(&mut self, k: &PoseGain, s: &Matrix6<f64>) {
        let hx = self.xh.transpose();
        // P_ab − K_a P_xb − (P_ax − K_a S) K_bᵀ, block by block.
        let (rv, rx, rh) = (self.vx - k.v * s, self.xx - k.x * s, hx - k.h * s);
        let xv = self.vx.transpose();
        let vv = self.vv - k.v * xv - rv * k.v.transpose();
        let vx = self.vx - k.v * self.xx - rv * k.x.transpose();
        let vh = self.vh - k.v * self.xh - rv * k.h.transpose();
        let xx = self.xx - k.x * self.xx - rx * k.x.transpose();
        let xh = self.xh - k.x * self.xh - rx * k.h.transpose();
        let hh = self.hh - k.h * self.xh - rh * k.h.transpose();
        *self = Self { vv, vx, vh, xx, xh, hh };
        self.symmetrize();
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

    /// Keeps the diagonal blocks symmetric to the last bit.
    #[inline]
    fn symmetrize(&mut self) {
        for block in [&mut self.vv, &mut self.xx, &mut self.hh] {
            for c in 0..6 {
                for r in 0..c {
                    let mean = 0.5 * (block[(r, c)] + block[(c, r)]);
                    block[(r, c)] = mean;
                    block[(c, r)] = mean;
                }
            }
        }
    }
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
        p.propagate(&lambda_inverse, dt, &qv, &qh);
        assert!((p.to_dense() - expected).amax() < 1e-11 * expected.amax());
    }

    /// Witness: the dense Joseph form, for the optimal gain and for a wrong one.
    #[test]
    fn update_is_the_joseph_form_for_any_gain() {
        for detune in [1.0, 0.8] {
            let mut p = some_covariance();
            let r = Matrix6::from_diagonal(&Vector6::new(0.1, 0.2, 0.3, 0.4, 0.5, 0.6));
            let s = p.xx + r;
            let mut k = p.pose_gain(&s.cholesky().unwrap());
            for gain in [&mut k.v, &mut k.x, &mut k.h] {
                *gain *= detune;
            }
            let mut dense_k = SMatrix::<f64, 18, 6>::zeros();
            for (row, gain) in [k.v, k.x, k.h].iter().enumerate() {
                dense_k.fixed_view_mut::<6, 6>(6 * row, 0).copy_from(gain);
            }
            let mut c = SMatrix::<f64, 6, 18>::zeros();
            c.fixed_view_mut::<6, 6>(0, 6).copy_from(&Matrix6::identity());
            let keep = Dense::identity() - dense_k * c;
            let expected = keep * p.to_dense() * keep.transpose() + dense_k * r * dense_k.transpose();
            p.joseph_update(&k, &s);
            assert!((p.to_dense() - expected).amax() < 1e-11 * expected.amax());
        }
    }
}
