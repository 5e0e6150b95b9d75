//! The way from the thread that hears a robot to the window.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nalgebra::{SVector, Vector3};
use tribo_robot::Arm;
use tribo_watch::skeleton;

use crate::live_sample::LiveSample;

/// Samples that wait at most: a window that is not drawn for a minute loses the older ones, and no memory.
const MOST_WAITING: usize = 60_000;

/// What a robot and its watcher say of themselves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LiveTitle {
    /// Where the robot is.
    pub host: String,
    /// The model that its states are held against.
    pub robot: String,
    /// What estimates the wrench.
    pub estimator: String,
}

/// What came since the window looked.
#[derive(Debug, Default)]
pub(crate) struct Arrived {
    pub samples: Vec<LiveSample>,
    /// The robot's mode and its errors, where they changed.
    pub status: Option<String>,
    /// Why no more comes.
    pub ended: Option<String>,
}

/// Points of an arm (m) from base to flange, at joint positions (rad).
type Skeleton = dyn Fn(&[f64]) -> Vec<Vector3<f64>> + Send + Sync;

/// The two ends of the way: the thread pushes, the window takes. The lock is held for the move of a sample or of a pointer.
#[derive(Clone)]
pub struct LiveFeed {
    title: LiveTitle,
    skeleton: Arc<Skeleton>,
    inbox: Arc<Mutex<Arrived>>,
}

impl fmt::Debug for LiveFeed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LiveFeed").field("title", &self.title).finish_non_exhaustive()
    }
}

impl LiveFeed {
    /// A way on which nothing has come, from this arm.
    pub fn new<const N: usize>(title: LiveTitle, arm: Arm<N>) -> Self {
        let at = move |q: &[f64]| skeleton(&arm, &SVector::from_fn(|j, _| q.get(j).copied().unwrap_or_default()));
        Self { title, skeleton: Arc::new(at), inbox: Arc::default() }
    }

    /// Points of the arm (m) from base to flange, at joint positions (rad).
    pub(crate) fn skeleton(&self, q_rad: &[f64]) -> Vec<Vector3<f64>> {
        (self.skeleton)(q_rad)
    }

    /// What robot and watcher say of themselves.
    pub fn title(&self) -> &LiveTitle {
        &self.title
    }

    /// Hands over a state.
    pub fn push(&self, sample: LiveSample) {
        let mut inbox = self.inbox();
        if inbox.samples.len() >= MOST_WAITING {
            inbox.samples.drain(..MOST_WAITING / 2);
        }
        inbox.samples.push(sample);
    }

    /// Tells the robot's mode and errors.
    pub fn tell(&self, status: String) {
        self.inbox().status = Some(status);
    }

    /// Tells why no more states come.
    pub fn end(&self, why: String) {
        self.inbox().ended = Some(why);
    }

    /// What came since the last call.
    pub(crate) fn take(&self) -> Arrived {
        std::mem::take(&mut *self.inbox())
    }

    /// A thread that died left whole samples.
    fn inbox(&self) -> MutexGuard<'_, Arrived> {
        self.inbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use tribo_robot::presets;

    use super::*;

    /// A window that sleeps loses the oldest samples, none of the newest, and gets each once.
    #[test]
    fn what_waits_is_bounded_and_comes_once() {
        let feed = LiveFeed::new(LiveTitle::default(), presets::panda());
        let other_end = feed.clone();
        let count = MOST_WAITING + 10;
        (0..count).for_each(|k| feed.push(LiveSample { time_s: k as f64, ..LiveSample::default() }));
        feed.tell("Idle".to_owned());
        let arrived = other_end.take();
        assert_eq!(arrived.samples.len(), MOST_WAITING / 2 + 10);
        assert_eq!(arrived.samples.last().map(|sample| sample.time_s), Some(count as f64 - 1.0));
        assert!(arrived.samples.windows(2).all(|pair| pair[1].time_s == pair[0].time_s + 1.0));
        assert_eq!((arrived.status.as_deref(), arrived.ended), (Some("Idle"), None));
        feed.end("gone".to_owned());
        let arrived = other_end.take();
        assert_eq!((arrived.samples.len(), arrived.ended.as_deref()), (0, Some("gone")));
    }
}
