//! Why nobody listens any more.

use tribo_files::LogError;

use crate::Unusable;

/// Why listening could not begin or had to end.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// A topic that cannot be.
    #[error("topic {topic}: {why}")]
    Topic {
        /// Its name.
        topic: String,
        /// What is wrong with it.
        why: String,
    },
    /// The network does not allow it.
    #[error("DDS, domain {domain}: {why}")]
    Network {
        /// The domain.
        domain: u16,
        /// What the library says.
        why: String,
    },
    /// None of the first messages could be used.
    #[error("topic {topic}: none of the first {messages} messages can be used: the last one {why}")]
    Unusable {
        /// The topic.
        topic: String,
        /// How many came.
        messages: u64,
        /// What is wrong with the last.
        why: Unusable,
    },
    /// No message came at all.
    #[error("topic {topic}: no message in {waited_s:.1} s, domain {domain}; {}", elsewhere(.others))]
    Silent {
        /// The topic.
        topic: String,
        /// How long (s).
        waited_s: f64,
        /// The domain.
        domain: u16,
        /// Topics with joint states that are published there.
        others: Vec<String>,
    },
    /// The recording could not be written.
    #[error(transparent)]
    Recording(#[from] LogError),
}

/// Where joint states are, for somebody who hears none.
pub(crate) fn elsewhere(topics: &[String]) -> String {
    match topics {
        [] => "nobody publishes joint states that this computer can see".to_owned(),
        _ => format!("joint states are published on {}", topics.join(", ")),
    }
}
