//! Stories across crates.

mod dynamics_identities;
mod dynamics_reference;
