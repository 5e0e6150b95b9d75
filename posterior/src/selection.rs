//! Which families an arm shows: forward and backward by evidence.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::fit::{Fit, RELINEARISATIONS, fit};
use crate::prior::Family;
use crate::problem::{NormalEquations, Place, Problem};
use crate::spd;

/// Evidence (nat) by which a family must make the log likelier. Ten, not three: what is left of a real log is no noise that any
/// likelihood knows, and on logs of an independent simulator absent families drew up to 40 nats where velocity was noisy.
pub const LEAST_NATS: f64 = 10.0;
/// Evidence within which a rival cannot be excluded.
pub(crate) const RIVAL_NATS: f64 = 5.0;
/// Standard deviations that a payload's mass must be above zero.
const PAYLOAD_SD: f64 = 2.0;
/// Farthest centre of mass of a payload from the flange (m).
const PAYLOAD_FARTHEST_M: f64 = 0.4;

/// The selection and what every family is worth.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Families shown by the log, in the order of [`Family::ALL`].
    pub selected: Vec<Family>,
    /// Joints of the selected families that not every joint shows.
    pub only_joints: BTreeMap<Family, Vec<usize>>,
    /// What each selected family is worth given the others (nat).
    pub worth: BTreeMap<Family, f64>,
    /// What each other family would add (nat).
    pub would_add: BTreeMap<Family, f64>,
    /// Families that would do in the place of a selected one, with what is lost by the exchange (nat).
    pub rivals: BTreeMap<Family, Vec<(Family, f64)>>,
}

/// Families in the order of [`Family::ALL`], some of them in some joints alone.
#[derive(Clone, Debug, Default)]
struct Set {
    families: Vec<Family>,
    only_joints: BTreeMap<Family, Vec<usize>>,
}

impl Set {
    fn with(&self, family: Family) -> Self {
        let families = Family::ALL.into_iter().filter(|other| self.families.contains(other) || *other == family);
        Self { families: families.collect(), ..self.clone() }
    }

    fn without(&self, family: Family) -> Self {
        let mut left = self.clone();
        left.families.retain(|other| *other != family);
        left.only_joints.remove(&family);
        left
    }

    fn with_joint(&self, family: Family, joint: usize) -> Self {
        let mut more = self.with(family);
        more.only_joints.entry(family).or_default().push(joint);
        more
    }

    fn has(&self, place: Place) -> bool {
        let family = place.family();
        let joints = self.only_joints.get(&family);
        let here = joints.zip(place.joint()).is_none_or(|(joints, joint)| joints.contains(&joint));
        here && self.families.contains(&family)
    }

    /// Joints of families that are not in all of them.
    fn named_joints(&self) -> usize {
        self.only_joints.values().map(Vec::len).sum()
    }
}

/// Evidence of sets of families at the noise colour of the fit of all.
struct Evidence<'p> {
    problem: &'p Problem,
    /// Equations of sets without gains.
    ungained: NormalEquations,
    parts: &'p [usize],
    all: &'p Fit,
}

impl<'p> Evidence<'p> {
    fn new(problem: &'p Problem, parts: &'p [usize], all: &'p Fit) -> Self {
        let ungained =
            problem.normal_equations(&problem.without(&all.state, |place| place.family() == Family::Gain), parts);
        Self { problem, ungained, parts, all }
    }

    /// ln Z of a set, less the logarithm of the number of joints for each that it names: any of them might have been it.
    fn of(&self, set: &Set) -> f64 {
        let Some(found) = self.fit(set) else { return f64::NEG_INFINITY };
        if set.families.contains(&Family::Payload) && !is_payload(self.problem, &found) {
            return f64::NEG_INFINITY;
        }
        found.log_evidence - set.named_joints() as f64 * (self.problem.joints() as f64).ln()
    }

    /// The fit of a set, linear in the gains about itself: about the fit of all, the column of a gain is the torque of all families, and would bring
    /// along those that the set lacks.
    fn fit(&self, set: &Set) -> Option<Fit> {
        let mut start = self.all.lend(self.problem, set.families.clone());
        let in_families = |place: &Place| set.families.contains(&place.family());
        let elsewhere =
            self.problem.places.iter().enumerate().filter(|(_, place)| in_families(place) && !set.has(**place));
        start.pinned.extend(elsewhere.map(|(i, _)| (i, 0.0)));
        if !set.families.contains(&Family::Gain) {
            return fit(self.problem, &self.ungained, self.parts, &start);
        }
        let mut about = self.problem.without(&self.all.state, |place| !set.has(place));
        let mut found = None;
        for _ in 0..RELINEARISATIONS {
            let next = fit(self.problem, &self.problem.normal_equations(&about, self.parts), self.parts, &start)?;
            about.clone_from(&next.state);
            found = Some(next);
        }
        found
    }

    fn of_all(&self, sets: Vec<Set>) -> Vec<f64> {
        sets.into_par_iter().map(|set| self.of(&set)).collect()
    }

    /// The likeliest of some sets.
    fn best<M: Copy>(&self, moves: Vec<(M, Set)>) -> Option<(M, Set, f64)> {
        let values = self.of_all(moves.iter().map(|(_, set)| set.clone()).collect());
        let best = moves.into_iter().zip(values).max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|((what, set), value)| (what, set, value))
    }

    /// What a family brings at a joint, at most (nat): ½ θᵀS⁻¹θ of its parameters there in the fit of all.
    fn most(&self, family: Family, joint: usize) -> f64 {
        let places = &self.problem.places;
        let here = |i: &usize| places[*i].family() == family && places[*i].joint() == Some(joint);
        let own: Vec<usize> = self.all.active.iter().copied().filter(here).collect();
        let covariance = DMatrix::from_fn(own.len(), own.len(), |r, c| self.all.covariance_of(own[r], own[c]));
        let value = DVector::from_fn(own.len(), |r, _| self.all.state[own[r]]);
        spd::inverse(&covariance).map_or(0.0, |inverse| 0.5 * (value.transpose() * inverse.matrix * &value)[0])
    }
}

/// Whether the payload of a fit is one: a mass that is surely positive, near the flange.
pub fn is_payload(problem: &Problem, fit: &Fit) -> bool {
    let at = |k: usize| problem.index(Place::Payload(k));
    let Some(mass) = at(0).filter(|i| fit.active.contains(i)) else { return false };
    let moment = (1..4).filter_map(at).map(|i| fit.state[i].powi(2)).sum::<f64>().sqrt();
    let mass_kg = fit.state[mass];
    mass_kg > PAYLOAD_SD * fit.sd(mass) && moment < PAYLOAD_FARTHEST_M * mass_kg
}

/// Adds the likeliest family while that is worth it, drops what is not worth having; begins with what every arm has. A family that not every joint
/// shows is asked of each joint by itself at the end: the parameters of the others would cost more than the one brings.
pub fn select(problem: &Problem, parts: &[usize], all: &Fit) -> Selection {
    let evidence = Evidence::new(problem, parts, all);
    let candidates: Vec<Family> = all.start.families.clone();
    let always = |family: &Family| family.prior(problem.scale.link_side).always;
    let mut set = Set { families: candidates.iter().copied().filter(always).collect(), ..Set::default() };
    let mut value = evidence.of(&set);
    let out_of = |set: &Set| candidates.iter().copied().filter(|f| !set.families.contains(f)).collect::<Vec<Family>>();
    loop {
        let moves = out_of(&set).into_iter().map(|family| (family, set.with(family))).collect();
        let Some((_, more, better)) = evidence.best(moves).filter(|best| best.2 > value + LEAST_NATS) else { break };
        (set, value) = (more, better);
        loop {
            let inside = set.families.iter().copied().filter(|family| !always(family));
            let moves = inside.map(|family| (family, set.without(family))).collect();
            let Some((_, less, left)) = evidence.best(moves).filter(|best| best.2 > value - LEAST_NATS) else { break };
            (set, value) = (less, left);
        }
    }
    let of_joints: Vec<(Family, usize)> = out_of(&set)
        .into_iter()
        .filter(|family| !family.labels().is_empty())
        .flat_map(|family| (0..problem.joints()).map(move |joint| (family, joint)))
        .filter(|(family, joint)| evidence.most(*family, *joint) > LEAST_NATS)
        .collect();
    loop {
        let more = of_joints
            .iter()
            .filter(|(family, joint)| !set.only_joints.get(family).is_some_and(|joints| joints.contains(joint)));
        let moves = more.map(|(family, joint)| ((), set.with_joint(*family, *joint))).collect();
        let Some(((), more, better)) = evidence.best(moves).filter(|best| best.2 > value + LEAST_NATS) else { break };
        (set, value) = (more, better);
    }
    set.only_joints.values_mut().for_each(|joints| joints.sort_unstable());
    let out = out_of(&set);
    let inside = set.families.clone();
    let left = evidence.of_all(inside.iter().map(|family| set.without(*family)).collect());
    let worth = inside.iter().copied().zip(left.iter().map(|left| value - left)).collect();
    let more = evidence.of_all(out.iter().map(|family| set.with(*family)).collect());
    let would_add = out.iter().copied().zip(more.iter().map(|more| more - value)).collect();
    let pairs: Vec<(Family, Family)> =
        inside.iter().flat_map(|family| out.iter().map(move |rival| (*family, *rival))).collect();
    let swapped = evidence.of_all(pairs.iter().map(|(family, rival)| set.without(*family).with(*rival)).collect());
    let mut rivals: BTreeMap<Family, Vec<(Family, f64)>> = BTreeMap::new();
    for ((family, rival), swapped) in pairs.into_iter().zip(swapped) {
        if swapped > value - RIVAL_NATS {
            rivals.entry(family).or_default().push((rival, value - swapped));
        }
    }
    rivals.values_mut().for_each(|list| list.sort_by(|a, b| a.1.total_cmp(&b.1)));
    Selection { selected: set.families, only_joints: set.only_joints, worth, would_add, rivals }
}

#[cfg(test)]
mod tests {
    use tribo_friction::FrictionModel;
    use tribo_robot::presets;
    use tribo_sim::excitation::{Envelope, Excitation};
    use tribo_sim::{Effect, Recording, Truth, record};

    use super::super::columns::{Columns, PARTS};
    use super::super::fit::{Start, posterior};
    use super::super::prior::ArmScale;
    use super::super::problem::State;
    use super::*;
    use tribo_regression::Nominal;
    use tribo_regression::RegressionData;

    /// An arm of sliding, bristly friction whose torque signals are right. About the fit of all, whose torque has the bristles, gains beside sliding friction alone are
    /// twice what they are about themselves.
    #[test]
    fn a_set_with_gains_is_linear_about_itself() {
        let arm = presets::panda();
        let friction = (0..7).flat_map(|joint| {
            let dry_nm = 0.06 * arm.limits.tau_max_nm[joint];
            [
                Effect::Coulomb { joint, delta_coulomb_nm: dry_nm },
                Effect::Viscous { joint, delta_viscous_nm_s_per_rad: dry_nm },
                Effect::Presliding { joint, presliding_distance_rad: 5e-3, amplitude_nm: Some(dry_nm) },
            ]
        });
        let truth = Truth { effects: friction.collect(), ..Truth::new(arm.clone(), FrictionModel::none()) };
        let motion = Excitation::Multisine.draw(&Envelope::around(&arm, presets::panda_ready_pose()), 30.0, 2);
        let recording = Recording { rate_hz: 250.0, torque_sd_nm: 0.05, ..Recording::default() };
        let log = record(&truth, 0.005, motion.as_ref(), &recording, 3).unwrap();
        let nominal =
            Nominal { smoothing_rad_s: 0.005, ..Nominal::new(arm, FrictionModel::none(), recording.torque_side) };
        let data = RegressionData::of_logs(&[log], &nominal, Some(10.0)).unwrap();
        let scale = ArmScale::of(&data);
        let problem = Problem::of(&data, Columns::of(&data, &scale, PARTS), scale, vec![false]);
        let parts = problem.all_parts();
        let families: Vec<Family> =
            Family::of_gears(problem.scale.link_side).filter(|family| problem.has(*family)).collect();
        let (all, _) = posterior(&problem, &parts, &Start::of(&families)).unwrap();
        let evidence = Evidence::new(&problem, &parts, &all);
        let sliding = Set { families: vec![Family::Offset, Family::CoulombViscous], ..Set::default() };
        let gains = sliding.with(Family::Gain);
        let found = evidence.fit(&gains).unwrap();
        let about = |state: &State| {
            fit(&problem, &problem.normal_equations(state, &parts), &parts, &all.lend(&problem, gains.families.clone()))
                .unwrap()
        };
        let largest = |fit: &Fit| {
            let of = |j: usize| problem.index(Place::Gain(j)).map_or(0.0, |i| fit.state[i].abs());
            (0..7).map(of).fold(0.0, f64::max)
        };
        let [own, again, brought_along] = [&found, &about(&found.state), &about(&all.state)].map(largest);
        println!("largest gain {own:.3}, about itself once more {again:.3}, about the fit of all {brought_along:.3}");
        assert!((again - own).abs() < 0.02, "{own} {again}");
        assert!(brought_along > own + 0.1, "{own} {brought_along}");
        let selection = select(&problem, &parts, &all);
        assert!(selection.selected.contains(&Family::Presliding), "{:?}", selection.selected);
        assert!(!selection.selected.contains(&Family::Gain), "{:?}", selection.selected);
    }
}
