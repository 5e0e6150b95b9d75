//! Stories across crates; see `integration/` and `no_alloc/`.
