//! What the selection keeps: enough evidence, enough torque, a gain on unseen blocks, the likelier of two stories.

use tribo_regression::contact_window::residual;
use tribo_regression::evidence::joint_fit;
use tribo_regression::least_squares::inner;
use tribo_regression::{CauseLabel, Column, Location, rms};

use crate::confusable::same_by_physics;
use crate::held_out::{BlockSquares, HeldOut, gain_with_interval};
use crate::rivals::RIVAL_EVIDENCE;
use crate::search::{LEAST_EVIDENCE, Search};
use crate::significance::Chance;

/// Largest family-wise probability of chance for a finding.
pub(crate) const LARGEST_P: f64 = 0.01;
/// Least RMS of a finding's torque (Nm).
const LEAST_RMS_NM: f64 = 2.5e-3;
/// The same over the torque sensor's noise in the band.
const LEAST_OVER_NOISE: f64 = 0.25;

/// By how much the evidence of a link before the last must exceed that of a payload for the link to be told: a body at the flange is ten times as
/// common (2 log 10).
const AS_MUCH: f64 = 4.6;

/// Of two causes with the same torque by physics, tells the likelier story: a payload rather than a heavier last link, a
/// rotor rather than the first link, any other constant rather than friction with a preferred direction that is never seen.
pub(crate) fn prefer_likelier<const N: usize>(search: &mut Search<'_, '_, N>) {
    for place in 0..search.selected.len() {
        let group = search.selected[place];
        let own = search.place(group);
        let one_way = |joint: usize| search.system.data.moves_one_way(joint);
        let alike = |rival: usize| {
            let other = search.place(rival);
            let constant = matches!(other.0, CauseLabel::Coulomb | CauseLabel::TorqueOffset) && other.1 == own.1;
            match own {
                (CauseLabel::LinkInertial, _) => {
                    (same_by_physics::<N>(own, other) && other != own) || other.0 == CauseLabel::Payload
                }
                (CauseLabel::CoulombAsymmetry, Location::Joint(joint)) => constant && one_way(joint),
                _ => false,
            }
        };
        let others = search.others(group);
        let evidence = search.member_evidence(group);
        let likelier = standing_in(search, &others, alike).max_by(|a, b| a.1.total_cmp(&b.1));
        // Another link than the last gives way to a payload that explains nearly as much, and to nothing less.
        let needed = match likelier {
            Some((rival, _)) if same_by_physics::<N>(own, search.place(rival)) => RIVAL_EVIDENCE,
            Some(_) if own.0 == CauseLabel::LinkInertial => AS_MUCH,
            _ => RIVAL_EVIDENCE,
        };
        if let Some((rival, value)) = likelier
            && value > evidence - needed
        {
            search.selected[place] = rival;
        }
    }
}

/// Groups that might take a place beside the `others`, with their evidence there.
fn standing_in<'s, const N: usize>(
    search: &'s Search<'_, '_, N>,
    others: &'s [usize],
    eligible: impl Fn(usize) -> bool + 's,
) -> impl Iterator<Item = (usize, f64)> + 's {
    (0..search.system.groups.len())
        .filter(move |rival| eligible(*rival))
        .filter(|rival| !others.iter().any(|other| search.place(*other) == search.place(*rival)))
        .filter_map(|rival| Some((rival, search.evidence_given(others, rival)?.0)))
}

/// Drops what chance may explain.
pub(crate) fn drop_chance<const N: usize>(search: &mut Search<'_, '_, N>, chance: &Chance) {
    loop {
        match search.weakest() {
            Some((group, evidence)) if chance.p_value(evidence) > LARGEST_P => search.selected = search.others(group),
            _ => return,
        }
    }
}

/// Keeps the members of which this is true, given their columns and the coefficients of the joint fit.
fn keep<const N: usize>(
    search: &mut Search<'_, '_, N>,
    worth: impl Fn(&Search<'_, '_, N>, usize, &[Column<N>], &[f64]) -> bool,
) {
    let coefficients = joint_fit(search.system, &search.system.columns_of(&search.selected)).coefficients;
    let mut first = 0;
    let mut kept = Vec::new();
    for &group in &search.selected {
        let plain = search.system.plain_columns(group);
        let own = &coefficients[first..first + plain.len()];
        first += plain.len();
        if worth(search, group, &plain, own) {
            kept.push(group);
        }
    }
    search.selected = kept;
}

/// Drops what is too small to matter on every joint.
pub(crate) fn drop_small<const N: usize>(search: &mut Search<'_, '_, N>) {
    keep(search, |search, _, plain, own| {
        (0..N).any(|j| {
            let rms = torque_rms(plain, own, j);
            rms > LEAST_RMS_NM && rms > LEAST_OVER_NOISE * search.system.data.torque_floor_nm[j]
        })
    });
}

/// Part of a Stribeck finding's squared torque that may lie in rests.
const MOST_AT_REST: f64 = 0.8;

/// Drops Stribeck friction that acts while its joint is held: there friction is whatever keeps the joint still, and goes with its creep
/// as a law of velocity would.
pub(crate) fn drop_stiction<const N: usize>(search: &mut Search<'_, '_, N>) {
    keep(search, |search, group, plain, own| {
        let (CauseLabel::Stribeck, Location::Joint(joint)) = search.place(group) else { return true };
        let torque = torque_of(plain, own, joint);
        let squares = || torque.iter().map(|torque| torque * torque);
        let standing = search.system.data.standing(joint);
        let at_rest: f64 = squares().zip(standing).map(|(square, share)| square * share.clamp(0.0, 1.0)).sum();
        at_rest <= MOST_AT_REST * squares().sum::<f64>()
    });
}

/// Drops what does not help on blocks that its coefficients have not seen: on no joint, in no stretch where it acts; and what surely harms there, over all
/// its joints; `seed` draws the blocks of that interval.
pub(crate) fn drop_worthless<const N: usize>(search: &mut Search<'_, '_, N>, seed: u64) {
    loop {
        let system = &*search.system;
        let held_out = HeldOut::of(system, &search.selected);
        let residual = &system.data.residual_nm;
        let after = held_out.squares(residual);
        let rows = system.data.time_s.len().max(1) as f64;
        // What is left of a joint that has other secrets is structure too: a little of it goes with anything.
        let asked: [f64; N] = std::array::from_fn(|j| {
            let left_nm = (after.iter().map(|block| block[j]).sum::<f64>() / rows).sqrt();
            if left_nm <= SECRETIVE * system.data.noise_floor_nm[j] {
                LEAST_GAIN
            } else if left_nm <= MOST_LEFT * rms(&residual[j]) {
                LEAST_GAIN_OF_CRUMBS
            } else {
                LEAST_GAIN_OF_SECRETIVE
            }
        });
        let mut first = 0;
        let mut worst: Option<(usize, f64)> = None;
        for &group in &search.selected {
            let own = first..first + system.groups[group].columns.len();
            first = own.end;
            let without = held_out.squares_without(residual, own.clone());
            let acts = |block: usize, j: usize| {
                let range = held_out.blocks.ranges[block].clone();
                held_out.plain[own.clone()]
                    .iter()
                    .filter_map(|column| column.rows[j].as_ref())
                    .any(|x| x[range.clone()].iter().any(|x| *x != 0.0))
            };
            let of_any = if search.place(group).0 == CauseLabel::Unknown { LEAST_GAIN_OF_NAMELESS } else { 0.0 };
            let best = (0..N)
                .filter_map(|j| {
                    let touched: Vec<usize> =
                        (0..held_out.blocks.ranges.len()).filter(|block| acts(*block, j)).collect();
                    let sum = |squares: &BlockSquares<N>| touched.iter().map(|block| squares[*block][j]).sum::<f64>();
                    let gain = 1.0 - (sum(&after) / sum(&without).max(1e-300)).sqrt();
                    (!touched.is_empty()).then_some(gain / asked[j].max(of_any))
                })
                .fold(f64::NEG_INFINITY, f64::max);
            let (_, [_, most]) = gain_with_interval(&without, &after, &acting_on(&held_out.plain[own]), seed);
            if (best < 1.0 || most < 0.0) && worst.is_none_or(|(_, gain)| best < gain) {
                worst = Some((group, best));
            }
        }
        match worst {
            Some((group, _)) => search.selected = search.others(group),
            None => return,
        }
    }
}

/// Joints that any of some columns act on.
pub(crate) fn acting_on<const N: usize>(columns: &[Column<N>]) -> Vec<usize> {
    (0..N).filter(|j| columns.iter().any(|column| column.rows[*j].is_some())).collect()
}

/// A nameless cause must foretell unseen blocks better than every name: where named causes of the joint do as well in its
/// place, the one of most evidence stands. Nameless families bend to anything, and short logs let them.
pub(crate) fn prefer_names<const N: usize>(search: &mut Search<'_, '_, N>) {
    for place in 0..search.selected.len() {
        let group = search.selected[place];
        let (CauseLabel::Unknown, Location::Joint(joint)) = search.place(group) else { continue };
        let others = search.others(group);
        let left = unseen_square(search, &search.selected, joint);
        let names_of_joint = |rival: usize| {
            let (label, location) = search.place(rival);
            location == Location::Joint(joint) && label != CauseLabel::Unknown
        };
        let named = standing_in(search, &others, names_of_joint)
            .filter(|(rival, evidence)| {
                let company: Vec<usize> = others.iter().copied().chain([*rival]).collect();
                *evidence > LEAST_EVIDENCE && unseen_square(search, &company, joint) <= left
            })
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((rival, _)) = named {
            search.selected[place] = search.refined(rival, &others);
        }
    }
}

/// Residual square of a joint (Nm²) on blocks that the coefficients of these groups have not seen.
fn unseen_square<const N: usize>(search: &Search<'_, '_, N>, groups: &[usize], joint: usize) -> f64 {
    let squares = HeldOut::of(search.system, groups).squares(&search.system.data.residual_nm);
    squares.iter().map(|block| block[joint]).sum()
}

/// Drops pushes that one joint alone tells of: a wrench on the tool loads several, a jump of dry friction one.
pub(crate) fn drop_lonely_pushes<const N: usize>(search: &mut Search<'_, '_, N>) {
    loop {
        let is_push = |group: &usize| search.place(*group).0 == CauseLabel::ExternalContact;
        let pushes: Vec<usize> = search.selected.iter().copied().filter(is_push).collect();
        if pushes.is_empty() {
            return;
        }
        let squares = |groups: &[usize]| -> [f64; N] {
            let left = residual(search.system, &search.system.columns_of(groups));
            left.rows.map(|row| row.map_or(0.0, |row| inner(&row, &row)))
        };
        let with = squares(&search.selected);
        let lonely = pushes.into_iter().find(|group| {
            let without = squares(&search.others(*group));
            let gains: Vec<f64> = (0..N).map(|j| (without[j] - with[j]).max(0.0)).collect();
            let (largest, sum) = (gains.iter().copied().fold(0.0, f64::max), gains.iter().sum::<f64>());
            largest > LONELY * sum && sum < CONVINCING
        });
        match lonely {
            Some(group) => search.selected = search.others(group),
            None => return,
        }
    }
}

/// Part of what a push explains from which on one joint tells it alone.
const LONELY: f64 = 0.85;
/// Whitened squares that a push may explain on one joint alone all the same.
const CONVINCING: f64 = 1500.0;

/// Held-out gain on its best joint that a finding must have.
pub(crate) const LEAST_GAIN: f64 = 0.015;
/// The same of a cause without a name, which has to tell the user something.
const LEAST_GAIN_OF_NAMELESS: f64 = 0.05;
/// Residual left over sensor noise beyond which a joint keeps secrets from every cause considered.
const SECRETIVE: f64 = 3.0;
/// Held-out gain that a finding must have on such a joint.
const LEAST_GAIN_OF_SECRETIVE: f64 = 0.15;
/// Part of a joint's residual up to which its secrets are crumbs, most of it being understood.
const MOST_LEFT: f64 = 0.3;
/// Held-out gain that a finding must have there.
const LEAST_GAIN_OF_CRUMBS: f64 = 0.05;

/// A named cause on a joint where a nameless one explains more is part of what has no name.
pub(crate) fn yield_to_unknown<const N: usize>(search: &mut Search<'_, '_, N>) {
    let strength: Vec<(usize, CauseLabel, Location, f64)> = search
        .selected
        .iter()
        .map(|g| (*g, search.place(*g).0, search.place(*g).1, search.member_evidence(*g)))
        .collect();
    search.selected.retain(|group| {
        let Some((_, label, location, own)) = strength.iter().find(|entry| entry.0 == *group) else { return false };
        *label == CauseLabel::Unknown
            || !strength
                .iter()
                .any(|(_, other, place, evidence)| *other == CauseLabel::Unknown && place == location && evidence > own)
    });
}

pub(crate) fn torque_rms<const N: usize>(plain: &[Column<N>], coefficients: &[f64], joint: usize) -> f64 {
    let rows = torque_of(plain, coefficients, joint);
    let acting = |k: &usize| plain.iter().any(|column| column.rows[joint].as_ref().is_some_and(|x| x[*k] != 0.0));
    let count = (0..rows.len()).filter(acting).count();
    let sum: f64 = rows.iter().map(|torque| torque * torque).sum();
    (sum / count.max(1) as f64).sqrt()
}

/// Torque of a finding on a joint (Nm), sample by sample; empty where it does not act on the joint.
fn torque_of<const N: usize>(plain: &[Column<N>], coefficients: &[f64], joint: usize) -> Vec<f64> {
    let rows = plain.iter().find_map(|column| column.rows[joint].as_ref()).map_or(0, |row| row.len());
    let at = |k: usize| {
        plain.iter().zip(coefficients).filter_map(|(column, c)| Some(column.rows[joint].as_ref()?[k] * c)).sum()
    };
    (0..rows).map(at).collect()
}
