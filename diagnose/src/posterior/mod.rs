//! Diagnosis of arms whose model is wrong everywhere, a little: physical priors, evidence, a posterior that is a model.

mod arm_scale;
pub(crate) mod band;
pub(crate) mod baseline;
pub(crate) mod body;
pub(crate) mod columns;
pub(crate) mod explain;
pub(crate) mod family_finding;
mod faster;
pub(crate) mod fit;
mod further;
pub(crate) mod gate;
mod joint_columns;
pub(crate) mod joint_term;
mod motion;
pub(crate) mod prior;
pub(crate) mod problem;
pub(crate) mod selection;
pub(crate) mod sign_width;
mod simulated;
mod spd;
pub(crate) mod split;
mod standstill;
pub(crate) mod sticking;
mod tempering;
pub(crate) mod unseen;
pub(crate) mod written;
