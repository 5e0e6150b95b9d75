//! Campaigns whose trials the user runs: ask for parameters, tell what came of them.

mod documents;
mod friction_work;
mod judge_error;
mod judged_log;
mod learnt;
mod logged_compensation;
mod recognised_trial;
mod trial_remarks;
mod user_campaign;
mod user_trials;

pub use judge_error::JudgeError;
pub use judged_log::{JudgedLog, judge_log};
pub use learnt::Learnt;
pub use recognised_trial::{RecognisedTrial, recognise_trial};
pub use user_campaign::{Asked, Told, UserCampaign};
pub use user_trials::{SentTorque, UserTrials};
