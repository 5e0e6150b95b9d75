//! The window driven without a display: one programme, so that it is built once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;
mod flows;
mod reading;
mod watching;
