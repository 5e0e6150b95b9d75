//! The box that is searched.

use serde::{Deserialize, Serialize};

use crate::BayesoptError;

/// A box  `lower_i <= x_i <= upper_i`  with a name for each coordinate.
///
/// ```text
/// u_i = (x_i − lower_i) / (upper_i − lower_i)
/// ```
///
/// Points outside the crate are in real units; inside it everything lives on the unit cube.
/// Invariants: at least one coordinate, finite `lower < upper`, unique names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "RawDomain", into = "RawDomain")]
pub struct Domain {
    names: Vec<String>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// What a file may say before it is validated.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDomain {
    names: Vec<String>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl TryFrom<RawDomain> for Domain {
    type Error = BayesoptError;

    fn try_from(raw: RawDomain) -> Result<Self, BayesoptError> {
        Self::new(raw.names, raw.lower, raw.upper)
    }
}

impl From<Domain> for RawDomain {
    fn from(domain: Domain) -> Self {
        Self { names: domain.names, lower: domain.lower, upper: domain.upper }
    }
}

/// Part of a coordinate's width that is worth a search.
const LEAST_WIDTH: f64 = 1e-6;

impl Domain {
    /// The box `[lower, upper]`, validated.
    ///
    /// # Errors
    /// `EmptyDomain`, `BoundCount`, `BadBounds`, `DuplicateName`.
    pub fn new(names: Vec<String>, lower: Vec<f64>, upper: Vec<f64>) -> Result<Self, BayesoptError> {
        if names.is_empty() {
            return Err(BayesoptError::EmptyDomain);
        }
        if names.len() != lower.len() || names.len() != upper.len() {
            return Err(BayesoptError::BoundCount { names: names.len(), lower: lower.len(), upper: upper.len() });
        }
        for (i, name) in names.iter().enumerate() {
            let (lo, hi) = (lower[i], upper[i]);
            let ordered = lo.is_finite() && hi.is_finite() && lo < hi && (hi - lo).is_finite();
            if !ordered {
                return Err(BayesoptError::BadBounds { name: name.clone(), lower: lo, upper: hi });
            }
            if names[..i].contains(name) {
                return Err(BayesoptError::DuplicateName { name: name.clone() });
            }
        }
        Ok(Self { names, lower, upper })
    }

    /// The unit cube `[0, 1]^d` with coordinates `x0, x1, …`.
    ///
    /// # Errors
    /// `EmptyDomain` when `dimension` is zero.
    pub fn unit_cube(dimension: usize) -> Result<Self, BayesoptError> {
        let names = (0..dimension).map(|i| format!("x{i}")).collect();
        Self::new(names, vec![0.0; dimension], vec![1.0; dimension])
    }

    /// Number of coordinates d.
    pub fn dimension(&self) -> usize {
        self.names.len()
    }

    /// Names, in coordinate order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Lower bounds, real units.
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// Upper bounds, real units.
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The box up to `highest`; a coordinate that would be left without width keeps its own.
    #[must_use]
    pub fn up_to(&self, highest: &[f64]) -> Self {
        let mut part = self.clone();
        for (i, most) in highest.iter().enumerate().take(self.dimension()) {
            if *most < self.upper[i] && *most - self.lower[i] > LEAST_WIDTH * (self.upper[i] - self.lower[i]) {
                part.upper[i] = *most;
            }
        }
        part
    }

    /// `u = (x − lower)/(upper − lower)`, not clamped: a point told from outside the box stays outside.
    ///
    /// # Errors
    /// `DimensionMismatch`, `NonFiniteCoordinate`.
    pub fn to_unit(&self, point: &[f64]) -> Result<Vec<f64>, BayesoptError> {
        self.check(point)?;
        Ok((0..point.len()).map(|i| (point[i] - self.lower[i]) / (self.upper[i] - self.lower[i])).collect())
    }

    /// `x = lower + u (upper − lower)`, clamped to the box against rounding.
    ///
    /// # Errors
    /// `DimensionMismatch`, `NonFiniteCoordinate`.
    pub fn from_unit(&self, unit: &[f64]) -> Result<Vec<f64>, BayesoptError> {
        self.check(unit)?;
        let real = |i: usize| self.lower[i] + unit[i] * (self.upper[i] - self.lower[i]);
        Ok((0..unit.len()).map(|i| real(i).clamp(self.lower[i], self.upper[i])).collect())
    }

    fn check(&self, point: &[f64]) -> Result<(), BayesoptError> {
        if point.len() != self.dimension() {
            return Err(BayesoptError::DimensionMismatch { need: self.dimension(), got: point.len() });
        }
        match point.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(BayesoptError::NonFiniteCoordinate { index, value: point[index] }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(|name| name.to_string()).collect()
    }

    #[test]
    fn unit_and_real_coordinates_are_inverse() {
        let domain = Domain::new(names(&["a", "b"]), vec![-5.0, 0.1], vec![10.0, 0.2]).unwrap();
        let x = domain.from_unit(&[0.25, 1.0]).unwrap();
        assert_eq!(x, vec![-1.25, 0.2]);
        let u = domain.to_unit(&x).unwrap();
        assert!((u[0] - 0.25).abs() < 1e-15 && (u[1] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn every_invalid_box_is_named() {
        assert_eq!(Domain::unit_cube(0), Err(BayesoptError::EmptyDomain));
        assert!(matches!(
            Domain::new(names(&["a"]), vec![], vec![1.0]),
            Err(BayesoptError::BoundCount { names: 1, lower: 0, upper: 1 })
        ));
        for (lo, hi) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-1e308, 1e308)] {
            let got = Domain::new(names(&["a"]), vec![lo], vec![hi]);
            assert!(matches!(got, Err(BayesoptError::BadBounds { .. })), "[{lo}, {hi}]");
        }
        let twice = Domain::new(names(&["a", "a"]), vec![0.0; 2], vec![1.0; 2]);
        assert_eq!(twice, Err(BayesoptError::DuplicateName { name: "a".into() }));
    }

    #[test]
    fn points_of_wrong_shape_or_value_are_refused() {
        let domain = Domain::unit_cube(2).unwrap();
        assert_eq!(domain.to_unit(&[0.0]), Err(BayesoptError::DimensionMismatch { need: 2, got: 1 }));
        assert!(matches!(domain.from_unit(&[0.0, f64::NAN]), Err(BayesoptError::NonFiniteCoordinate { index: 1, .. })));
    }

    /// A coordinate that may go to a third of its box is searched as a whole box; one that may not move keeps its own.
    #[test]
    fn a_part_of_the_box_is_a_box() {
        let domain =
            Domain::new(vec!["a".into(), "b".into(), "c".into()], vec![1.0, 0.0, 0.0], vec![4.0, 2.0, 1.0]).unwrap();
        let part = domain.up_to(&[2.0, 0.0, 7.0]);
        assert_eq!((part.lower(), part.upper()), ([1.0, 0.0, 0.0].as_slice(), [2.0, 2.0, 1.0].as_slice()));
        assert_eq!(part.to_unit(&[1.5, 1.0, 0.5]).unwrap(), [0.5, 0.5, 0.5]);
        // A trial from beyond it stays where it was.
        assert_eq!(part.to_unit(&[4.0, 1.0, 0.5]).unwrap()[0], 3.0);
        assert_eq!(domain.up_to(domain.upper()), domain);
    }
}
