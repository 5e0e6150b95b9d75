//! What to do, in one sentence.

use tribo_regression::CauseLabel;
use tribo_robot::JointNames;
use tribo_sim::excitation::ViaPoints;

use super::motion::{Motion, PEAK_SPEED};
use super::pair::Pair;
use super::simulated::{CYCLE_EVERY_S, KNOWN_KG, session_s};

/// Evidence that decides.
const DECISIVE: f64 = 10.0;
/// Slowest stroke worth telling [rad/s].
const LEAST_RAD_S: f64 = 5e-3;

/// The sentence for a motion.
pub(super) fn of<const N: usize>(
    motion: Motion,
    pair: &Pair,
    points: &ViaPoints<N>,
    expected: f64,
    names: &JointNames,
) -> String {
    let joints = pair.own_joint().map_or_else(|| "all joints".to_owned(), |joint| names.of(joint).to_string());
    let kept = match pair.own_joint() {
        Some(_) => "all other joints at rest and the payload unchanged",
        None => "payload and base unchanged",
    };
    let [slowest, fastest] = speeds(points);
    let duration_s = points.time_s.last().copied().unwrap_or(0.0);
    let action = match motion {
        Motion::SlowBackAndForth => format!(
            "Move {joints} slowly back and forth, peak speeds {slowest:.2} to {fastest:.2} rad/s, for {duration_s:.0} s"
        ),
        Motion::MultiSpeedStrokes => format!(
            "Stroke {joints} both ways at peak speeds from {slowest:.2} to {fastest:.2} rad/s for {duration_s:.0} s, \
             holding for 1 s after each pair of strokes"
        ),
        Motion::StaticPoses | Motion::TiltedPoses => format!(
            "Hold {joints} for 1 s in each of {} {}, moving at up to {fastest:.2} rad/s in between ({duration_s:.0} s)",
            holds(points),
            if motion == Motion::TiltedPoses { "widely turned poses" } else { "poses" },
        ),
        Motion::FastMoves => {
            format!("Move {joints} from pose to pose without a pause at up to {fastest:.2} rad/s for {duration_s:.0} s")
        }
        Motion::SmallAndFast => {
            format!("Shake {joints} within 0.12 rad at up to {fastest:.2} rad/s for {duration_s:.0} s")
        }
        Motion::WarmUpCycles => format!(
            "Start cold and repeat this {duration_s:.0} s cycle of {joints} at up to {fastest:.2} rad/s without a pause \
             for {:.0} min, logging one cycle every {CYCLE_EVERY_S:.0} s",
            session_s(pair) / 60.0
        ),
        Motion::KnownPayload => format!(
            "Run this motion of {joints} at up to {fastest:.2} rad/s ({duration_s:.0} s) twice, without and with a known \
             body of {KNOWN_KG:.0} kg at the flange that the second model includes"
        ),
    };
    let kept = match motion {
        Motion::KnownPayload => "base and whatever else the flange carries unchanged",
        _ => kept,
    };
    let repeat = if expected < DECISIVE {
        format!(", and repeat it {:.0} times", (DECISIVE / expected).ceil())
    } else {
        String::new()
    };
    format!("{action}, {kept}, in clear space{repeat}.")
}

/// The sentence for a push.
pub(super) fn untouched(pair: &Pair) -> String {
    format!(
        "Repeat the same motion with nobody and nothing touching the arm, payload unchanged: a push does not come back, \
         {} does.",
        plainly(pair.rival.0)
    )
}

/// The sentence where no motion helps.
pub(super) fn without_motion(pair: &Pair) -> String {
    use CauseLabel::{JointElasticity, LinkInertial, Payload, RotorInertia, TimeDelay};
    let both = |a: CauseLabel, b: CauseLabel| pair.names(a) && pair.names(b);
    if both(Payload, LinkInertial) {
        "Weigh what the flange carries, or take it off and log the same motion again: no motion can tell it from a heavier \
         link."
            .to_owned()
    } else if both(RotorInertia, LinkInertial) {
        "Take the rotor inertia from the data sheet of the drive: no motion can tell it from inertia of the link on the \
         same axis."
            .to_owned()
    } else if both(TimeDelay, JointElasticity) {
        "Log the encoders of motor and link together: with one encoder no motion of the library tells a delay from \
         elasticity."
            .to_owned()
    } else {
        format!(
            "Measure {} or {} by other means: no motion of the library tells one from the other within the limits of this \
             arm.",
            plainly(pair.found.0),
            plainly(pair.rival.0)
        )
    }
}

/// `coulomb asymmetry`.
fn plainly(label: CauseLabel) -> String {
    label.name().replace('_', " ")
}

/// Slowest and fastest peak speed of the moves [rad/s].
fn speeds<const N: usize>(points: &ViaPoints<N>) -> [f64; 2] {
    let mut ends = [f64::INFINITY, 0.0];
    for (q, t) in points.q_rad.windows(2).zip(points.time_s.windows(2)) {
        for speed in ((q[1] - q[0]) * (PEAK_SPEED / (t[1] - t[0]))).iter().map(|speed| speed.abs()) {
            if speed > LEAST_RAD_S {
                ends = [ends[0].min(speed), ends[1].max(speed)];
            }
        }
    }
    ends
}

/// Number of moves that go nowhere.
fn holds<const N: usize>(points: &ViaPoints<N>) -> usize {
    points.q_rad.windows(2).filter(|pair| pair[0] == pair[1]).count()
}
