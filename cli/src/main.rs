//! The `tribo` command.
fn main() {}
