//! What torque the model does not explain.

use nalgebra::{SMatrix, SVector};
use tribo_robot::{ControlTerms, SensorFrame};

/// First-order observer of the torque d that the model leaves out:
///
/// ```text
/// p = M q̇,   ṗ = τ + Cᵀ q̇ − g − d,   r = K (∫ (τ + Cᵀ q̇ − g − r) dt − p + p(0)),   ṙ = K (d − r)
/// ```
///
/// With `d = Jᵀ h + tau_f`, h by the robot on the environment: r has the sign of h.
///
/// In discrete time Ṁ = C + Cᵀ turns the momentum balance of one period, `p_k − p_{k−1} − Ṁ q̇ dt`, into
/// `½ (M_k + M_{k−1}) (q̇_k − q̇_{k−1})`: no derivative of M and no acceleration. With bias `C q̇ + g` at the mean of its
/// ends and τ held over the period, `r ← r + (1 − exp(−K dt)) (d_k − r)`, exact for constant d at any dt.
///
/// The noise of q̇ enters as K M times itself; d is seen 1/K (s) late. The Jacobian passes the same low-pass, so that
/// a constant h is `r = J_fᵀ h` exactly while the arm moves.
#[derive(Clone, Copy, Debug)]
pub struct MomentumObserver<const N: usize> {
    gain_rad_s: f64,
    residual: SVector<f64, N>,
    mass_matrix: SMatrix<f64, N, N>,
    qd: SVector<f64, N>,
    bias_nm: SVector<f64, N>,
    jacobian: SMatrix<f64, 6, N>,
    lagged_jacobian: SMatrix<f64, 6, N>,
}

impl<const N: usize> MomentumObserver<N> {
    /// An observer of gain K (rad/s); [`Self::start`] places it.
    pub fn new(gain_rad_s: f64) -> Self {
        let (zero, jacobian) = (SVector::zeros(), SMatrix::zeros());
        Self {
            gain_rad_s,
            residual: zero,
            mass_matrix: SMatrix::zeros(),
            qd: zero,
            bias_nm: zero,
            jacobian,
            lagged_jacobian: jacobian,
        }
    }

    /// Starts at this sample with r = 0; it has forgotten that after a few 1/K.
    #[inline]
    pub fn start(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.residual = SVector::zeros();
        self.lagged_jacobian = terms.jacobian;
        self.keep(frame, terms);
    }

    /// Takes the sample at the end of a period of `dt_s` (s) during which τ (Nm) acted; returns r (Nm).
    #[inline(never)]
    pub fn step(
        &mut self,
        frame: &SensorFrame<N>,
        terms: &ControlTerms<N>,
        tau: &SVector<f64, N>,
        dt_s: f64,
    ) -> &SVector<f64, N> {
        let momentum = (self.mass_matrix + terms.mass_matrix) * (frame.qd - self.qd) * (0.5 / dt_s);
        let bias = (self.bias_nm + terms.bias_nm()) * 0.5;
        let unexplained = tau - bias - momentum;
        let share = self.share(dt_s);
        self.residual += (unexplained - self.residual) * share;
        let jacobian = (self.jacobian + terms.jacobian) * 0.5;
        self.lagged_jacobian += (jacobian - self.lagged_jacobian) * share;
        self.keep(frame, terms);
        &self.residual
    }

    /// Share of the last period in r: `1 − exp(−K dt)`.
    #[inline]
    pub fn share(&self, dt_s: f64) -> f64 {
        -(-self.gain_rad_s * dt_s).exp_m1()
    }

    /// Covariance of r (Nm²) by white noise of τ (Nm, per sample) and by the noise of q̇ (rad/s):
    ///
    /// ```text
    /// a/(2 − a) diag(σ_τ²) + K² M diag(σ_v²) M,   a = 1 − exp(−K dt)
    /// ```
    ///
    /// The observer averages the first; the second passes as a high-passed momentum, for which the bound for noise faster
    /// than K stands.
    #[inline]
    pub fn noise_covariance_nm2(
        &self,
        mass_matrix: &SMatrix<f64, N, N>,
        torque_sd_nm: &SVector<f64, N>,
        velocity_sd_rad_s: &SVector<f64, N>,
        dt_s: f64,
    ) -> SMatrix<f64, N, N> {
        let momentum = mass_matrix * SMatrix::from_diagonal(&(velocity_sd_rad_s * self.gain_rad_s));
        let mut noise = momentum * momentum.transpose();
        let share = self.share(dt_s);
        for j in 0..N {
            noise[(j, j)] += torque_sd_nm[j].powi(2) * share / (2.0 - share);
        }
        noise
    }

    /// r (Nm).
    #[inline]
    pub fn residual_nm(&self) -> &SVector<f64, N> {
        &self.residual
    }

    /// J_f: the Jacobian as late as r.
    #[inline]
    pub fn lagged_jacobian(&self) -> &SMatrix<f64, 6, N> {
        &self.lagged_jacobian
    }

    /// K (rad/s).
    pub fn gain_rad_s(&self) -> f64 {
        self.gain_rad_s
    }

    #[inline]
    fn keep(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.mass_matrix = terms.mass_matrix;
        self.qd = frame.qd;
        self.bias_nm = terms.bias_nm();
        self.jacobian = terms.jacobian;
    }
}
