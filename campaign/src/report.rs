//! The result of a campaign as one JSON document, `tribo.campaign/1`.

use serde_json::{Map, Value, json};

use crate::strategy::LawCheck;
use crate::{AgainstEkf, CampaignResult, ParameterSpace};

impl CampaignResult {
    /// The document of `tribo tune --json`; `against_ekf` is what the EKF says of another estimator's campaign, `wall_s` the
    /// time the run took (s).
    pub fn to_json(&self, against_ekf: Option<AgainstEkf>, wall_s: f64) -> Value {
        let space = &self.space;
        let trials: Vec<Value> = self
            .trials
            .iter()
            .map(|trial| {
                json!({
                    "trial": trial.number,
                    "state": if trial.aborted.is_none() { "complete" } else { "failed" },
                    "cost": trial.cost.total(),
                    "cost_parts": trial.cost.parts().into_iter().map(|(k, v)| (k.to_owned(), json!(v))).collect::<Map<_, _>>(),
                    "penalty": trial.cost.penalty,
                    "reason": trial.aborted,
                    "origin": trial.origin,
                    "params": space.nested(&trial.theta),
                })
            })
            .collect();
        let params = self.conclusion.best.map(|best| space.nested(&self.trials[best.trial].theta));
        json!({
            "schema": "tribo.campaign/1",
            "tribo_version": self.config.tribo_version,
            "robot": self.config.robot,
            "seed": self.config.seed,
            "strategy": self.config.strategy,
            "friction": self.config.friction,
            "residual": self.config.residual,
            "cost_measure": self.config.cost,
            "velocity": self.config.velocity,
            "trials": trials,
            "best": self.conclusion.best,
            "uncompensated_cost": self.references.uncompensated,
            "oracle_cost": self.references.oracle,
            "oracle_failed": self.references.oracle_failed,
            "frictionless_cost": self.references.frictionless,
            "params": params,
            "against_ekf": against_ekf.map(|judged| json!({
                "cost": judged.cost,
                "cost_of_ekf_campaign": judged.cost_of_ekf_campaign,
                "excess": judged.excess(),
            })),
            "law_check": self.conclusion.law_check.map(LawCheck::summary),
            "standing": self.conclusion.standing,
            "beyond_box": self.conclusion.beyond_box,
            "law_change": self.law_change,
            "true_params": self.truth.as_ref().map(|theta| space.nested(theta)),
            "early_stop": self.early_stop,
            "wall_s": wall_s,
        })
    }
}

impl ParameterSpace {
    /// `{joint_0: {coulomb_nm: …, …}, …}`.
    pub fn nested(&self, theta: &[f64]) -> Value {
        let joints = theta.chunks(self.parameters_per_joint()).enumerate().map(|(j, values)| {
            let joint = self.names_of_joint().zip(values).map(|(name, value)| (name.to_owned(), json!(value)));
            (format!("joint_{j}"), Value::Object(joint.collect()))
        });
        Value::Object(joints.collect())
    }
}
