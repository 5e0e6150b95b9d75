//! The two causes to separate.

use tribo_regression::{CauseLabel, Location, RegressionData};
use tribo_sim::Effect;

use crate::confusable::same_torque;
use crate::diagnosis::Finding;

/// A finding taken for true, and its rival.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pair {
    /// What was found.
    pub found: (CauseLabel, Location),
    /// What it could be instead.
    pub rival: (CauseLabel, Location),
    /// The finding's effect.
    pub effect: Effect,
}

/// Coulomb friction (of the joint's own) that an error is assumed to have where the log cannot tell one from an offset.
const ASSUMED_ERROR: f64 = 0.1;

impl Pair {
    /// The rivals of least difference in evidence; those that differ by physics first, then joints that moved one way
    /// only, then those that no torque can tell apart.
    pub fn closest<const N: usize>(data: &RegressionData<N>, findings: &[Finding]) -> Option<Self> {
        let mut doubted: Vec<(f64, Self)> = findings
            .iter()
            .filter_map(|finding| Some((finding, finding.effect.clone()?)))
            .flat_map(|(finding, effect)| {
                finding.alternatives.iter().map(move |rival| {
                    let found = (finding.label, finding.location);
                    let pair = Self { found, rival: (rival.label, rival.location), effect: effect.clone() };
                    (rival.evidence_gap, pair)
                })
            })
            .filter(|(_, pair)| pair.rival.0 != CauseLabel::Unknown)
            .collect();
        doubted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (physics, closest): (Vec<_>, Vec<_>) =
            doubted.into_iter().map(|(_, pair)| pair).partition(|pair: &Self| pair.same_torque(data));
        closest.into_iter().next().or_else(|| Self::one_way(data, findings)).or_else(|| physics.into_iter().next())
    }

    /// Coulomb friction against an offset on a joint that moves in one direction only: a found one, or else a small one.
    fn one_way<const N: usize>(data: &RegressionData<N>, findings: &[Finding]) -> Option<Self> {
        let one_way: Vec<usize> = (0..N).filter(|joint| data.moves_one_way(*joint)).collect();
        let pair = |effect: Effect, joint: usize| {
            let (coulomb, offset) = (CauseLabel::Coulomb, CauseLabel::TorqueOffset);
            let found = CauseLabel::of(&effect);
            let rival = if found == coulomb { offset } else { coulomb };
            Self { found: (found, Location::Joint(joint)), rival: (rival, Location::Joint(joint)), effect }
        };
        for finding in findings {
            match finding.effect {
                Some(Effect::Coulomb { joint, .. } | Effect::TorqueOffset { joint, .. })
                    if one_way.contains(&joint) =>
                {
                    return finding.effect.clone().map(|effect| pair(effect, joint));
                }
                _ => {}
            }
        }
        let joint = *one_way.first()?;
        let delta_coulomb_nm = (ASSUMED_ERROR * data.nominal.dry_nm(joint)).max(data.noise_floor_nm[joint]);
        Some(pair(Effect::Coulomb { joint, delta_coulomb_nm }, joint))
    }

    /// Whether the two give the same torque whatever the motion.
    pub fn same_torque<const N: usize>(&self, data: &RegressionData<N>) -> bool {
        same_torque(&data.nominal, self.found, self.rival)
    }

    /// Whether either is this cause.
    pub fn names(&self, label: CauseLabel) -> bool {
        self.found.0 == label || self.rival.0 == label
    }

    /// The joint that alone need move: both causes sit there, and neither feels the other joints.
    pub fn own_joint(&self) -> Option<usize> {
        use CauseLabel::{JointElasticity, LoadFriction, RotorInertia, TorqueGain};
        let feels_others = [JointElasticity, LoadFriction, RotorInertia, TorqueGain].into_iter().any(|l| self.names(l));
        match (self.found.1, self.rival.1) {
            (Location::Joint(a), Location::Joint(b)) if a == b && !feels_others => Some(a),
            _ => None,
        }
    }
}
