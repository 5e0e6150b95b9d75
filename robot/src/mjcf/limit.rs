//! Ranges that limit, and those that do not.

use super::MjcfError;
use super::compiler::Compiler;
use super::element::{Defaults, Element};

/// A range that limits; none where it does not.
pub(super) fn limited(
    element: Element<'_>,
    defaults: &Defaults<'_>,
    compiler: &Compiler,
    (switch, range): (&'static str, &'static str),
) -> Result<Option<[f64; 2]>, MjcfError> {
    let given = defaults.numbers(element, range, 2..=2)?.map(|numbers| [numbers[0], numbers[1]]);
    Ok(match defaults.text(element, switch) {
        Some("true") => given,
        Some("false") => None,
        _ => given.filter(|range| compiler.autolimits && *range != [0.0; 2]),
    })
}

/// The size that a range allows both ways; that of the longer side of one that begins at 0.
pub(super) fn largest_both_ways([low, high]: [f64; 2]) -> f64 {
    let (short, long) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
    if short > 0.0 { short } else { long }
}
