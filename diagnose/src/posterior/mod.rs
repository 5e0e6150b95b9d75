//! Diagnosis of arms whose model is wrong everywhere, a little: physical priors, evidence, a posterior that is a model.

pub(crate) mod baseline;
pub(crate) mod body;
pub(crate) mod columns;
pub(crate) mod fit;
pub(crate) mod prior;
pub(crate) mod problem;
pub(crate) mod selection;
mod spd;
mod tempering;
