//! The two-encoder estimate in the tick.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector};
use tribo_robot::{ControlTerms, EstimateFault, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator};

use super::deflection_gp::inputs;
use super::{Approach, DoubleEncoderModel, Rest};
use crate::MomentumObserver;
use crate::damped_wrench::damped_wrench;

/// Wrench from the deflection of the joints while the arm moves:
///
/// ```text
/// τ_W + dynamics = T(Δθ) − T(Δθ₁(x)),     x = (q, approach)
/// ṗ = τ_W + dynamics + Cᵀ q̇ − Jᵀ h,      p = (M − Ir) q̇         [`MomentumObserver`] of the links, 1/K late
/// ĥ = P J R⁻¹ r                                                  covariance P, damped as the momentum estimator's
/// ```
///
/// The paper is quasi-static; its Δθ₁ is what gravity and stiction do to a free arm at x. The torque through the gears also
/// carries the inertia of the links, which a momentum observer takes off without an acceleration. Friction and inertia of
/// the motors lie on the other side of the gears and are **not seen**: this is an estimate of contact, not of friction.
/// `tau_motor` and `tau_friction` of the input are not used.
///
/// The exact process of 960 rests costs some 0.1 ms per joint for the mean and several for the variance. In the tick it
/// stands on its inducing points ([`super::DeflectionGp::compression_rms_rad`], part of R), and one joint per tick is
/// evaluated; the others move along the slope of their last evaluation, at most N ticks old: at 1 rad/s and 1 kHz 7 mrad
/// of length-scales near 1 rad, an error of 1e-4 of the process.
///
/// R: white encoder noise through the stiffness and the observer; noise of q̇ as the momentum estimator has it; and what is
/// not averaged: process, stiction, slopes and misfit of the stiffness curve.
///
/// A frame without `theta` is [`EstimateFault::MotorPositionMissing`].
#[derive(Clone, Debug)]
pub struct DoubleEncoderEstimator<const N: usize> {
    model: Arc<DoubleEncoderModel<N>>,
    state: State<N>,
    scratch: Vec<f64>,
    x: Vec<f64>,
    slope: Vec<f64>,
}

/// What a refused sample must leave as it was.
#[derive(Clone, Copy, Debug)]
struct State<const N: usize> {
    observer: MomentumObserver<N>,
    approach: Approach<N>,
    /// Deflection, low-passed as the torque is (rad).
    slow_deflection: SVector<f64, N>,
    /// Torque at the last sample (Nm), and its variance by what is not averaged (Nm²).
    torque: SVector<f64, N>,
    variance: SVector<f64, N>,
    anchors: [Anchor<N>; N],
    next: usize,
    estimate: WrenchEstimate,
}

/// One joint's process at its last evaluation.
#[derive(Clone, Copy, Debug)]
struct Anchor<const N: usize> {
    q: SVector<f64, N>,
    approach: [f64; 2],
    mean_rad: f64,
    slope_q: SVector<f64, N>,
    slope_approach: [f64; 2],
    variance: f64,
}

impl<const N: usize> DoubleEncoderEstimator<N> {
    /// An estimator that knows nothing yet; [`WrenchEstimator::reset`] places it. Estimators share the model.
    pub fn new(model: Arc<DoubleEncoderModel<N>>) -> Self {
        let settings = model.settings;
        let none = SVector::zeros();
        let nothing = Anchor {
            q: none,
            approach: [0.0; 2],
            mean_rad: 0.0,
            slope_q: none,
            slope_approach: [0.0; 2],
            variance: settings.encoder_sd_rad * settings.encoder_sd_rad,
        };
        let most = model.processes.iter().map(super::DeflectionGp::inducing_points).max().unwrap_or(0);
        let state = State {
            observer: MomentumObserver::new(settings.gain_rad_s),
            approach: Approach::new(settings.direction_travel_rad, settings.loading_travel_rad),
            slow_deflection: none,
            torque: none,
            variance: none,
            anchors: [nothing; N],
            next: 0,
            estimate: WrenchEstimate::none_yet(),
        };
        Self { model, state, scratch: vec![0.0; most], x: vec![0.0; N + 2], slope: vec![0.0; N + 2] }
    }

    /// The model.
    pub fn model(&self) -> &DoubleEncoderModel<N> {
        &self.model
    }

    /// Evaluates joint j's process here.
    #[inline]
    fn evaluate(&mut self, j: usize, q: &SVector<f64, N>) {
        let Some(process) = self.model.processes.get(j) else { return };
        let (mut anchor_q, mut approach) = (SVector::zeros(), [0.0; 2]);
        let count = inputs(&self.model.settings, j, &self.here(q), &mut anchor_q, &mut approach);
        let values = anchor_q.iter().chain(&approach);
        self.x.iter_mut().zip(values).for_each(|(x, value)| *x = *value);
        let at = process.predict_fast_rad(&mut self.x[..count], &mut self.scratch, &mut self.slope[..count]);
        let mut slope_approach = [0.0; 2];
        slope_approach.iter_mut().zip(&self.slope[N..count]).for_each(|(to, from)| *to = *from);
        self.state.anchors[j] = Anchor {
            q: anchor_q,
            approach,
            mean_rad: at.mean,
            slope_q: SVector::from_fn(|i, _| self.slope[i]),
            slope_approach,
            variance: at.sd * at.sd + process.noise_rad().powi(2) + process.compression_rms_rad().powi(2),
        };
    }

    /// The present state in the form of the calibration.
    #[inline]
    fn here(&self, q: &SVector<f64, N>) -> Rest<N> {
        let approach = &self.state.approach;
        Rest {
            q: *q,
            deflection_rad: self.state.slow_deflection,
            direction: approach.direction(),
            loading: approach.loading(),
        }
    }

    /// Torque beyond that of the free arm at rest (Nm) at a deflection (rad), and its variance (Nm²).
    #[inline]
    fn torque(
        &self,
        q: &SVector<f64, N>,
        gravity: &SVector<f64, N>,
        deflection: &SVector<f64, N>,
    ) -> [SVector<f64, N>; 2] {
        let rest = self.here(q);
        let (mut torque, mut variance) = (SVector::zeros(), SVector::zeros());
        for j in 0..N {
            let anchor = &self.state.anchors[j];
            let mut free = self.model.mean_rad(j, gravity[j]) + anchor.mean_rad + anchor.slope_q.dot(&(q - anchor.q));
            let (mut ignored, mut approach) = (SVector::<f64, N>::zeros(), [0.0; 2]);
            inputs(&self.model.settings, j, &rest, &mut ignored, &mut approach);
            for i in 0..2 {
                free += anchor.slope_approach[i] * (approach[i] - anchor.approach[i]);
            }
            (torque[j], variance[j]) = self.model.load_torque_nm(j, free, anchor.variance, deflection[j]);
        }
        [torque, variance]
    }

    /// R: covariance of the observer's residual (Nm²).
    #[inline]
    fn residual_covariance(&self, links: &ControlTerms<N>, dt_s: f64) -> SMatrix<f64, N, N> {
        let (settings, observer) = (&self.model.settings, &self.state.observer);
        let torque_sd_nm = SVector::from_fn(|j, _| {
            let stiffness = self.model.curves[j].stiffness_nm_per_rad(self.state.slow_deflection[j]);
            std::f64::consts::SQRT_2 * stiffness * settings.encoder_sd_rad
        });
        let velocity_sd_rad_s = SVector::repeat(settings.velocity_sd_rad_s);
        let noise = observer.noise_covariance_nm2(&links.mass_matrix, &torque_sd_nm, &velocity_sd_rad_s, dt_s);
        noise + SMatrix::from_diagonal(&self.state.variance)
    }

    /// The terms of the links alone, without gravity: that is in the deflection of the free arm.
    #[inline]
    fn links(&self, terms: &ControlTerms<N>) -> ControlTerms<N> {
        let mut links = *terms;
        links.gravity_nm = SVector::zeros();
        for j in 0..N {
            links.mass_matrix[(j, j)] -= self.model.rotor_inertia_kg_m2[j];
        }
        links
    }
}

impl<const N: usize> WrenchEstimator<N> for DoubleEncoderEstimator<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        let settings = self.model.settings;
        let links = self.links(terms);
        self.state.observer.start(frame, &links);
        self.state.approach = Approach::new(settings.direction_travel_rad, settings.loading_travel_rad);
        self.state.slow_deflection = frame.theta.map_or_else(SVector::zeros, |theta| theta - frame.q);
        self.state.approach.push(&frame.q, &self.state.slow_deflection);
        self.state.next = 0;
        self.state.estimate = WrenchEstimate::none_yet();
        for j in 0..N {
            self.evaluate(j, &frame.q);
        }
        [self.state.torque, self.state.variance] =
            self.torque(&frame.q, &terms.gravity_nm, &self.state.slow_deflection);
    }

    #[inline(never)]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        if let Err(fault) = input.check() {
            return self.state.estimate.held(fault);
        }
        let Some(theta) = input.frame.theta else {
            return self.state.estimate.held(EstimateFault::MotorPositionMissing);
        };
        let before = self.state;
        let (q, deflection) = (&input.frame.q, theta - input.frame.q);
        let share = self.state.observer.share(input.dt_s);
        self.state.slow_deflection += (deflection - self.state.slow_deflection) * share;
        self.state.approach.push(q, &self.state.slow_deflection);
        self.evaluate(self.state.next, q);
        self.state.next = (self.state.next + 1) % N;

        let last = self.state.torque;
        [self.state.torque, self.state.variance] = self.torque(q, &input.terms.gravity_nm, &deflection);
        let over_period = (last + self.state.torque) * 0.5;
        let links = self.links(input.terms);
        self.state.observer.step(input.frame, &links, &over_period, input.dt_s);

        let settings = &self.model.settings;
        let damping = [settings.moment_damping_nm, settings.force_damping_n];
        let r = self.residual_covariance(&links, input.dt_s);
        let observer = &self.state.observer;
        match damped_wrench(observer.lagged_jacobian(), &r, observer.residual_nm(), damping) {
            Some((h, covariance)) => {
                let wrench_base = Wrench::from_vector(&h);
                self.state.estimate = WrenchEstimate { wrench_base, covariance, ..WrenchEstimate::none_yet() };
                self.state.estimate
            }
            None => {
                self.state = before;
                self.state.estimate.held(EstimateFault::NotPositiveDefinite)
            }
        }
    }

    /// 1/K.
    fn delay_s(&self) -> f64 {
        1.0 / self.model.settings.gain_rad_s
    }
}
