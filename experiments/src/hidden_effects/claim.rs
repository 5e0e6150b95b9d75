//! What an answer claims, joint by joint.

use tribo_diagnose::{Diagnosis, Finding};
use tribo_regression::{CauseLabel, Location};
use tribo_sim::Effect;

use super::{HiddenCase, World};

/// One label at one place, of a finding that may cover several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    pub label: CauseLabel,
    pub location: Location,
    /// The finding that makes it, in the order of the answer.
    pub finding: usize,
}

/// Last link of the arm.
const LAST_LINK: usize = 6;
/// Error of a value over what is hidden up to which it is right [-].
const RIGHT_VALUE: f64 = 0.5;
/// Half-widths of its interval up to which it is.
const RIGHT_HALF_WIDTHS: f64 = 1.5;

/// Every claim of an answer, in its order.
pub(super) fn claims(diagnosis: &Diagnosis) -> Vec<Claim> {
    let of_finding = |(finding, found): (usize, &Finding)| {
        let joints = found.joints.iter().map(|joint| Location::Joint(*joint));
        let mut places: Vec<Location> = joints.chain(found.links.iter().map(|link| Location::Link(*link))).collect();
        if places.is_empty() {
            places.push(found.location);
        }
        let label = found.label;
        places.into_iter().map(move |location| Claim { label, location, finding })
    };
    diagnosis.findings.iter().enumerate().flat_map(of_finding).collect()
}

/// Whether a claim is right whatever is hidden: of what the nominal model of this world lacks in every joint and link.
pub(super) fn is_background(claim: &Claim, world: World) -> bool {
    world == World::WrongEverywhere && lacks_everywhere(claim.label)
}

/// Whether a hidden cause is of a kind that this world has at every joint.
pub(super) fn is_background_cause(effect: &Effect, world: World) -> bool {
    world == World::WrongEverywhere && lacks_everywhere(CauseLabel::of(effect))
}

fn lacks_everywhere(label: CauseLabel) -> bool {
    use CauseLabel::{Coulomb, FrictionCurve, LinkInertial, TorqueOffset, Viscous};
    matches!(label, Coulomb | Viscous | FrictionCurve | TorqueOffset | LinkInertial)
}

/// Whether a label at a place is a hidden cause.
///
/// A name counts at its joint or link. Pairs that are one thing by physics count as such: a payload and mass on the last link,
/// rotor inertia of joint 0 and inertia of link 0. Where friction is wrong everywhere it is one function of speed: a peak near rest
/// is right as friction that bends with speed, dry and viscous friction and offsets are right by their value.
pub(super) fn names(at: (CauseLabel, Location), effect: &Effect, case: &HiddenCase) -> bool {
    let place = place(effect);
    let bent = case.world == World::WrongEverywhere && matches!(effect, Effect::Stribeck { .. });
    at == place || same_by_physics(at, effect) || (bent && at == (CauseLabel::FrictionCurve, place.1))
}

/// Whether the value that an answer gives at a hidden cause's joint is that of the cause and what the model lacks beside it.
///
/// `None` for causes that the model lacks nowhere else.
pub(super) fn right_value(effect: &Effect, case: &HiddenCase, diagnosis: &Diagnosis) -> Option<bool> {
    let (which, joint, hidden, labels): (usize, usize, f64, &[CauseLabel]) = match effect {
        Effect::Coulomb { joint, delta_coulomb_nm } => {
            (0, *joint, *delta_coulomb_nm, &[CauseLabel::Coulomb, CauseLabel::FrictionCurve])
        }
        Effect::Viscous { joint, delta_viscous_nm_s_per_rad } => {
            (1, *joint, *delta_viscous_nm_s_per_rad, &[CauseLabel::Viscous])
        }
        Effect::TorqueOffset { joint, offset_nm } => (2, *joint, *offset_nm, &[CauseLabel::TorqueOffset]),
        _ => return None,
    };
    let (mut told, mut half_width) = (0.0, 0.0_f64);
    for found in diagnosis.findings.iter().filter(|found| labels.contains(&found.label)) {
        let single = found.joints.is_empty() && found.location == Location::Joint(joint);
        let index = if single { Some(0) } else { found.joints.iter().position(|other| *other == joint) };
        if let (Some(index), Some(parameter)) = (index, found.parameters.iter().find(|of| of.name.contains("nm"))) {
            told += parameter.value.get(index).copied().unwrap_or(0.0);
            half_width = half_width.max(parameter.ci95.get(index).map_or(0.0, |[low, high]| 0.5 * (high - low)));
        }
    }
    let error = (told - case.lacks[which][joint] - hidden).abs();
    Some(error <= (RIGHT_VALUE * hidden.abs()).max(RIGHT_HALF_WIDTHS * half_width.min(hidden.abs())))
}

/// Label and location of an effect.
pub(super) fn place(effect: &Effect) -> (CauseLabel, Location) {
    let location = match (effect, effect.joint()) {
        (Effect::LinkInertial { link, .. }, _) => Location::Link(*link),
        (_, Some(joint)) => Location::Joint(joint),
        (_, None) => Location::Arm,
    };
    (CauseLabel::of(effect), location)
}

/// Whether the two give the same torque on any motion.
fn same_by_physics(at: (CauseLabel, Location), effect: &Effect) -> bool {
    let last = (CauseLabel::LinkInertial, Location::Link(LAST_LINK));
    let first = (CauseLabel::LinkInertial, Location::Link(0));
    match effect {
        Effect::Payload { .. } => at == last,
        Effect::LinkInertial { link: LAST_LINK, delta_mass_kg, .. } => {
            *delta_mass_kg > 0.0 && at == (CauseLabel::Payload, Location::Arm)
        }
        Effect::RotorInertia { joint: 0, .. } => at == first,
        Effect::LinkInertial { link: 0, .. } => at == (CauseLabel::RotorInertia, Location::Joint(0)),
        _ => false,
    }
}
