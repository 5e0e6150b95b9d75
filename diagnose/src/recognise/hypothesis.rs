//! What the columns of a log may really be.

use nalgebra::{SVector, Vector3};
use tribo_regression::Nominal;
use tribo_robot::{Arm, presets};
use tribo_sim::TorqueSide;

use super::samples::Instant;

/// One thing that may be wrong.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Change {
    /// The torque of a joint has the opposite sign.
    TorqueSign(usize),
    /// All torques have.
    AllTorqueSigns,
    /// The position of a joint has the opposite sign.
    PositionSign(usize),
    /// Position and torque of a joint have.
    AxisSign(usize),
    /// The torques of two joints stand in each other's place.
    TorquesSwapped(usize, usize),
    /// Their positions do.
    PositionsSwapped(usize, usize),
    /// Positions and torques do.
    JointsSwapped(usize, usize),
    /// The torques of three joints do: the first stands in the place of the second, that in the third's, that in the first's.
    TorquesCycled([usize; 3]),
    /// Their positions do.
    PositionsCycled([usize; 3]),
    /// Positions and torques do.
    JointsCycled([usize; 3]),
    /// Joints come from the tool to the base.
    JointsReversed,
    /// Positions are in degrees.
    Degrees,
    /// The position of a joint is.
    JointDegrees(usize),
    /// All torques are so many times what they should be.
    TorqueFactor(f64),
    /// The torque of a joint is.
    JointTorqueFactor(usize, f64),
    /// The torques lack gravity.
    NoGravity,
    /// Gravity points along a base axis, in steps of the arm's own.
    Gravity(Vector3<f64>),
    /// The torques are of the other side of the gears.
    OtherSide(TorqueSide),
    /// The arm is another one.
    OtherRobot(String),
}

impl Change {
    /// Whether it changes all torques or the arm, so that a payload may hide it.
    pub fn is_of_the_whole_arm(&self) -> bool {
        matches!(self, Self::OtherSide(_) | Self::OtherRobot(_) | Self::TorqueFactor(_))
    }
}

/// Which column is which: `q'_j = factor · q_source`, torques likewise; and the arm that they are of.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis<const N: usize> {
    pub position: [(usize, f64); N],
    pub torque: [(usize, f64); N],
    pub arm: Arm<N>,
}

impl<const N: usize> Hypothesis<N> {
    /// The log is what it says.
    pub fn as_it_is(nominal: &Nominal<N>) -> Self {
        let same = std::array::from_fn(|j| (j, 1.0));
        Self { position: same, torque: same, arm: nominal.arm.clone() }
    }

    /// With one thing wrong on top.
    pub fn with(&self, change: &Change, nominal: &Nominal<N>) -> Self {
        let mut new = self.clone();
        let flip = |column: &mut (usize, f64)| column.1 = -column.1;
        match change {
            Change::TorqueSign(j) => flip(&mut new.torque[*j]),
            Change::AllTorqueSigns => new.torque.iter_mut().for_each(flip),
            Change::PositionSign(j) => flip(&mut new.position[*j]),
            Change::AxisSign(j) => {
                flip(&mut new.torque[*j]);
                flip(&mut new.position[*j]);
            }
            Change::TorquesSwapped(a, b) => new.torque.swap(*a, *b),
            Change::PositionsSwapped(a, b) => new.position.swap(*a, *b),
            Change::JointsSwapped(a, b) => {
                new.torque.swap(*a, *b);
                new.position.swap(*a, *b);
            }
            Change::TorquesCycled(joints) => cycle_back(&mut new.torque, joints),
            Change::PositionsCycled(joints) => cycle_back(&mut new.position, joints),
            Change::JointsCycled(joints) => {
                cycle_back(&mut new.torque, joints);
                cycle_back(&mut new.position, joints);
            }
            Change::JointsReversed => {
                new.torque.reverse();
                new.position.reverse();
            }
            Change::Degrees => new.position.iter_mut().for_each(|column| column.1 *= std::f64::consts::PI / 180.0),
            Change::JointDegrees(j) => new.position[*j].1 *= std::f64::consts::PI / 180.0,
            Change::TorqueFactor(factor) => new.torque.iter_mut().for_each(|column| column.1 /= factor),
            Change::JointTorqueFactor(j, factor) => new.torque[*j].1 /= factor,
            Change::NoGravity => new.arm.gravity_m_s2 = Vector3::zeros(),
            Change::Gravity(gravity) => new.arm.gravity_m_s2 = *gravity,
            Change::OtherSide(TorqueSide::Link) => new.arm.rotor_inertia_kg_m2 = SVector::zeros(),
            Change::OtherSide(TorqueSide::Motor) => {
                if let Some(rotor) = rotor_of_preset(&nominal.arm) {
                    new.arm.rotor_inertia_kg_m2 = rotor;
                }
            }
            Change::OtherRobot(name) => {
                if let Some(arm) = preset::<N>(name) {
                    new.arm = if new.arm.rotor_inertia_kg_m2.amax() == 0.0 { arm.link_side() } else { arm };
                }
            }
        }
        new
    }

    /// The instant as it is meant.
    pub fn of(&self, at: &Instant<N>) -> Instant<N> {
        let moved = |x: &SVector<f64, N>| SVector::from_fn(|j, _| self.position[j].1 * x[self.position[j].0]);
        let tau_nm = SVector::from_fn(|j, _| self.torque[j].1 * at.tau_nm[self.torque[j].0]);
        Instant { q: moved(&at.q), qd: moved(&at.qd), qdd: moved(&at.qdd), tau_nm }
    }

    /// Whether the motion and the arm are those of another hypothesis, so that only torques differ.
    pub fn moves_as(&self, other: &Self) -> bool {
        self.position == other.position && self.arm == other.arm
    }
}

/// An arm of our presets.
fn preset<const N: usize>(name: &str) -> Option<Arm<N>> {
    presets::find(name).as_ref().and_then(|preset| preset.with_joints::<N>()).map(|preset| preset.arm.clone())
}

/// The rotors of the preset of the arm's name.
fn rotor_of_preset<const N: usize>(arm: &Arm<N>) -> Option<SVector<f64, N>> {
    preset::<N>(&arm.name).map(|arm| arm.rotor_inertia_kg_m2)
}

/// Everything of torques alone that is tried.
pub(super) fn of_torques<const N: usize>() -> Vec<Change> {
    let mut changes = vec![Change::AllTorqueSigns];
    changes.extend((0..N).map(Change::TorqueSign));
    changes.extend(pairs::<N>().map(|(a, b)| Change::TorquesSwapped(a, b)));
    changes.extend(cycles::<N>().map(Change::TorquesCycled));
    changes
}

/// Everything of positions and of the arm that is tried.
pub(super) fn of_motion<const N: usize>(nominal: &Nominal<N>) -> Vec<Change> {
    let mut changes = vec![Change::Degrees, Change::JointsReversed, Change::NoGravity];
    changes.extend((0..N).flat_map(|j| [Change::PositionSign(j), Change::AxisSign(j), Change::JointDegrees(j)]));
    changes.extend(pairs::<N>().flat_map(|(a, b)| [Change::PositionsSwapped(a, b), Change::JointsSwapped(a, b)]));
    changes.extend(cycles::<N>().flat_map(|joints| [Change::PositionsCycled(joints), Change::JointsCycled(joints)]));
    let (own, size) = (nominal.arm.gravity_m_s2, nominal.arm.gravity_m_s2.norm());
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let directions = axes.into_iter().flat_map(|axis| [axis * size, -axis * size]);
    changes.extend(directions.filter(|g| (g - own).norm() > 0.5 * size).map(Change::Gravity));
    match nominal.torque_side {
        TorqueSide::Motor if nominal.arm.rotor_inertia_kg_m2.amin() > 0.0 => {
            changes.push(Change::OtherSide(TorqueSide::Link));
        }
        TorqueSide::Link if nominal.arm.rotor_inertia_kg_m2.amax() == 0.0 => {
            changes.extend(rotor_of_preset(&nominal.arm).map(|_| Change::OtherSide(TorqueSide::Motor)));
        }
        _ => {}
    }
    let others = presets::NAMES.into_iter().filter(|name| *name != nominal.arm.name && preset::<N>(name).is_some());
    changes.extend(others.map(|name| Change::OtherRobot(name.to_owned())));
    changes
}

fn pairs<const N: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..N).flat_map(|a| (a + 1..N).map(move |b| (a, b)))
}

/// Three joints each, in both directions of going round.
fn cycles<const N: usize>() -> impl Iterator<Item = [usize; 3]> {
    pairs::<N>().flat_map(|(a, b)| (b + 1..N).flat_map(move |c| [[a, b, c], [a, c, b]]))
}

/// Puts back what went round: the column of the second joint holds the first, that of the third the second, that of the first the third.
fn cycle_back<T: Copy>(columns: &mut [T], [a, b, c]: &[usize; 3]) {
    (columns[*a], columns[*b], columns[*c]) = (columns[*b], columns[*c], columns[*a]);
}
