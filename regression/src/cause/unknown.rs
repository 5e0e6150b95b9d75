//! Causes without a name: low-order families that exist to lose against the named ones.

use std::fmt;

use tribo_sim::Effect;

use super::Candidate;
use super::presliding::bristle;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::{RegressionData, Sample};

/// A family of torques of one joint. When it beats every named cause, the verdict is `unknown` with its signature.
pub(super) struct Unknown {
    pub joint: usize,
    pub family: Family,
}

/// Torque at which a dead or saturated sensor bends, over its RMS.
const SATURATES_AT: f64 = 0.2;

/// Distances over which a hysteretic spring forgets (rad): beyond those of presliding.
const PATH_RAD: [f64; 3] = [0.06, 0.22, 0.8];

/// What a torque may go with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A factor times `cos q, sin q, cos 2q, sin 2q`.
    Position(Factor),
    /// A factor times Legendre polynomials of time, orders 1 to 3.
    Time(Factor),
    /// `qd |qd|, qd³`.
    Speed,
    /// `tau |tau|, tau³` of the link, and `tanh(tau/τ₀)` of all the joint transmits, τ₀ a fifth of its RMS.
    Load,
    /// Bristles of 0.06 to 0.8 rad: springs that remember the way they came.
    Path,
    /// Velocity, its sign and acceleration of another joint.
    Neighbour(usize),
}

/// What is modulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Factor {
    /// A torque on its own.
    One,
    /// Dry friction.
    Dry,
    /// Viscous friction.
    Viscous,
    /// The link-side torque.
    Load,
}

impl Factor {
    fn value<const N: usize>(self, at: &Sample<N>, j: usize) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Dry => at.sign[j],
            Self::Viscous => at.qd[j],
            Self::Load => at.link_nm[j],
        }
    }
}

impl fmt::Display for Factor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::One => "a torque",
            Self::Dry => "dry friction",
            Self::Viscous => "viscous friction",
            Self::Load => "the load",
        })
    }
}

impl Family {
    /// Every family of a joint.
    pub fn of_joint<const N: usize>(joint: usize) -> Vec<Self> {
        let factors = [Factor::One, Factor::Dry, Factor::Viscous, Factor::Load];
        let mut all: Vec<Self> = factors.map(Self::Position).to_vec();
        all.extend([Factor::One, Factor::Dry, Factor::Viscous].map(Self::Time));
        all.extend([Self::Speed, Self::Load, Self::Path]);
        all.extend((0..N).filter(|other| *other != joint).map(Self::Neighbour));
        all
    }
}

impl<const N: usize> Candidate<N> for Unknown {
    fn label(&self) -> CauseLabel {
        CauseLabel::Unknown
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        let j = self.joint;
        let column = |value: &dyn Fn(&Sample<N>) -> f64| data.joint_column(j, value);
        match self.family {
            Family::Position(factor) => [1.0, 2.0]
                .iter()
                .flat_map(|order| {
                    [
                        column(&|at| factor.value(at, j) * (order * at.q[j]).cos()),
                        column(&|at| factor.value(at, j) * (order * at.q[j]).sin()),
                    ]
                })
                .collect(),
            Family::Time(factor) => {
                let (start, end) = data.motion.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                    (low.min(at.time_s), high.max(at.time_s))
                });
                let unit = move |at: &Sample<N>| 2.0 * (at.time_s - start) / (end - start).max(1e-9) - 1.0;
                vec![
                    column(&|at| factor.value(at, j) * unit(at)),
                    column(&|at| factor.value(at, j) * 0.5 * (3.0 * unit(at).powi(2) - 1.0)),
                    column(&|at| factor.value(at, j) * 0.5 * (5.0 * unit(at).powi(3) - 3.0 * unit(at))),
                ]
            }
            Family::Speed => {
                vec![column(&|at| at.qd[j] * at.qd[j].abs()), column(&|at| at.qd[j].powi(3))]
            }
            Family::Load => {
                let squares: f64 = data.of_model.iter().map(|at| at.model_nm[j].powi(2)).sum();
                let knee_nm = (SATURATES_AT * (squares / data.of_model.len().max(1) as f64).sqrt()).max(1e-6);
                vec![
                    column(&|at| at.link_nm[j] * at.link_nm[j].abs()),
                    column(&|at| at.link_nm[j].powi(3)),
                    column(&|at| (at.model_nm[j] / knee_nm).tanh()),
                ]
            }
            Family::Path => PATH_RAD.iter().map(|d| FineColumn::Joint(j, bristle(data, j, *d))).collect(),
            Family::Neighbour(other) => {
                vec![column(&|at| at.sign[other]), column(&|at| at.qd[other]), column(&|at| at.qdd[other])]
            }
        }
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], _coefficients: &[f64]) -> Option<Effect> {
        None
    }

    fn signature(&self) -> Option<String> {
        Some(match self.family {
            Family::Position(factor) => format!("{factor} varies with the joint angle, orders 1 and 2"),
            Family::Time(factor) => format!("{factor} drifts with time"),
            Family::Speed => "a torque that grows faster than velocity".to_owned(),
            Family::Load => "a torque that grows unevenly with the load".to_owned(),
            Family::Path => "a torque that depends on the way the joint came".to_owned(),
            Family::Neighbour(other) => format!("a torque that goes with the motion of joint {other}"),
        })
    }
}
