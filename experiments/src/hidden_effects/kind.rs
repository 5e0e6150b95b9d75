//! What a case hides.

use std::fmt;

use tribo_regression::CauseLabel;

/// RMS of the hidden torque over the torque noise in the band, on the joint where that is largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Strength {
    /// 0.5 to 1.
    Weak,
    /// 1 to 3.
    Medium,
    /// 3 to 10.
    Strong,
    /// 12 to 40: no round of seeds has it.
    Plain,
}

impl Strength {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Weak, Self::Medium, Self::Strong, Self::Plain];
    /// Those of a round of seeds.
    pub const ROUND: [Self; 3] = [Self::Weak, Self::Medium, Self::Strong];

    /// Least and largest ratio [-].
    pub fn range(self) -> [f64; 2] {
        match self {
            Self::Weak => [0.5, 1.0],
            Self::Medium => [1.0, 3.0],
            Self::Strong => [3.0, 10.0],
            Self::Plain => [12.0, 40.0],
        }
    }

    /// Name in files: `weak`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Weak => "weak",
            Self::Medium => "medium",
            Self::Strong => "strong",
            Self::Plain => "plain",
        }
    }
}

/// Kind of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One cause.
    Single(CauseLabel, Strength),
    /// Two different causes, on different joints or one of them on the whole arm; each medium or strong.
    Pair,
    /// Three of them.
    Triple,
    /// The nominal model is the truth.
    Null,
    /// A torque that no cause of the vocabulary describes.
    OutsideVocabulary,
}

impl Kind {
    /// Every cause that a case may hide: the vocabulary without `unknown` and without bent friction, which is a family's.
    pub fn causes() -> impl Iterator<Item = CauseLabel> {
        CauseLabel::ALL.into_iter().filter(|label| !matches!(label, CauseLabel::FrictionCurve | CauseLabel::Unknown))
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Single(label, strength) => write!(f, "{label}/{}", strength.name()),
            Self::Pair => f.write_str("pair"),
            Self::Triple => f.write_str("triple"),
            Self::Null => f.write_str("null"),
            Self::OutsideVocabulary => f.write_str("outside"),
        }
    }
}
