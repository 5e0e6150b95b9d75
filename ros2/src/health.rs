//! What the last second was like, as `diagnostic_msgs` has it.

use tribo_robot::EstimateFault;

use crate::ages::Ages;
use crate::counts::Counts;
use crate::message::{Level, Status};

/// What is known at the end of a second.
pub(crate) struct Health<'h> {
    pub estimator: &'h str,
    pub robot: &'h str,
    pub joint_states: &'h str,
    /// Counts at the end and at the beginning of the second, and its length (s).
    pub now: &'h Counts,
    pub before: &'h Counts,
    pub seconds: f64,
    /// Of the second.
    pub ages: Option<&'h Ages>,
    pub fault: Option<EstimateFault>,
    /// Why the newest parameters were refused.
    pub refused: Option<&'h str>,
    /// Publishers of joint states.
    pub publishers: usize,
    /// None where no torque of a compensation is listened to.
    pub compensation: Option<CompensationHealth>,
}

/// The topic on which the controller tells its torque.
#[derive(Clone, Copy)]
pub(crate) struct CompensationHealth {
    pub publishers: usize,
    /// Whether a torque has come.
    pub has_come: bool,
}

impl Health<'_> {
    /// The level, a sentence, and the numbers.
    pub fn status(&self) -> Status {
        let grew = |of: fn(&Counts) -> u64| of(self.now) - of(self.before);
        let (used, published) = (grew(|c| c.used), grew(|c| c.published));
        let rate = |count: u64| format!("{:.1}", count as f64 / self.seconds.max(1e-3));
        let (level, message) = match self.fault {
            _ if grew(|c| c.received) == 0 => (Level::Stale, format!("no message on {}", self.joint_states)),
            _ if self.compensation.is_some_and(|compensation| !compensation.has_come) => {
                (Level::Error, "no torque of the compensation has come".to_owned())
            }
            _ if used == 0 => (Level::Error, format!("no message on {} can be used", self.joint_states)),
            Some(fault) => (Level::Error, fault.to_string()),
            None if published == 0 => (Level::Warn, "the estimator settles".to_owned()),
            None if grew(|c| c.unsent) > 0 => (Level::Warn, "the network did not take every wrench".to_owned()),
            None if self.refused.is_some() => {
                (Level::Warn, "the newest parameters cannot be used; the old ones are".to_owned())
            }
            None if grew(|c| c.faults + c.lost + c.gaps + c.restarts + c.not_later + c.unusable) > 0 => {
                (Level::Warn, "messages were lost or could not be used".to_owned())
            }
            None => (Level::Ok, "wrenches go out".to_owned()),
        };
        let mut values = vec![
            ("estimator", self.estimator.to_owned()),
            ("joint states [Hz]", rate(used)),
            ("wrenches [Hz]", rate(published)),
            ("publishers of joint states", self.publishers.to_string()),
        ];
        if let Some(compensation) = self.compensation {
            values.push(("publishers of the compensation", compensation.publishers.to_string()));
            values.push(("compensation", if compensation.has_come { "has come" } else { "missing" }.to_owned()));
        }
        for (name, count) in [
            ("received", self.now.received),
            ("used", self.now.used),
            ("published", self.now.published),
            ("lost", self.now.lost),
            ("not later", self.now.not_later),
            ("incomplete", self.now.incomplete),
            ("unusable", self.now.unusable),
            ("gaps", self.now.gaps),
            ("restarts", self.now.restarts),
            ("faults", self.now.faults),
            ("unsent", self.now.unsent),
        ] {
            values.push((name, count.to_string()));
        }
        if let Some(ages) = self.ages {
            let ms = |us: f64| format!("{:.3}", us * 1e-3);
            let (age, took) = (&ages.stamp_to_wrench, &ages.taken_to_wrench);
            if age.count() > 0 {
                values.push(("stamp to wrench, p50 [ms]", ms(age.quantile_us(0.5))));
                values.push(("stamp to wrench, p99 [ms]", ms(age.quantile_us(0.99))));
            }
            if took.count() > 0 {
                values.push(("taken to wrench, p50 [ms]", ms(took.quantile_us(0.5))));
                values.push(("taken to wrench, p99 [ms]", ms(took.quantile_us(0.99))));
            }
        }
        if let Some(why) = self.refused {
            values.push(("parameters refused", why.to_owned()));
        }
        Status { level, name: "tribo: wrench".to_owned(), message, hardware_id: self.robot.to_owned(), values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(now: Counts, fault: Option<EstimateFault>, refused: Option<&str>) -> Level {
        status(now, fault, refused, None).level
    }

    fn status(
        now: Counts,
        fault: Option<EstimateFault>,
        refused: Option<&str>,
        compensation: Option<CompensationHealth>,
    ) -> Status {
        let before = Counts::default();
        Health {
            estimator: "ekf",
            robot: "panda",
            joint_states: "/j",
            now: &now,
            before: &before,
            seconds: 1.0,
            ages: None,
            fault,
            refused,
            publishers: 1,
            compensation,
        }
        .status()
    }

    #[test]
    fn a_compensation_that_is_missing_is_the_reason() {
        // Nothing can be used for that reason, so the reason is what is said.
        let unused = Counts { received: 1000, unusable: 1000, ..Counts::default() };
        let missing = CompensationHealth { publishers: 1, has_come: false };
        let missing = status(unused, None, None, Some(missing));
        assert_eq!((missing.level, &*missing.message), (Level::Error, "no torque of the compensation has come"));
    }

    #[test]
    fn each_trouble_has_its_level() {
        let fine = Counts { received: 1000, used: 1000, published: 1000, ..Counts::default() };
        assert_eq!(level(Counts::default(), None, None), Level::Stale);
        assert_eq!(level(Counts { received: 9, ..Counts::default() }, None, None), Level::Error);
        assert_eq!(level(fine, Some(EstimateFault::NotConverged), None), Level::Error);
        assert_eq!(level(Counts { published: 0, ..fine }, None, None), Level::Warn);
        assert_eq!(level(Counts { lost: 1, ..fine }, None, None), Level::Warn);
        assert_eq!(level(fine, None, Some("a.yaml:3: no")), Level::Warn);
        assert_eq!(level(fine, None, None), Level::Ok);
    }
}
