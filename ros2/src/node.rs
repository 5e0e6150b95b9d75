//! The participant in DDS: one reader of joint states, three writers.

use std::net::IpAddr;
use std::time::Duration;

use rustdds::dds::CreateResult;
use rustdds::no_key::DataWriter;
use rustdds::policy::{Durability, History, Reliability};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, Publisher, QosPolicies, QosPolicyBuilder, Subscriber, TopicKind,
};

use crate::ListenError;
use crate::message::{COVARIANCE_TYPE, DIAGNOSTIC_TYPE, WRENCH_TYPE};
use crate::raw::{Raw, RawAdapter};
use crate::topic_reader::TopicReader;

/// Name of `sensor_msgs/msg/JointState` in DDS.
const JOINT_STATE_TYPE: &str = "sensor_msgs::msg::dds_::JointState_";
/// Topics of ROS carry this in front of their names.
const ROS_TOPIC: &str = "rt";
/// Messages that wait for a slow reader: a tenth of a second at 1 kHz.
const DEPTH: i32 = 100;

/// Names of topics as ROS has them, with or without the slash in front.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicNames {
    /// `sensor_msgs/JointState`, read.
    pub joint_states: String,
    /// `sensor_msgs/JointState` whose effort is the torque that the controller adds for friction, read.
    pub compensation: Option<String>,
    /// `geometry_msgs/WrenchStamped`, written; the covariance goes to `…/covariance`.
    pub wrench: String,
    /// `diagnostic_msgs/DiagnosticArray`, written.
    pub diagnostics: String,
}

/// Where to listen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeSettings {
    /// `ROS_DOMAIN_ID`, 0 to 232.
    pub domain: u16,
    /// Addresses of the network interfaces to use; empty is all of them.
    pub addresses: Vec<IpAddr>,
    /// The topics.
    pub topics: TopicNames,
}

/// A participant with its readers and writers: sensor data is read as best effort, which any publisher offers; what is written is reliable, which
/// any subscriber takes; both are volatile.
pub struct Node {
    pub(crate) joint_states: TopicReader,
    pub(crate) compensation: Option<TopicReader>,
    pub(crate) wrench: DataWriter<Raw, RawAdapter>,
    pub(crate) covariance: DataWriter<Raw, RawAdapter>,
    pub(crate) diagnostics: DataWriter<Raw, RawAdapter>,
    pub(crate) settings: NodeSettings,
    participant: DomainParticipant,
}

impl Node {
    /// Joins a domain.
    ///
    /// # Errors
    /// A topic's name that ROS would not have, or a network that does not let it.
    pub fn join(mut settings: NodeSettings) -> Result<Self, ListenError> {
        let topics = &mut settings.topics;
        let all = [&mut topics.joint_states, &mut topics.wrench, &mut topics.diagnostics];
        for topic in all.into_iter().chain(&mut topics.compensation) {
            *topic = full_name(topic)?;
        }
        if topics.compensation.as_ref() == Some(&topics.joint_states) {
            let why = "cannot be the joint states and the compensation at once".to_owned();
            return Err(ListenError::Topic { topic: topics.joint_states.clone(), why });
        }
        let domain = settings.domain;
        Self::on_network(settings).map_err(|error| ListenError::Network { domain, why: error.to_string() })
    }

    fn on_network(settings: NodeSettings) -> CreateResult<Self> {
        let mut builder = DomainParticipantBuilder::new(settings.domain);
        if !settings.addresses.is_empty() {
            builder = builder.with_only_networks(settings.addresses.iter().copied());
        }
        let participant = builder.build()?;
        let sensor_data = qos(Reliability::BestEffort);
        let reliable = qos(Reliability::Reliable { max_blocking_time: Duration::from_millis(100).into() });
        let (subscriber, publisher) =
            (participant.create_subscriber(&sensor_data)?, participant.create_publisher(&reliable)?);
        let ends = Ends { participant: &participant, subscriber, publisher, sensor_data, reliable };
        let topics = &settings.topics;
        Ok(Self {
            joint_states: ends.reader(&topics.joint_states)?,
            compensation: topics.compensation.as_deref().map(|topic| ends.reader(topic)).transpose()?,
            wrench: ends.writer(&topics.wrench, WRENCH_TYPE)?,
            covariance: ends.writer(&format!("{}/covariance", topics.wrench), COVARIANCE_TYPE)?,
            diagnostics: ends.writer(&topics.diagnostics, DIAGNOSTIC_TYPE)?,
            participant,
            settings,
        })
    }

    /// Where it listens, names of topics with the slash in front.
    pub fn settings(&self) -> &NodeSettings {
        &self.settings
    }

    /// Topics with joint states that others publish.
    pub(crate) fn joint_state_topics(&self) -> Vec<String> {
        let mut topics: Vec<String> = self
            .participant
            .discovered_writers()
            .into_iter()
            .filter(|writer| writer.publication_topic_data.type_name == JOINT_STATE_TYPE)
            .filter_map(|writer| Some(visible(writer.publication_topic_data.topic_name.strip_prefix(ROS_TOPIC)?)))
            .collect();
        topics.sort();
        topics.dedup();
        topics
    }
}

/// What readers and writers are made of.
struct Ends<'p> {
    participant: &'p DomainParticipant,
    subscriber: Subscriber,
    publisher: Publisher,
    sensor_data: QosPolicies,
    reliable: QosPolicies,
}

impl Ends<'_> {
    fn reader(&self, topic: &str) -> CreateResult<TopicReader> {
        let (name, kind) = (format!("{ROS_TOPIC}{topic}"), JOINT_STATE_TYPE.to_owned());
        let topic = self.participant.create_topic(name, kind, &self.sensor_data, TopicKind::NoKey)?;
        self.subscriber.create_simple_datareader_no_key(&topic, Some(self.sensor_data.clone())).map(TopicReader::new)
    }

    fn writer(&self, topic: &str, kind: &str) -> CreateResult<DataWriter<Raw, RawAdapter>> {
        let (name, kind) = (format!("{ROS_TOPIC}{topic}"), kind.to_owned());
        let topic = self.participant.create_topic(name, kind, &self.reliable, TopicKind::NoKey)?;
        self.publisher.create_datawriter_no_key(&topic, Some(self.reliable.clone()))
    }
}

fn qos(reliability: Reliability) -> QosPolicies {
    let history = History::KeepLast { depth: DEPTH };
    QosPolicyBuilder::new().reliability(reliability).durability(Durability::Volatile).history(history).build()
}

/// A topic's name with the slash in front.
fn full_name(topic: &str) -> Result<String, ListenError> {
    let words = topic.strip_prefix('/').unwrap_or(topic);
    let is_word = |word: &str| {
        word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    if topic.len() <= 200 && words.split('/').all(is_word) {
        return Ok(format!("/{words}"));
    }
    let why = "is no name of a topic; allowed: words of letters, digits and _ that do not begin with a digit, with / between them, \
               at most 200 characters"
        .to_owned();
    Err(ListenError::Topic { topic: visible(topic), why })
}

fn visible(name: &str) -> String {
    name.chars().take(256).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_topics_are_those_of_ros() {
        assert_eq!(full_name("joint_states").unwrap(), "/joint_states");
        assert_eq!(full_name("/franka/joint_states_2").unwrap(), "/franka/joint_states_2");
        for wrong in ["", "/", "a//b", "/2a", "a b", "/a/", "ä"] {
            assert!(full_name(wrong).is_err(), "{wrong}");
        }
    }
}
