//! Joint states on a ROS 2 topic, from whoever is on the network.

use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::{Compensator, FrictionModel, VelocitySource};
use tribo_logs::JointStateReader;
use tribo_robot::presets;
use tribo_ros2::{ArmJoints, Unusable, WrenchStream};
use tribo_runtime::MeasuredWrench;

/// What stands between two messages.
const BETWEEN: &[u8] = b"\n--\n";

/// Each message is refused or is the same when written and read again; what is published of a stream of them is finite.
pub fn check(input: &[u8]) {
    let reader = JointStateReader::new().expect("a definition of our own");
    let frictionless = Compensator::new(FrictionModel::none(), VelocitySource::Measured);
    let measured = MeasuredWrench::new(presets::panda(), frictionless, WrenchEkf::new(WrenchEkfSettings::default()));
    let mut stream = WrenchStream::new(measured, ArmJoints::new(None));
    let (mut rest, mut more) = (input, true);
    while more {
        let end = rest.windows(BETWEEN.len()).position(|window| window == BETWEEN);
        let message = &rest[..end.unwrap_or(rest.len())];
        (rest, more) = (&rest[end.map_or(rest.len(), |end| end + BETWEEN.len())..], end.is_some());
        let state = match reader.read(message) {
            Ok(state) => state,
            Err(detail) => {
                assert!(!detail.is_empty());
                continue;
            }
        };
        let bytes = state.to_cdr();
        assert_eq!(reader.read(&bytes).expect("what is written is read").to_cdr(), bytes);
        match stream.take(&state, None) {
            Ok(taken) => {
                if let Some(wrench) = taken.wrench {
                    assert!(wrench.estimate.wrench_base.to_vector().iter().all(|value| value.is_finite()));
                    assert!(wrench.estimate.covariance.iter().all(|value| value.is_finite()));
                }
            }
            Err(Unusable::NotLater | Unusable::NoStamp) => {}
            Err(why) => assert!(!why.to_string().chars().any(char::is_control), "{why}"),
        }
    }
    let counts = stream.counts();
    assert_eq!(counts.received, counts.used + counts.incomplete + counts.not_later + counts.unusable);
}
