//! What `ask` and `tell` have to say, for programs.

use serde_json::{Map, Value, json};

use super::{Asked, JudgedLog, Learnt, Told, UserCampaign};
use crate::CampaignError;
use crate::strategy::LawCheck;

impl<const N: usize> UserCampaign<N> {
    /// The document of `tribo ask --json`, `tribo.ask/1`.
    pub fn ask_document(&self, asked: &Asked) -> Value {
        json!({
            "schema": "tribo.ask/1",
            "trial": asked.number,
            "origin": asked.origin,
            "params": self.tune().space.nested(&asked.theta),
            "compensator": asked.file,
            "beyond_box": self.beyond_box(),
            "running": self.running(),
        })
    }

    /// The document of `tribo tell --json`, `tribo.tell/1`, about a trial that has come back, with the log that was judged, if there was one,
    /// and why it failed, if it did.
    ///
    /// # Errors
    /// A log of the campaign that cannot be read.
    pub fn tell_document(
        &self,
        told: &Told,
        judged: Option<&JudgedLog<N>>,
        failed: Option<&str>,
    ) -> Result<Value, CampaignError> {
        let cost = &told.trial.cost;
        Ok(json!({
            "schema": "tribo.tell/1",
            "trial": told.trial.number,
            "state": if failed.is_some() { "failed" } else { "complete" },
            "cost": cost.total(),
            "cost_parts": cost.parts().into_iter().map(|(k, v)| (k.to_owned(), json!(v))).collect::<Map<_, _>>(),
            "penalty": cost.penalty,
            "reason": failed,
            "aborted_at_s": told.aborted_at_s,
            "faults": judged.map(|judged| judged.faults),
            "logged_compensation": judged.map(|judged| judged.logged_compensation),
            "best": told.conclusion.best,
            "law_check": told.conclusion.law_check.map(LawCheck::summary),
            "standing": told.conclusion.standing,
            "beyond_box": told.conclusion.beyond_box,
            "remarks": told.conclusion.remarks(&self.tune().trial.model.joint_names),
            "early_stop": told.early_stop,
            "finished": told.finished,
            "trials": self.tune().config.trials,
            "running": self.running(),
            "learnt": self.learnt()?.iter().map(Learnt::to_json).collect::<Vec<_>>(),
        }))
    }

    /// The document about a trial that has been taken back.
    pub fn withdrawn_document(&self, number: usize, reason: &str) -> Value {
        json!({
            "schema": "tribo.tell/1",
            "trial": number,
            "state": "withdrawn",
            "reason": reason,
            "best": self.best(),
            "finished": self.finished().count(),
            "trials": self.tune().config.trials,
            "running": self.running(),
        })
    }
}

impl Learnt {
    /// The parameter as an entry of `tribo.tell/1`.
    pub fn to_json(&self) -> Value {
        json!({
            "parameter": format!("joint_{}.{}", self.joint, self.name),
            "value": self.value,
            "sd": self.sd,
            "unsure": self.is_unsure(),
        })
    }
}
