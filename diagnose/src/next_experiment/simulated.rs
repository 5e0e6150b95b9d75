//! What the motion would show if the finding were true.

use nalgebra::{Matrix3, Vector3};
use tribo_regression::{Nominal, RegressionData};
use tribo_robot::Payload;
use tribo_sim::excitation::ViaPoints;
use tribo_sim::{Effect, Recorder, Recording, Session, Truth};

use super::motion::Motion;
use super::pair::Pair;

/// The log at hand, and what is taken for true.
#[derive(Clone, Copy)]
pub(super) struct Arrangement<'a, const N: usize> {
    pub data: &'a RegressionData<N>,
    pub pair: &'a Pair,
    pub others: &'a [&'a Effect],
}

/// Sample rate over the band: any more shows nothing more.
const RATE_OVER_BAND: f64 = 9.0;
/// Band and rate (Hz) of a session: warming up is slow.
const SESSION_HZ: [f64; 2] = [4.0, 40.0];
/// From one logged cycle to the next (s).
pub(super) const CYCLE_EVERY_S: f64 = 300.0;
/// Shortest and longest session (s).
const SESSION_S: [f64; 2] = [3600.0, 7200.0];
/// Time constants that a session should last.
const TIME_CONSTANTS: f64 = 3.0;
/// The known body (kg).
pub(super) const KNOWN_KG: f64 = 1.0;
/// Its centre of mass in front of the flange (m).
const KNOWN_COM_M: f64 = 0.05;

/// Length of a warm-up session (s).
pub(super) fn session_s(pair: &Pair) -> f64 {
    match pair.effect {
        Effect::ThermalFriction { time_constant_s, .. } => {
            (TIME_CONSTANTS * time_constant_s).clamp(SESSION_S[0], SESSION_S[1])
        }
        _ => SESSION_S[0],
    }
}

impl<const N: usize> Arrangement<'_, N> {
    /// One data per log of the motion; without noise, at the band of the log at hand.
    pub fn played(&self, motion: Motion, points: &ViaPoints<N>) -> Option<Vec<RegressionData<N>>> {
        let nominal = &self.data.nominal;
        let plain = self.data_of(nominal, motion, points)?;
        if motion != Motion::KnownPayload {
            return Some(vec![plain]);
        }
        let body =
            Payload { mass_kg: KNOWN_KG, com_m: Vector3::new(0.0, 0.0, KNOWN_COM_M), inertia_kg_m2: Matrix3::zeros() };
        let loaded = Nominal { arm: nominal.arm.clone().with_payload(&body), ..nominal.clone() };
        Some(vec![plain, self.data_of(&loaded, motion, points)?])
    }

    fn data_of(&self, nominal: &Nominal<N>, motion: Motion, points: &ViaPoints<N>) -> Option<RegressionData<N>> {
        let chain = self.data.chains.first()?;
        let (band_hz, rate_hz) = match motion {
            Motion::WarmUpCycles => (chain.band_hz.min(SESSION_HZ[0]), chain.rate_hz.min(SESSION_HZ[1])),
            _ => (chain.band_hz, chain.rate_hz.min(RATE_OVER_BAND * chain.band_hz)),
        };
        let mut effects = nominal.effects.clone();
        effects.push(self.pair.effect.clone());
        let lasting = self.others.iter().filter(|effect| !matches!(effect, Effect::ExternalContact { .. }));
        effects.extend(lasting.map(|effect| (*effect).clone()));
        let truth = Truth { effects, ..Truth::new(nominal.arm.clone(), nominal.friction) };
        let dual_encoder = self.data.deflection_rad.is_some();
        let recording = Recording { rate_hz, torque_side: nominal.torque_side, dual_encoder, ..Recording::default() };
        let recorder = Recorder {
            truth: &truth,
            smoothing_rad_s: nominal.smoothing_rad_s,
            recording: recording.noise_free(),
            extra: None,
        };
        let path = points.path();
        let log = match motion {
            Motion::WarmUpCycles => {
                let session = Session { every_s: CYCLE_EVERY_S, duration_s: session_s(self.pair) };
                recorder.record_session(&path, &session, 0)
            }
            _ => recorder.record(&path, 0),
        };
        RegressionData::of_logs(&[log.ok()?], nominal, Some(band_hz)).ok()
    }
}
