//! Which model a log, a topic or a motion is held against.

use tribo_model::ModelChoice;

use super::named;
use crate::arguments::RobotModel;

impl RobotModel {
    /// The choice that the flags make; nothing is read.
    ///
    /// # Errors
    /// A side of the gears that there is not.
    pub fn choice(&self) -> anyhow::Result<ModelChoice> {
        Ok(ModelChoice {
            model: self.model.clone(),
            robot: self.robot.clone(),
            base_link: self.ends.base_link.clone(),
            tip_link: self.ends.tip_link.clone(),
            torque_side: named(&self.torque_side)?,
        })
    }
}
