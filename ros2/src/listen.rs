//! The loop: a joint state comes, a wrench goes.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use nalgebra::SVector;
use rustdds::mio1::{Events, Interest, Poll, Token};
use rustdds::no_key::DataWriter;
use tribo_logs::{JointState, JointStateReader};
use tribo_robot::WrenchEstimator;
use tribo_runtime::MeasuredWrench;

use crate::ages::{Ages, now_ns};
use crate::arm_joints::picked;
use crate::health::{CompensationHealth, Health};
use crate::message::{covariance_array, diagnostic_array, wrench_stamped};
use crate::raw::{Raw, RawAdapter};
use crate::recording::Recording;
use crate::{ArmJoints, Counts, ListenError, Node, NodeSettings, StampedWrench, Unusable, WrenchStream};

/// The longest time between two looks at the wish to stop.
const LOOK: Duration = Duration::from_millis(20);
/// Messages of which one has to be usable: other publishers on the same topic come in turns.
const LOOKED_AT: u64 = 100;
/// Time without a message after which somebody is told.
const SILENCE: Duration = Duration::from_secs(5);
/// Time between two diagnostics.
const DIAGNOSTICS: Duration = Duration::from_secs(1);

/// How to listen.
#[derive(Clone, Debug, Default)]
pub struct ListenSettings {
    /// `frame_id` of the wrenches.
    pub frame_id: String,
    /// Name of the estimator, for the diagnostics.
    pub estimator: String,
    /// Name of the robot, for the diagnostics.
    pub robot: String,
    /// Most wrenches per second of stamps (Hz); all without.
    pub rate_hz: Option<f64>,
    /// Where the messages that were used are kept (MCAP): the arm's joints alone, base to tool.
    pub record: Option<PathBuf>,
    /// How long to listen; until the stop without.
    pub duration: Option<Duration>,
}

/// What comes from elsewhere while the loop runs.
pub enum Update<const N: usize, E> {
    /// Another estimator, of parameters that have changed.
    Replace(Box<MeasuredWrench<N, E>>),
    /// Parameters that have changed and cannot be used, and why.
    Refused(String),
}

/// What somebody may want to be told at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Heard {
    /// Nothing has come for five seconds; joint states are on these topics.
    Silence(Vec<String>),
    /// Joint states have come for five seconds, but no torque on the topic of the compensation: without it none of them can be used.
    NoCompensation,
    /// The first message that is used; names of the joints, base to tool, where it has names.
    Begun(Vec<String>),
    /// The stamps have a gap, or jumped back: the estimator has begun anew. Said once a second at most.
    BegunAnew,
}

/// How it was.
#[derive(Clone, Debug)]
pub struct Listened {
    /// What came and what went.
    pub counts: Counts,
    /// Times of all wrenches that went out.
    pub ages: Option<Ages>,
    /// How long (s), by the computer's clock.
    pub duration_s: f64,
    /// Period of the topic (s) by its stamps at the end.
    pub period_s: Option<f64>,
    /// Whether somebody stopped it before its time.
    pub stopped: bool,
}

/// Listens until it is stopped or its time is over.
///
/// # Errors
/// A topic that says nothing in the time given, or nothing usable in its first 100 messages; a recording that cannot be written.
pub fn listen<const N: usize, E: WrenchEstimator<N>>(
    node: Node,
    stream: WrenchStream<N, E>,
    settings: &ListenSettings,
    updates: &Receiver<Update<N, E>>,
    stop: &AtomicBool,
    hear: &mut dyn FnMut(Heard),
) -> Result<Listened, ListenError> {
    let topic = node.settings.topics.joint_states.clone();
    let recording = settings.record.as_deref().map(|path| Recording::begin(path, &topic)).transpose()?;
    let network = |why: String| ListenError::Network { domain: node.settings.domain, why };
    let reader = JointStateReader::new().map_err(network)?;
    let told = node
        .compensation
        .is_some()
        .then(|| Told { joints: ArmJoints::new(stream.joints().names().cloned()), torque: None });
    let ages = Ages::new();
    let second = Second::after(Counts::default());
    let (due_ns, refused) = (0, None);
    let mut listener =
        Listener { node, stream, settings, reader, recording, told, ages, second, due_ns, refused, hear };
    let ran = listener.run(updates, stop);
    // What was recorded is kept, whatever ended it.
    let kept = listener.recording.take().map_or(Ok(()), Recording::finish);
    let (duration_s, stopped) = ran?;
    kept?;
    let (counts, period_s) = (*listener.stream.counts(), listener.stream.period_s());
    Ok(Listened { counts, ages: listener.ages, duration_s, period_s, stopped })
}

struct Listener<'l, const N: usize, E> {
    node: Node,
    stream: WrenchStream<N, E>,
    settings: &'l ListenSettings,
    reader: JointStateReader,
    recording: Option<Recording>,
    told: Option<Told<N>>,
    ages: Option<Ages>,
    second: Second,
    /// Stamp from which on the next wrench may go out.
    due_ns: u64,
    refused: Option<String>,
    hear: &'l mut dyn FnMut(Heard),
}

/// What the controller says that it adds for friction.
struct Told<const N: usize> {
    joints: ArmJoints<N>,
    /// The last one (Nm).
    torque: Option<SVector<f64, N>>,
}

/// Since the last diagnostics.
struct Second {
    begun: Instant,
    before: Counts,
    ages: Option<Ages>,
    /// Whether somebody has been told of a gap.
    told: bool,
}

impl Second {
    fn after(before: Counts) -> Self {
        Self { begun: Instant::now(), before, ages: Ages::new(), told: false }
    }
}

impl<const N: usize, E: WrenchEstimator<N>> Listener<'_, N, E> {
    /// How long it ran (s), and whether it was stopped.
    fn run(&mut self, updates: &Receiver<Update<N, E>>, stop: &AtomicBool) -> Result<(f64, bool), ListenError> {
        let domain = self.node.settings.domain;
        let network = |error: std::io::Error| ListenError::Network { domain, why: error.to_string() };
        let mut poll = Poll::new().map_err(network)?;
        let registered = poll.registry().register(self.node.joint_states.source(), Token(0), Interest::READABLE);
        registered.map_err(network)?;
        let mut events = Events::with_capacity(16);
        let (begun, mut told_of_silence, mut told_of_compensation) = (Instant::now(), false, false);
        loop {
            let stopped = stop.load(Ordering::Relaxed);
            if stopped || self.settings.duration.is_some_and(|duration| begun.elapsed() >= duration) {
                let duration_s = begun.elapsed().as_secs_f64();
                return if stopped || self.stream.counts().received > 0 {
                    Ok((duration_s, stopped))
                } else {
                    Err(self.silent(duration_s))
                };
            }
            match poll.poll(&mut events, Some(LOOK)) {
                Err(error) if error.kind() != std::io::ErrorKind::Interrupted => return Err(network(error)),
                _ => {}
            }

            // Parameters and torques that belong to the samples to come.
            while let Ok(update) = updates.try_recv() {
                match update {
                    Update::Replace(measured) => {
                        self.stream.replace(*measured);
                        self.refused = None;
                    }
                    Update::Refused(why) => self.refused = Some(why),
                }
            }
            self.hear_compensation();

            // The samples.
            self.node.joint_states.begin_taking();
            while let Some(message) = self.node.joint_states.take() {
                self.one(&message)?;
            }

            // What the monitors see.
            if self.second.begun.elapsed() >= DIAGNOSTICS {
                self.diagnose();
            }
            if !told_of_silence && self.stream.counts().received == 0 && begun.elapsed() >= SILENCE {
                told_of_silence = true;
                (self.hear)(Heard::Silence(self.node.joint_state_topics()));
            }
            if !told_of_compensation && begun.elapsed() >= SILENCE && self.stream.counts().received > 0 {
                told_of_compensation = true;
                if self.told.as_ref().is_some_and(|told| told.torque.is_none()) {
                    (self.hear)(Heard::NoCompensation);
                }
            }
        }
    }

    fn silent(&self, waited_s: f64) -> ListenError {
        let NodeSettings { domain, topics, .. } = &self.node.settings;
        let others = self.node.joint_state_topics();
        ListenError::Silent { topic: topics.joint_states.clone(), waited_s, domain: *domain, others }
    }

    /// One message: estimate, publish, keep.
    fn one(&mut self, message: &[u8]) -> Result<(), ListenError> {
        let (begun, arrived_ns) = (Instant::now(), now_ns());
        let before = *self.stream.counts();
        let told_nm = match &self.told {
            // Nothing is known of friction that is cancelled before it has been told.
            Some(Told { torque: None, .. }) => {
                let counts = self.stream.counts_mut();
                (counts.received, counts.unusable) = (counts.received + 1, counts.unusable + 1);
                return Ok(());
            }
            Some(Told { torque, .. }) => *torque,
            None => None,
        };
        let taken = match self.reader.read(message) {
            Ok(state) => self.stream.take(&state, told_nm.as_ref()).map(|taken| (state, taken)),
            Err(detail) => {
                let counts = self.stream.counts_mut();
                (counts.received, counts.unusable) = (counts.received + 1, counts.unusable + 1);
                Err(Unusable::Broken(detail))
            }
        };
        let (state, taken) = match taken {
            Ok(taken) => taken,
            Err(why) => return self.refuse(why),
        };
        if before.used == 0 {
            let names = self.stream.joints().names();
            (self.hear)(Heard::Begun(names.map(|names| names.to_vec()).unwrap_or_default()));
        }
        let counts = self.stream.counts();
        if (counts.gaps, counts.restarts) != (before.gaps, before.restarts) && !self.second.told {
            self.second.told = true;
            (self.hear)(Heard::BegunAnew);
        }
        if let Some(wrench) = taken.wrench.filter(|wrench| self.is_due(wrench.stamp_ns)) {
            self.publish(&wrench, begun);
        }
        if let Some(recording) = &mut self.recording
            && !recording.push(of_arm(&state, &taken.entries), arrived_ns)
        {
            // The writer has ended with an error, which is the one to show.
            let ended = self.recording.take().map_or(Ok(()), Recording::finish);
            ended?;
        }
        Ok(())
    }

    /// Ends where nothing usable came so far.
    fn refuse(&self, why: Unusable) -> Result<(), ListenError> {
        let counts = self.stream.counts();
        if counts.used > 0 || counts.received < LOOKED_AT {
            return Ok(());
        }
        let topic = self.node.settings.topics.joint_states.clone();
        Err(ListenError::Unusable { topic, messages: counts.received, why })
    }

    /// Whether a wrench of this stamp goes out at the rate that is wished.
    fn is_due(&mut self, stamp_ns: u64) -> bool {
        let Some(rate_hz) = self.settings.rate_hz else { return true };
        let period_ns = (1e9 / rate_hz) as u64;
        // Half a period of the topic early is nearer than half a period late.
        let slack_ns = self.stream.period_s().map_or(0, |period_s| (period_s * 0.5e9) as u64);
        let restarted = self.due_ns > stamp_ns.saturating_add(period_ns).saturating_add(slack_ns);
        if stamp_ns + slack_ns < self.due_ns && !restarted {
            return false;
        }
        let next_ns = self.due_ns.saturating_add(period_ns);
        self.due_ns = if next_ns + slack_ns > stamp_ns && !restarted { next_ns } else { stamp_ns + period_ns };
        true
    }

    fn publish(&mut self, StampedWrench { stamp_ns, estimate }: &StampedWrench, begun: Instant) {
        let wrench = wrench_stamped(*stamp_ns, &self.settings.frame_id, &estimate.wrench_base);
        let sent = sent(&self.node.wrench, wrench);
        let took = begun.elapsed();
        let sent = sent && self::sent(&self.node.covariance, covariance_array(*stamp_ns, &estimate.covariance));
        let counts = self.stream.counts_mut();
        if !sent {
            counts.unsent += 1;
            return;
        }
        counts.published += 1;
        for ages in [&mut self.ages, &mut self.second.ages].into_iter().flatten() {
            ages.record(*stamp_ns, took);
        }
    }

    /// The newest torque of the compensation.
    fn hear_compensation(&mut self) {
        let (Some(told), Some(topic)) = (&mut self.told, &mut self.node.compensation) else { return };
        topic.begin_taking();
        while let Some(message) = topic.take() {
            let torque = self.reader.read(&message).map_err(Unusable::Broken).and_then(|state| {
                // A message for the torque alone has no positions.
                let entries = told.joints.entries(&state)?;
                picked(&state, "effort", &state.effort, &entries)
            });
            if let Ok(torque) = torque {
                told.torque = Some(torque);
            }
        }
    }

    fn diagnose(&mut self) {
        let now = *self.stream.counts();
        let health = Health {
            estimator: &self.settings.estimator,
            robot: &self.settings.robot,
            joint_states: &self.node.settings.topics.joint_states,
            now: &now,
            before: &self.second.before,
            seconds: self.second.begun.elapsed().as_secs_f64(),
            ages: self.second.ages.as_ref(),
            fault: self.stream.fault(),
            refused: self.refused.as_deref(),
            publishers: self.node.joint_states.publishers(),
            compensation: match (&self.told, &mut self.node.compensation) {
                (Some(told), Some(topic)) => {
                    Some(CompensationHealth { publishers: topic.publishers(), has_come: told.torque.is_some() })
                }
                _ => None,
            },
        };
        // A monitor that misses one sees the next.
        let _ = sent(&self.node.diagnostics, diagnostic_array(now_ns(), &health.status()));
        self.second = Second::after(now);
    }
}

/// Whether the network took it.
fn sent(writer: &DataWriter<Raw, RawAdapter>, message: Vec<u8>) -> bool {
    writer.write(Raw(message), None).is_ok()
}

/// The arm's joints alone, base to tool.
fn of_arm<const N: usize>(state: &JointState, entries: &[usize; N]) -> JointState {
    let of = |values: &Vec<f64>| -> Vec<f64> { entries.iter().filter_map(|&k| values.get(k).copied()).collect() };
    JointState {
        stamp_ns: state.stamp_ns,
        names: entries.iter().filter_map(|&k| state.names.get(k).cloned()).collect(),
        position: of(&state.position),
        velocity: of(&state.velocity),
        effort: of(&state.effort),
    }
}
