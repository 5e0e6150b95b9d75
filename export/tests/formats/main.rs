//! Exports against the programs that read them: one programme, so that it is built once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod bounds;
mod common;
mod descriptions;
mod parameters;
mod sources;
