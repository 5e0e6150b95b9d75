//! Friction that fades as the joint warms up.

use tribo_sim::Effect;

use super::{Candidate, log_grid};
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `−drop (Fc s + Fv qd) x(t)`, profiled over the time constant τ:
///
/// ```text
/// dx/dt = (P/P̄ − x)/τ,   x = 0 at the start of a log,   P = |friction · qd|
/// ```
///
/// P̄ is the mean over the log; in a gap the joint is taken to go on at the mean power of the burst before. Within a
/// session it is separable from a smaller viscous friction only if the session outlasts a part of τ.
pub(super) struct ThermalFriction {
    pub joint: usize,
}

/// Three minutes to two hours (s).
const TIME_CONSTANT_S: [f64; 2] = [120.0, 7200.0];
/// Fewest time constants that a session must span.
const LEAST_SPAN: f64 = 0.15;

impl<const N: usize> Candidate<N> for ThermalFriction {
    fn label(&self) -> CauseLabel {
        CauseLabel::ThermalFriction
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn unavailable(&self, data: &RegressionData<N>) -> Option<String> {
        if data.nominal.dry_nm(self.joint) + data.nominal.viscous_nm_s(self.joint) <= 0.0 {
            return Some("the model has no friction on this joint that could fade".to_owned());
        }
        let span_s = span_s(data);
        (span_s < LEAST_SPAN * TIME_CONSTANT_S[0])
            .then(|| format!("the log spans {span_s:.0} s, a gear warms up over minutes"))
    }

    fn shapes(&self, _data: &RegressionData<N>) -> Vec<Vec<f64>> {
        log_grid(TIME_CONSTANT_S[0], TIME_CONSTANT_S[1], 8)
    }

    fn profile(&self) -> Option<[f64; 2]> {
        Some(TIME_CONSTANT_S)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let x = warmth(data, self.joint, shape[0]);
        let values = data.of_model.iter().zip(x).map(|(at, x)| -at.friction_nm[self.joint] * x);
        vec![FineColumn::Joint(self.joint, values.collect())]
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        (0.0..1.0).contains(&coefficients[0])
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::ThermalFriction { joint: self.joint, drop_fraction: coefficients[0], time_constant_s: shape[0] })
    }
}

/// Longest time from first to last sample of a log (s).
fn span_s<const N: usize>(data: &RegressionData<N>) -> f64 {
    let starts = data.bursts.iter().map(|burst| {
        let first = data.bursts.iter().find(|other| other.log == burst.log).unwrap_or(burst);
        let end = burst.fine.end.saturating_sub(1);
        data.motion[end].time_s - data.motion[first.fine.start].time_s
    });
    starts.fold(0.0, f64::max)
}

/// x(t) along the samples.
fn warmth<const N: usize>(data: &RegressionData<N>, joint: usize, tau_s: f64) -> Vec<f64> {
    let power = |k: usize| (data.of_model[k].friction_nm[joint] * data.motion[k].qd[joint]).abs();
    let mean = |range: std::ops::Range<usize>| {
        let count = range.len().max(1) as f64;
        range.map(power).sum::<f64>() / count
    };
    let mean_w = mean(0..data.motion.len()).max(1e-12);
    let mut warmth = Vec::with_capacity(data.motion.len());
    let (mut x, mut log, mut last_s, mut last_w) = (0.0, usize::MAX, 0.0, 0.0);
    for burst in &data.bursts {
        if burst.log != log {
            (x, log, last_s) = (0.0, burst.log, data.motion[burst.fine.start].time_s);
        }
        let burst_w = mean(burst.fine.clone()) / mean_w;
        for k in burst.fine.clone() {
            let at = &data.motion[k];
            let input = if k == burst.fine.start { last_w } else { burst_w };
            x = input + (x - input) * (-(at.time_s - last_s) / tau_s).exp();
            last_s = at.time_s;
            warmth.push(x);
        }
        last_w = burst_w;
    }
    warmth
}
