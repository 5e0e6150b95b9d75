//! Diagnosis of arms whose model is wrong everywhere, a little: the posterior over families of causes, in words and in effects.

pub(crate) mod explain;
mod family_finding;
mod further;
pub(crate) mod gate;
