//! Causes that would do as well.

use tribo_regression::CauseLabel;
use tribo_regression::evidence::Conditional;

use crate::confusable::why;
use crate::diagnosis::Alternative;
use crate::search::{LEAST_EVIDENCE, Search};

/// Evidence within which a rival cannot be excluded.
pub(crate) const RIVAL_EVIDENCE: f64 = 10.0;
/// Rivals whose shapes are refined.
const REFINED_RIVALS: usize = 4;

/// Causes that would do as well in the place of a member.
pub(crate) fn rivals<const N: usize>(search: &mut Search<'_, '_, N>, group: usize, evidence: f64) -> Vec<Alternative> {
    let others = search.others(group);
    let taken: Vec<_> = others.iter().map(|g| search.place(*g)).collect();
    let own = search.place(group);
    let mut best: Vec<(usize, f64)> = Vec::new();
    {
        let given = Conditional::on(search.system, &search.system.columns_of(&others));
        for rival in 0..search.system.groups.len() {
            let place = search.place(rival);
            let nameless = place.0 == CauseLabel::Unknown;
            if place == own || taken.contains(&place) || nameless || place.0 == CauseLabel::ExternalContact {
                continue;
            }
            let Some((value, _)) = search.evidence(&given, rival) else { continue };
            match best.iter_mut().find(|(other, _)| search.place(*other) == place) {
                Some(entry) if value > entry.1 => *entry = (rival, value),
                Some(_) => {}
                None => best.push((rival, value)),
            }
        }
    }
    best.sort_by(|a, b| b.1.total_cmp(&a.1));
    best.truncate(REFINED_RIVALS);
    let mut rivals = Vec::new();
    for (rival, coarse) in best {
        if coarse < LEAST_EVIDENCE || coarse < 0.5 * evidence {
            continue;
        }
        let refined = search.refined(rival, &others);
        let value = search.evidence_given(&others, refined).map_or(coarse, |(value, _)| value);
        if value > evidence - RIVAL_EVIDENCE {
            let (label, location) = search.place(refined);
            rivals.push(Alternative {
                label,
                location,
                evidence_gap: (evidence - value).max(0.0),
                why: why(own.0, label),
            });
        }
    }
    rivals.sort_by(|a, b| a.evidence_gap.total_cmp(&b.evidence_gap));
    rivals
}
