//! Definitions and messages inside an MCAP file that is whole.

use tribo_logs::LogTarget;

use super::recorder::{Recorded, mcap_file};
use super::robot_log;

/// What stands between the parts of an input: the name of the type, its definition, then the messages. An empty definition means
/// messages in JSON.
const BETWEEN: &[u8] = b"\n--\n";

/// As for any log: no checksum helps here.
pub fn check(input: &[u8]) {
    let mut parts = Vec::new();
    let mut rest = input;
    while let Some(end) = rest.windows(BETWEEN.len()).position(|window| window == BETWEEN) {
        parts.push(&rest[..end]);
        rest = &rest[end + BETWEEN.len()..];
    }
    parts.push(rest);
    let [kind, definition, messages @ ..] = &parts[..] else { return };
    let recorded = |(log_ns, bytes): (u64, &&[u8])| Recorded {
        topic: "/robot".to_owned(),
        kind: String::from_utf8_lossy(kind).into_owned(),
        definition: String::from_utf8_lossy(definition).into_owned(),
        json: definition.is_empty(),
        log_ns,
        bytes: bytes.to_vec(),
    };
    let messages: Vec<Recorded> = (0..).zip(messages).map(recorded).collect();
    robot_log::check(&mcap_file(&messages, None), LogTarget::Csv(Default::default()));
}
