//! The last seconds of a robot that is watched.

use std::collections::VecDeque;

use tribo_figure::{Signal, Signals};
use tribo_logs::Quantity;

use crate::live_feed::{Arrived, LiveFeed};
use crate::live_sample::LiveSample;
use crate::live_snapshot::LiveSnapshot;
use crate::log_snapshot::{label, single};
use crate::wrench_snapshot::components;

/// What is shown (s).
const SHOWN_S: f64 = 20.0;
/// Period of the states (s).
const PERIOD_S: f64 = 1e-3;

/// A quantity of a sample, joint by joint.
type Column = fn(&LiveSample) -> &Vec<f64>;

/// States of the last seconds, and counts of all.
#[derive(Debug)]
pub struct LiveRecord {
    feed: LiveFeed,
    samples: VecDeque<LiveSample>,
    heard: u64,
    lost: u64,
    status: String,
    ended: Option<String>,
}

impl LiveRecord {
    /// The record of a feed that has brought nothing.
    pub fn new(feed: LiveFeed) -> Self {
        Self { feed, samples: VecDeque::new(), heard: 0, lost: 0, status: String::new(), ended: None }
    }

    /// Takes what came; none where that is nothing new.
    pub fn poll(&mut self) -> Option<LiveSnapshot> {
        let Arrived { samples, status, ended } = self.feed.take();
        if samples.is_empty() && status.is_none() && ended.is_none() {
            return None;
        }
        self.status = status.unwrap_or(std::mem::take(&mut self.status));
        self.ended = ended.or(self.ended.take());
        for sample in samples {
            self.push(sample);
        }
        Some(self.snapshot())
    }

    fn push(&mut self, sample: LiveSample) {
        if let Some(last) = self.samples.back() {
            let since_s = sample.time_s - last.time_s;
            if since_s < 0.0 {
                // Another robot, or one that began anew.
                self.samples.clear();
            } else {
                self.lost += ((since_s / PERIOD_S).round() - 1.0).max(0.0) as u64;
            }
        }
        self.heard += 1;
        self.samples.push_back(sample);
        let newest_s = self.samples.back().map_or(0.0, |last| last.time_s);
        while self.samples.front().is_some_and(|first| first.time_s < newest_s - SHOWN_S) {
            self.samples.pop_front();
        }
    }

    /// What there is now.
    pub fn snapshot(&self) -> LiveSnapshot {
        LiveSnapshot {
            title: self.feed.title().clone(),
            status: self.status.clone(),
            ended: self.ended.clone(),
            heard: self.heard,
            lost: self.lost,
            newest: self.samples.back().cloned(),
            skeleton: self.samples.back().map_or_else(Vec::new, |sample| self.feed.skeleton(&sample.q_rad)),
            wrench: self.wrench(),
            joints: self.joints(),
            loop_times: self.loop_times(),
        }
    }

    fn signals(&self, channels: Vec<Signal>) -> Signals {
        Signals::new(self.samples.iter().map(|sample| sample.time_s).collect(), channels)
    }

    fn column(&self, of: impl Fn(&LiveSample) -> f64) -> Vec<f32> {
        single(self.samples.iter().map(of))
    }

    fn wrench(&self) -> Signals {
        let mut channels = Vec::new();
        for (k, (name, label)) in components().enumerate() {
            let ours = |sample: &LiveSample| sample.wrench.map_or(f64::NAN, |wrench| wrench[k]);
            let end = |side: usize| self.column(|sample| sample.limits95.map_or(f64::NAN, |ends| ends[side][k]));
            channels.push(Signal::new(format!("estimate {name}"), label.clone(), self.column(ours)));
            channels.push(Signal::new(format!("low {name}"), label.clone(), end(0)));
            channels.push(Signal::new(format!("high {name}"), label.clone(), end(1)));
            channels.push(Signal::new(format!("own {name}"), label, self.column(|sample| sample.own_wrench[k])));
        }
        self.signals(channels)
    }

    fn joints(&self) -> Signals {
        let mut channels = Vec::new();
        let joints = self.samples.back().map_or(0, |sample| sample.q_rad.len());
        let quantities: [(Quantity, Column); 3] = [
            (Quantity::Torque, |sample| &sample.tau_j_nm),
            (Quantity::Velocity, |sample| &sample.dq_rad_s),
            (Quantity::Position, |sample| &sample.q_rad),
        ];
        for (quantity, of) in quantities {
            for j in 0..joints {
                let column = self.column(|sample| of(sample).get(j).copied().unwrap_or(f64::NAN));
                channels.push(Signal::new(quantity.column_name(j), label(quantity), column));
            }
        }
        self.signals(channels)
    }

    fn loop_times(&self) -> Signals {
        let since = self.column(|sample| sample.since_last_ms);
        let estimator = self.column(|sample| sample.estimator_us);
        self.signals(vec![
            Signal::new("period", "time between two states [ms]", since),
            Signal::new("estimator", "time of the estimator [µs]", estimator),
        ])
    }
}

#[cfg(test)]
mod tests {
    use tribo_robot::presets;

    use super::*;
    use crate::live_feed::LiveTitle;

    fn sample(time_s: f64) -> LiveSample {
        LiveSample { time_s, q_rad: vec![time_s; 7], ..LiveSample::default() }
    }

    /// Lost states are counted by the robot's clock, old ones go, a clock that jumps back begins anew.
    #[test]
    fn the_last_seconds_are_kept_and_gaps_are_counted() {
        let feed = LiveFeed::new(LiveTitle::default(), presets::panda());
        let mut record = LiveRecord::new(feed.clone());
        assert!(record.poll().is_none(), "nothing came");
        for k in (0..=30_000).filter(|k| k % 1000 != 7) {
            feed.push(sample(f64::from(k) * 1e-3));
        }
        let shown = record.poll().unwrap();
        assert_eq!((shown.heard, shown.lost), (30_001 - 30, 30));
        let [first, last] = shown.joints.span_s();
        assert!((last - 30.0).abs() < 1e-9 && (first - 10.0).abs() < 2e-3, "{first} to {last}");
        assert_eq!(shown.newest.map(|newest| newest.q_rad), Some(vec![30.0; 7]));
        assert!(record.poll().is_none(), "nothing new came");
        feed.push(sample(0.0));
        feed.end("gone".to_owned());
        let shown = record.poll().unwrap();
        assert_eq!((shown.lost, shown.ended.as_deref()), (30, Some("gone")));
        assert_eq!(shown.joints.time_s(), [0.0]);
    }

    /// The estimate, its band and the robot's own stand beside each other; what settles is a gap.
    #[test]
    fn a_wrench_has_its_band() {
        let feed = LiveFeed::new(LiveTitle::default(), presets::panda());
        let mut record = LiveRecord::new(feed.clone());
        feed.push(sample(0.0));
        let wrench = Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        feed.push(LiveSample { wrench, limits95: Some([[1.5; 6], [2.5; 6]]), own_wrench: [9.0; 6], ..sample(1e-3) });
        let shown = record.poll().unwrap();
        let at = |channel: usize| shown.wrench.channels()[channel].samples()[1];
        assert_eq!([4, 5, 6, 7].map(at), [2.0, 1.5, 2.5, 9.0]);
        assert!(shown.wrench.channels()[4].samples()[0].is_nan());
    }
}
