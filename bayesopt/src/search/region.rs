//! Where the acquisition is maximised.

use super::projected_lbfgs::Bounds;
use crate::{Allowed, Domain};

/// Bounds in unit coordinates, and what of them is allowed.
#[derive(Debug)]
pub struct Region<'a> {
    /// The box.
    bounds: Bounds,
    /// The limit inside it, with the domain whose real units it speaks.
    limit: Option<(&'a Domain, &'a dyn Allowed)>,
}

impl<'a> Region<'a> {
    /// The whole box.
    pub fn of(bounds: Bounds) -> Self {
        Self { bounds, limit: None }
    }

    /// What is allowed of the box.
    pub fn within(mut bounds: Bounds, domain: &'a Domain, allowed: &'a dyn Allowed) -> Self {
        let highest = allowed.highest().iter().zip(domain.lower().iter().zip(domain.upper()));
        let reach = highest.map(|(most, (lower, upper))| ((most - lower) / (upper - lower)).clamp(0.0, 1.0));
        for ((lower, upper), reach) in bounds.lower.iter_mut().zip(&mut bounds.upper).zip(reach) {
            *upper = upper.min(reach);
            *lower = lower.min(*upper);
        }
        Self { bounds, limit: Some((domain, allowed)) }
    }

    /// The box around what is allowed.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Moves a point into the box and to what is allowed; whether the limit moved it.
    pub fn project(&self, x: &mut [f64]) -> bool {
        self.bounds.project(x);
        let Some((domain, allowed)) = self.limit else { return false };
        let mut real = domain.from_unit(x).unwrap_or_default();
        let before = real.clone();
        allowed.hold_back(&mut real);
        let mut moved = false;
        for (i, x) in x.iter_mut().enumerate().filter(|(i, _)| real.get(*i) != before.get(*i)) {
            let (lower, upper) = (domain.lower()[i], domain.upper()[i]);
            *x = ((real[i] - lower) / (upper - lower)).clamp(0.0, 1.0);
            moved = true;
        }
        moved
    }
}
