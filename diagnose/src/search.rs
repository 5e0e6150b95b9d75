//! Forward–backward selection of causes.
//!
//! ```text
//! evidence(g | S) = ΔSS / λ − (columns + shapes) log n − 2 log(causes)
//! ```
//!
//! An extended BIC on whitened data; λ is how much left-over correlation inflates chance (see [`crate::significance`]).
//! Start empty; add the best group; refine shapes; swap, delete and consolidate until nothing improves.

use std::collections::BTreeSet;
use std::sync::Arc;

use rayon::prelude::*;
use tribo_regression::cause::{Candidate, ExternalContact};
use tribo_regression::contact_window::{best_window, sharpened};
use tribo_regression::evidence::{Conditional, Selection, gain_given};
use tribo_regression::least_squares::Gain;
use tribo_regression::{CauseLabel, Location, System, golden_section};

/// Time that two windows share over the time of either from which on they are one push.
const SAME_PUSH: f64 = 0.5;
/// Evidence that a cause must add.
pub(crate) const LEAST_EVIDENCE: f64 = 10.0;
/// Evidence below which a selected cause is deleted again.
const KEEP_EVIDENCE: f64 = 5.0;
/// Evidence by which a swap must be better.
const SWAP_EVIDENCE: f64 = 2.0;
/// Handicap of causes without a name.
const UNKNOWN_HANDICAP: f64 = 20.0;
/// Part of what they explain that does not count: they bend to anything.
const UNKNOWN_DISCOUNT: f64 = 0.05;
/// Part of the whitened variance of a joint that a cause must explain: below it a statistical effect is no finding.
const LEAST_SHARE: f64 = 0.004;
/// Additions that come to nothing before the search ends.
const MOST_FRUITLESS: usize = 3;
/// Nats against friction with a preferred direction where rests do not tell: a sensor's offset is far commoner.
const RARE: f64 = 3.0;
/// The same elsewhere: a joint that moves one way only does not tell it from Coulomb friction.
const SELDOM: f64 = 2.0;
/// Most causes of one log.
const MOST_CAUSES: usize = 30;
/// Rounds of improvement after each addition.
const ROUNDS: usize = 4;
/// Evaluations of a shape refinement.
const REFINEMENTS: usize = 12;

/// How many joints have causes of their own, and of how many kinds all causes are.
pub(crate) fn joints_and_kinds(places: &[(CauseLabel, Location)]) -> (usize, usize) {
    let joint = |(_, location): &(CauseLabel, Location)| match location {
        Location::Joint(joint) => Some(*joint),
        _ => None,
    };
    let joints: BTreeSet<usize> = places.iter().filter_map(joint).collect();
    let kinds: BTreeSet<CauseLabel> = places.iter().map(|(label, _)| *label).collect();
    (joints.len(), kinds.len())
}

/// The state of the search.
pub(crate) struct Search<'s, 'a, const N: usize> {
    pub system: &'s mut System<'a, N>,
    /// Selected groups.
    pub selected: Vec<usize>,
    /// Inflation λ of chance evidence.
    pub inflation: f64,
    /// Number of distinct causes.
    pub causes: usize,
    /// Whether to ask again what the nameless members are worth, which takes most of the time; a first colour does without.
    pub thorough: bool,
    /// Pushes whose edges are where they belong, whatever else is selected.
    sharp: BTreeSet<usize>,
    /// Whether causes without a name may be added.
    pub nameless: bool,
    /// Kinds of causes in most joints beyond which the search gives up; `None` where it never does.
    pub most_kinds: Option<usize>,
    /// Whether it has.
    pub gave_up: bool,
}

impl<'s, 'a, const N: usize> Search<'s, 'a, N> {
    /// An empty selection.
    pub fn new(system: &'s mut System<'a, N>, inflation: f64) -> Self {
        let mut distinct: Vec<(CauseLabel, Location)> =
            system.groups.iter().map(|group| (group.candidate.label(), group.candidate.location())).collect();
        distinct.sort_unstable();
        distinct.dedup();
        let causes = distinct.len().max(1);
        let (thorough, nameless, most_kinds, gave_up) = (true, true, None, false);
        Self {
            system,
            selected: Vec::new(),
            inflation,
            causes,
            sharp: BTreeSet::new(),
            thorough,
            nameless,
            most_kinds,
            gave_up,
        }
    }

    /// Price of a group.
    pub fn price(&self, group: usize, gain: &Gain) -> f64 {
        let group = &self.system.groups[group];
        let mut shapes = group.shape.len();
        let mut places = self.causes as f64;
        if group.candidate.label() == CauseLabel::ExternalContact {
            // Two edges, each on any sample.
            shapes = 2;
            places *= self.system.joint_rows as f64;
        }
        let n = (self.system.rows as f64).max(2.0);
        let handicap = match group.candidate.label() {
            CauseLabel::Unknown => UNKNOWN_HANDICAP + UNKNOWN_DISCOUNT * gain.explained / self.inflation,
            CauseLabel::CoulombAsymmetry => match group.candidate.location() {
                Location::Joint(j) if self.system.stuck[j] => RARE,
                _ => SELDOM,
            },
            _ => 0.0,
        };
        (gain.directions + shapes) as f64 * n.ln() + 2.0 * places.ln() + handicap
    }

    /// Evidence of a group given projected-out columns, and its coefficients; `None` where physics forbids it.
    pub fn evidence(&self, given: &Conditional, group: usize) -> Option<(f64, Gain)> {
        let columns: Vec<usize> = self.system.groups[group].columns.clone().collect();
        self.judged(group, given.gain(self.system, &columns))
    }

    /// The same given other groups, for a single question.
    pub fn evidence_given(&self, others: &[usize], group: usize) -> Option<(f64, Gain)> {
        let columns: Vec<usize> = self.system.groups[group].columns.clone().collect();
        self.judged(group, gain_given(self.system, &columns, &self.system.columns_of(others)))
    }

    /// Evidence of a group given the members of the selection but itself; −∞ where physics forbids it.
    pub fn member_evidence(&self, group: usize) -> f64 {
        self.evidence_given(&self.others(group), group).map_or(f64::NEG_INFINITY, |(evidence, _)| evidence)
    }

    /// The member of least evidence given the others.
    pub fn weakest(&self) -> Option<(usize, f64)> {
        let judged = self.selected.iter().map(|group| (*group, self.member_evidence(*group)));
        judged.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn judged(&self, group: usize, gain: Gain) -> Option<(f64, Gain)> {
        let Self { system, .. } = self;
        let columns = system.groups[group].columns.clone();
        let affected = (0..N).filter(|j| columns.clone().any(|c| system.columns[c].rows[*j].is_some())).count();
        // An effect on many joints need not be large on all of them.
        let rows = (system.joint_rows * affected.clamp(1, 2)) as f64;
        let candidate = &system.groups[group].candidate;
        let allowed = gain.directions > 0
            && gain.explained > LEAST_SHARE * rows
            && candidate.admissible(system.data, &system.groups[group].shape, &gain.coefficients);
        allowed.then(|| (gain.explained / self.inflation - self.price(group, &gain), gain))
    }

    /// The selection without one member.
    pub fn others(&self, but: usize) -> Vec<usize> {
        self.selected.iter().copied().filter(|group| *group != but).collect()
    }

    /// Runs to the end; `go_on` false stops it.
    pub fn run(&mut self, go_on: &dyn Fn() -> bool) -> bool {
        let mut fruitless: Vec<(CauseLabel, Location)> = Vec::new();
        loop {
            if !self.add(&mut fruitless, go_on) {
                return false;
            }
            if self.gave_up {
                return true;
            }
            // What was done without is not asked again: it would come back for what little it is worth, and so on for ever.
            let Some(place) = self.do_without_unknown() else { break };
            fruitless.push(place);
            self.improve();
        }
        // Shapes against each other, once the company is known.
        if self.reshape() {
            self.improve();
        }
        true
    }

    /// Adds what has a name and is worth it once the nameless has been pruned, which may have stood in its way; `go_on`
    /// false stops it.
    pub fn fill_with_names(&mut self, go_on: &dyn Fn() -> bool) -> bool {
        self.nameless = false;
        self.add(&mut Vec::new(), go_on)
    }

    /// Additions until none is worth it; `go_on` false stops it.
    fn add(&mut self, fruitless: &mut Vec<(CauseLabel, Location)>, go_on: &dyn Fn() -> bool) -> bool {
        let most_fruitless = if self.thorough { MOST_FRUITLESS } else { 1 };
        while self.selected.len() < MOST_CAUSES && fruitless.len() <= most_fruitless {
            if !go_on() {
                return false;
            }
            let Some((group, evidence)) = self.best_addition(fruitless) else { break };
            if evidence < LEAST_EVIDENCE {
                break;
            }
            let group = self.refined(group, &self.selected.clone());
            let before = (self.selected.clone(), self.total(&self.selected));
            self.selected.push(group);
            // Swaps ask member by member, and now and then lose what the whole had.
            let plain = (self.selected.clone(), self.total(&self.selected));
            self.improve();
            if self.total(&self.selected) < plain.1 {
                self.selected = plain.0;
            }
            if self.total(&self.selected) <= before.1 {
                // The addition was undone, or bought nothing: more of the same would go round in circles.
                self.selected = before.0;
                fruitless.push(self.place(group));
            }
            self.gave_up = self.most_kinds.is_some_and(|most| self.is_everywhere(most));
            if self.gave_up {
                break;
            }
        }
        true
    }

    /// Whether more than half of the joints have named causes of their own, two per joint of the arm and more in all, of more than `most` kinds:
    /// fewer may still become one cause that stands for many, and what has no name is only asked for one later.
    fn is_everywhere(&self, most: usize) -> bool {
        let mut places: Vec<(CauseLabel, Location)> = self.selected.iter().map(|group| self.place(*group)).collect();
        places.retain(|(label, _)| *label != CauseLabel::Unknown);
        let (joints, kinds) = joints_and_kinds(&places);
        2 * joints > N && places.len() > 2 * N && kinds > most
    }

    /// The group of most evidence given the selection; a contact window is searched for on the way.
    fn best_addition(&mut self, fruitless: &[(CauseLabel, Location)]) -> Option<(usize, f64)> {
        let selected = self.selected.clone();
        let columns = self.system.columns_of(&selected);
        if let Some(window) = best_window(self.system, &columns) {
            let contact: Arc<dyn Candidate<N>> = Arc::new(ExternalContact { log: Some(window.log) });
            let shape = vec![window.start_s, window.end_s];
            let evaluated = self.system.evaluate(contact.as_ref(), &shape);
            self.system.push(contact, shape, evaluated);
        }
        self.best_of(&Conditional::on(self.system, &columns), &selected, fruitless)
    }

    /// Whether a push is one of the selected over again: two that share most of their time are one, whose edges are no steps.
    fn repeats_a_push(&self, group: usize, selected: &[usize]) -> bool {
        let window = |group: usize| match (self.place(group).0, &self.system.groups[group].shape[..]) {
            (CauseLabel::ExternalContact, [start_s, end_s]) => Some([*start_s, *end_s]),
            _ => None,
        };
        let log = |group: usize| self.system.groups[group].candidate.log();
        let Some([start_s, end_s]) = window(group) else { return false };
        selected.iter().filter(|other| log(**other) == log(group)).filter_map(|other| window(*other)).any(|other| {
            let shared_s = end_s.min(other[1]) - start_s.max(other[0]);
            let either_s = end_s.max(other[1]) - start_s.min(other[0]);
            shared_s > SAME_PUSH * either_s
        })
    }

    fn best_of(
        &self,
        given: &Conditional,
        selected: &[usize],
        fruitless: &[(CauseLabel, Location)],
    ) -> Option<(usize, f64)> {
        let taken: Vec<(CauseLabel, Location)> = selected
            .iter()
            .map(|g| self.place(*g))
            .filter(|(label, _)| !matches!(label, CauseLabel::ExternalContact | CauseLabel::Unknown))
            .chain(fruitless.iter().copied())
            .collect();
        (0..self.system.groups.len())
            .into_par_iter()
            .filter(|group| !selected.contains(group) && !taken.contains(&self.place(*group)))
            .filter(|group| self.nameless || self.place(*group).0 != CauseLabel::Unknown)
            .filter(|group| !self.repeats_a_push(*group, selected))
            .filter_map(|group| self.evidence(given, group).map(|(evidence, _)| (group, evidence)))
            .reduce_with(|a, b| if (b.1, a.0) > (a.1, b.0) { b } else { a })
    }

    /// Label and location of a group.
    pub fn place(&self, group: usize) -> (CauseLabel, Location) {
        let candidate = &self.system.groups[group].candidate;
        (candidate.label(), candidate.location())
    }

    /// The same cause at its best shape, given the others.
    pub fn refined(&mut self, group: usize, others: &[usize]) -> usize {
        if self.sharp.contains(&group) {
            return group;
        }
        let candidate = self.system.groups[group].candidate.clone();
        let others: Vec<usize> = others.iter().copied().filter(|other| *other != group).collect();
        let columns = self.system.columns_of(&others);
        let mut best_shape = self.system.groups[group].shape.clone();
        let Some((_, first)) = self.evidence_given(&others, group) else { return group };
        let mut best = first.explained;
        let start_shape = best_shape.clone();
        if let (CauseLabel::ExternalContact, [start_s, end_s]) = (candidate.label(), &best_shape[..]) {
            best_shape = sharpened(self.system, candidate.as_ref(), [*start_s, *end_s], &columns).to_vec();
        }

        if let Some([low, high]) = candidate.profile() {
            // Golden section on a logarithmic scale, between the neighbours on the grid.
            let step = (high / low).ln() / 6.0;
            let centre = best_shape[0].ln();
            let between = [(centre - step).max(low.ln()), (centre + step).min(high.ln())];
            golden_section(between, 0.01, REFINEMENTS - 2, &mut |x| {
                let gain = self.free_gain(candidate.as_ref(), &[x.exp()], &columns);
                if gain.explained > best {
                    best = gain.explained;
                    best_shape = vec![x.exp()];
                }
                gain.explained
            });
        } else {
            let mut gain = first;
            for _ in 0..6 {
                let Some(shape) = candidate.fixed_point(&best_shape, &gain.coefficients) else { break };
                let next = self.free_gain(candidate.as_ref(), &shape, &columns);
                if next.directions == 0 {
                    break;
                }
                let settled = (shape[0] / best_shape[0] - 1.0).abs() < 1e-3;
                best_shape = shape;
                gain = next;
                if settled {
                    break;
                }
            }
        }
        let is_push = candidate.label() == CauseLabel::ExternalContact;
        let best = if best_shape == start_shape {
            group
        } else {
            let evaluated = self.system.evaluate(candidate.as_ref(), &best_shape);
            self.system.push(candidate, best_shape, evaluated)
        };
        if is_push {
            self.sharp.insert(best);
        }
        best
    }

    /// What a candidate at any shape explains beyond the given columns.
    fn free_gain(&self, candidate: &dyn Candidate<N>, shape: &[f64], given: &[usize]) -> Gain {
        let columns = self.system.evaluate(candidate, shape);
        tribo_regression::evidence::free_gain(self.system, &columns, given)
    }

    /// Swaps, deletions and consolidations until nothing improves.
    fn improve(&mut self) {
        for _ in 0..ROUNDS {
            let mut changed = self.swap();
            changed |= self.delete();
            changed |= self.consolidate();
            if !changed {
                break;
            }
        }
    }

    /// Refines the shapes of all members against each other.
    fn reshape(&mut self) -> bool {
        let mut changed = false;
        for place in 0..self.selected.len() {
            let group = self.selected[place];
            let others = self.others(group);
            let refined = self.refined(group, &others);
            if refined != group {
                self.selected[place] = refined;
                changed = true;
            }
        }
        changed
    }

    fn swap(&mut self) -> bool {
        let mut changed = false;
        let mut from = 0;
        // All members are judged at once; what follows a swap is judged anew.
        while let Some(place) = self.first_swap(from) {
            changed = true;
            from = place + 1;
        }
        changed
    }

    /// Where the columns of the member at `place` stand among those of the selection.
    fn places_of(&self, place: usize) -> std::ops::Range<usize> {
        let columns = |group: &usize| self.system.groups[*group].columns.len();
        let first = self.selected[..place].iter().map(columns).sum();
        first..first + columns(&self.selected[place])
    }

    /// Swaps the first member at or after `from` that a rival outdoes; its place.
    fn first_swap(&mut self, from: usize) -> Option<usize> {
        let whole = Selection::of(self.system, &self.system.columns_of(&self.selected));
        let judged: Vec<(f64, Option<(usize, f64)>)> = (from..self.selected.len())
            .into_par_iter()
            .map(|place| {
                let group = self.selected[place];
                let others = self.others(group);
                let given = whole
                    .without(self.places_of(place))
                    .unwrap_or_else(|| Conditional::on(self.system, &self.system.columns_of(&others)));
                let current = self.evidence(&given, group).map_or(f64::NEG_INFINITY, |(evidence, _)| evidence);
                (current, self.best_of(&given, &others, &[]))
            })
            .collect();
        for (place, (current, rival)) in (from..self.selected.len()).zip(judged) {
            let group = self.selected[place];
            let Some((rival, evidence)) = rival.filter(|(rival, _)| *rival != group) else { continue };
            let others = self.others(group);
            if evidence > current - LEAST_EVIDENCE && self.place(rival) != self.place(group) {
                // The rival stands on the grid; the member has been refined.
                let rival = self.refined(rival, &others);
                let evidence = self.evidence_given(&others, rival).map_or(f64::NEG_INFINITY, |(evidence, _)| evidence);
                if evidence > current + SWAP_EVIDENCE {
                    self.selected[place] = rival;
                    return Some(place);
                }
            } else if evidence > current + SWAP_EVIDENCE {
                self.selected[place] = self.refined(rival, &others);
                return Some(place);
            }
        }
        None
    }

    fn delete(&mut self) -> bool {
        let mut changed = false;
        loop {
            match self.weakest() {
                Some((group, evidence)) if evidence < KEEP_EVIDENCE => {
                    self.selected = self.others(group);
                    changed = true;
                }
                _ => return changed,
            }
        }
    }

    /// One cause of the whole arm in place of several of single joints.
    fn consolidate(&mut self) -> bool {
        if self.selected.len() < 2 {
            return false;
        }
        let now = self.total(&self.selected);
        let global: Vec<usize> = (0..self.system.groups.len())
            .filter(|g| {
                let (label, location) = self.place(*g);
                !matches!(location, Location::Joint(_)) && label != CauseLabel::ExternalContact
            })
            .filter(|g| !self.selected.iter().any(|s| self.place(*s) == self.place(*g)))
            .collect();
        let best = global
            .into_par_iter()
            .filter_map(|g| {
                let mut trial = self.selected.clone();
                trial.push(g);
                self.evidence_given(&self.selected, g)?;
                let mut total = self.total(&trial);
                loop {
                    let shorter = trial
                        .iter()
                        .filter(|member| **member != g)
                        .map(|member| {
                            let rest: Vec<usize> = trial.iter().copied().filter(|other| other != member).collect();
                            (self.total(&rest), rest)
                        })
                        .max_by(|a, b| a.0.total_cmp(&b.0));
                    match shorter {
                        Some((value, rest)) if value > total => (total, trial) = (value, rest),
                        _ => break,
                    }
                }
                (total > now + SWAP_EVIDENCE && trial.len() <= self.selected.len()).then_some((total, g, trial))
            })
            .reduce_with(|a, b| if b.0 > a.0 { b } else { a });
        match best {
            Some((_, _, trial)) => {
                self.selected = trial;
                true
            }
            None => false,
        }
    }

    /// Drops a nameless cause if the named ones, refined without it, do as well: it may have bent their shapes. Its place, if there is one.
    fn do_without_unknown(&mut self) -> Option<(CauseLabel, Location)> {
        if !self.thorough {
            return None;
        }
        let nameless: Vec<usize> =
            self.selected.iter().copied().filter(|group| self.place(*group).0 == CauseLabel::Unknown).collect();
        for group in nameless {
            let before = (self.selected.clone(), self.total(&self.selected));
            self.selected = self.others(group);
            self.reshape();
            self.reshape();
            if self.total(&self.selected) > before.1 - SWAP_EVIDENCE {
                return Some(self.place(group));
            }
            self.selected = before.0;
        }
        None
    }

    /// Penalised evidence of a whole selection.
    fn total(&self, selected: &[usize]) -> f64 {
        let given = tribo_regression::evidence::explained_by(self.system, &self.system.columns_of(selected));
        let prices: f64 = selected
            .iter()
            .map(|g| {
                let directions = self.system.groups[*g].columns.len();
                self.price(*g, &Gain { explained: 0.0, directions, coefficients: Vec::new() })
            })
            .sum();
        given / self.inflation - prices
    }
}
