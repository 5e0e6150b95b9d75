//! Things that belong to an arm, by its number of joints.

/// What an arm of six joints has, or what one of seven has: the one place where a number of joints becomes a type.
#[derive(Clone, Debug, PartialEq)]
pub enum ByJoints<A, B> {
    /// Of an arm with six joints.
    Six(A),
    /// Of an arm with seven joints.
    Seven(B),
}
