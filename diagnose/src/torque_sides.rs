//! Logs that say the same about both sides of the gears.

use std::borrow::Cow;

use tribo_logs::{Quantity, RobotLog};

use crate::families::explain::Given;

/// Logs to diagnose, each with link-side torque or none: where one of them lacks it, the torque of the motors is explained, in all of them.
pub(crate) struct SameSides<'l> {
    logs: Cow<'l, [RobotLog]>,
    unloaded: Cow<'l, [RobotLog]>,
    validate: Cow<'l, [(String, RobotLog)]>,
    /// Whether what the gears take of the motors' torque is explained.
    gears_alone: bool,
}

impl<'l> SameSides<'l> {
    /// Leaves link-side torque out of every log unless all that are diagnosed have it.
    pub fn of(logs: &'l [RobotLog], unloaded: &'l [RobotLog], validate: &'l [(String, RobotLog)]) -> Self {
        let gears_alone = logs.iter().chain(unloaded).all(|log| log.tau_link_nm.is_some());
        if gears_alone {
            return Self { logs: logs.into(), unloaded: unloaded.into(), validate: validate.into(), gears_alone };
        }
        let without = |log: &RobotLog| log.clone().without(&[Quantity::LinkTorque]);
        let of_logs = |logs: &'l [RobotLog]| match logs.iter().any(|log| log.tau_link_nm.is_some()) {
            true => Cow::Owned(logs.iter().map(without).collect()),
            false => Cow::Borrowed(logs),
        };
        let validate = match validate.iter().any(|(_, log)| log.tau_link_nm.is_some()) {
            true => Cow::Owned(validate.iter().map(|(name, log)| (name.clone(), without(log))).collect()),
            false => Cow::Borrowed(validate),
        };
        Self { logs: of_logs(logs), unloaded: of_logs(unloaded), validate, gears_alone }
    }

    /// The logs.
    pub fn given(&self) -> Given<'_> {
        Given { logs: &self.logs, unloaded: &self.unloaded, validate: &self.validate }
    }

    /// What is to be said of logs that the answer is held against in another way than it was found.
    pub fn notes(&self) -> impl Iterator<Item = String> + '_ {
        let lacking = |(_, log): &&(String, RobotLog)| self.gears_alone && log.tau_link_nm.is_none();
        self.validate.iter().filter(lacking).map(|(name, _)| {
            format!(
                "{name} has no link-side torque, which the diagnosed logs have: the whole model is held against it, links and all, of which the \
                 diagnosis asked nothing; plain fits and the band were made of the gears' torque alone and are not beside it"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use tribo_logs::LogColumns;

    use super::*;

    fn log(of_links: bool) -> RobotLog {
        let joints = || vec![vec![0.0; 2]; 7];
        let columns = LogColumns {
            time_s: vec![0.0, 1e-3],
            q_rad: joints(),
            dq_rad_s: joints(),
            tau_j_nm: joints(),
            ..LogColumns::default()
        };
        LogColumns { tau_link_nm: of_links.then(joints), ..columns }.validate().unwrap()
    }

    #[test]
    fn what_one_log_lacks_is_asked_of_none() {
        let (both, one) = ([log(true)], [log(false)]);
        let validate = [("both".to_owned(), log(true)), ("one".to_owned(), log(false))];
        let of_links = |logs: &[RobotLog]| logs.iter().map(|log| log.tau_link_nm.is_some()).collect::<Vec<bool>>();
        let of_gears = SameSides::of(&both, &[], &validate);
        assert_eq!(of_links(of_gears.given().logs), [true]);
        assert_eq!(of_gears.given().validate, validate);
        assert_eq!(of_gears.notes().count(), 1);
        let of_motors = SameSides::of(&both, &one, &validate);
        assert_eq!(of_links(of_motors.given().logs), [false]);
        assert!(of_motors.given().validate.iter().all(|(_, log)| log.tau_link_nm.is_none()));
        assert_eq!(of_motors.notes().count(), 0);
    }
}
