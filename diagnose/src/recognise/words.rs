//! Findings about a log in words.

use tribo_logs::recognise::{Fault, Remark, Severity};
use tribo_robot::JointNames;
use tribo_sim::TorqueSide;

use super::fit::Fit;
use super::hypothesis::Change;
use super::{ARM_GAIN, Found};

/// The remark on torques that never change.
pub(super) fn constant(joints: Vec<usize>, names: &JointNames) -> Remark {
    Remark::refuse(
        Fault::TorqueUnexplained,
        joints.clone(),
        format!("{}: the joints turn and their torque is the same in every row", names.several(&joints)),
        "look at the torque columns: it seems that nothing was ever written to them".to_owned(),
    )
}

/// The remark on torques of which the arm says nothing.
pub(super) fn unexplained<const N: usize>(fit: &Fit<N>, names: &JointNames) -> Remark {
    let joints = fit.explains_nothing_of();
    let left: Vec<String> = joints.iter().map(|j| format!("{:.2}", fit.left[*j])).collect();
    Remark::refuse(
        Fault::TorqueUnexplained,
        joints.clone(),
        format!(
            "{}: rigid arm and friction say no more of these torques than a constant would, {} Nm are left",
            names.several(&joints),
            left.join(", ")
        ),
        "look at the torque columns, at their noise and at the robot that is named".to_owned(),
    )
}

/// The remark on a finding; torques from which gravity was left out, and that hold next to nothing of the arm's weight, are
/// `weightless`.
pub(super) fn remark<const N: usize>(found: &Found<N>, weightless: bool, names: &JointNames) -> Remark {
    let left =
        |j: usize| format!("{:.2} Nm of it are left instead of {:.2} Nm", found.after.left[j], found.before.left[j]);
    let correlation = |j: usize, sign: f64| format!("correlation {:.2}", sign * found.after.correlation[j]);
    let in_all = || {
        let rms = |left: &[f64; N]| (left.iter().map(|x| x * x).sum::<f64>() / N as f64).sqrt();
        format!("{:.2} Nm RMS are left instead of {:.2} Nm", rms(&found.after.left), rms(&found.before.left))
    };
    let refuse = |fault, joints, evidence, remedy| Remark {
        severity: if found.surely { Severity::Refuse } else { Severity::Suspect },
        ..Remark::refuse(fault, joints, evidence, remedy)
    };
    let everything: Vec<usize> = (0..N).collect();
    let surely = found.before.leaves_over(&found.after, ARM_GAIN);
    let of_gravity = if surely || weightless { Remark::refuse } else { Remark::warn };
    match &found.change {
        Change::TorqueSign(j) | Change::PositionSign(j) if found.either_sign(*j) => refuse(
            Fault::TorqueOrPositionSign,
            vec![*j],
            format!("torque or position of {} has the opposite sign: {}", names.of(*j), left(*j)),
            format!("multiply column tau_J_{j}, or q_{j} and dq_{j}, by -1: this motion cannot tell which"),
        ),
        Change::TorqueSign(j) => refuse(
            Fault::TorqueSign,
            vec![*j],
            format!(
                "the torque of {} fits the model with the opposite sign: {}, {}",
                names.of(*j),
                correlation(*j, -1.0),
                left(*j)
            ),
            format!("multiply column tau_J_{j} by -1"),
        ),
        Change::AllTorqueSigns => refuse(
            Fault::TorqueSign,
            everything,
            format!("the torques of all joints fit the model with the opposite sign: {}", in_all()),
            "multiply the torques by -1: they are those by which the motors act on the arm".to_owned(),
        ),
        Change::PositionSign(j) => refuse(
            Fault::PositionSign,
            vec![*j],
            format!(
                "the torques fit the model with the opposite sign of the position of {}: {}",
                names.of(*j),
                in_all()
            ),
            format!("multiply columns q_{j} and dq_{j} by -1"),
        ),
        Change::AxisSign(j) => refuse(
            Fault::AxisSign,
            vec![*j],
            format!("the log fits the model with the axis of {} pointing the other way: {}", names.of(*j), in_all()),
            format!("multiply columns q_{j}, dq_{j} and tau_J_{j} by -1, or turn the axis in the model"),
        ),
        Change::TorquesSwapped(a, b) => refuse(
            Fault::JointOrder,
            vec![*a, *b],
            format!("the torques of {} fit the model in each other's place: {}", names.several(&[*a, *b]), in_all()),
            format!("exchange columns tau_J_{a} and tau_J_{b}"),
        ),
        Change::PositionsSwapped(a, b) => refuse(
            Fault::JointOrder,
            vec![*a, *b],
            format!(
                "the log fits the model with the positions of {} in each other's place: {}",
                names.several(&[*a, *b]),
                in_all()
            ),
            format!("exchange columns q_{a} and q_{b}, and dq_{a} and dq_{b}"),
        ),
        Change::JointsSwapped(a, b) => refuse(
            Fault::JointOrder,
            vec![*a, *b],
            format!("the log fits the model with {} in each other's place: {}", names.several(&[*a, *b]), in_all()),
            format!("exchange the columns of {}", names.several(&[*a, *b])),
        ),
        Change::TorquesCycled([a, b, c]) => refuse(
            Fault::JointOrder,
            vec![*a, *b, *c],
            format!(
                "the torques of {} fit the model when each is moved to the next: {}",
                names.several(&[*a, *b, *c]),
                in_all()
            ),
            format!(
                "column tau_J_{b} holds the torque of {}, tau_J_{c} that of {}, tau_J_{a} that of {}",
                names.of(*a),
                names.of(*b),
                names.of(*c)
            ),
        ),
        Change::PositionsCycled([a, b, c]) | Change::JointsCycled([a, b, c]) => refuse(
            Fault::JointOrder,
            vec![*a, *b, *c],
            format!(
                "the log fits the model when the {} of {} are moved each to the next: {}",
                if matches!(found.change, Change::JointsCycled(_)) { "columns" } else { "positions" },
                names.several(&[*a, *b, *c]),
                in_all()
            ),
            format!(
                "column q_{b} holds the position of {}, q_{c} that of {}, q_{a} that of {}",
                names.of(*a),
                names.of(*b),
                names.of(*c)
            ),
        ),
        Change::JointsReversed => refuse(
            Fault::JointOrder,
            everything,
            format!("the log fits the model with the joints in the opposite order: {}", in_all()),
            format!("{} is the one at the base, {} the one at the tool", names.of(0), names.of(N - 1)),
        ),
        Change::Degrees => refuse(
            Fault::Degrees,
            everything,
            format!("the torques fit the model with positions in degrees: {}", in_all()),
            "multiply columns q_i and dq_i by pi/180".to_owned(),
        ),
        Change::JointDegrees(j) => refuse(
            Fault::Degrees,
            vec![*j],
            format!("the torques fit the model with the position of {} in degrees: {}", names.of(*j), in_all()),
            format!("multiply columns q_{j} and dq_{j} by pi/180"),
        ),
        Change::TorqueFactor(factor) => refuse(
            Fault::TorqueUnit,
            everything,
            format!("the torques are {factor:.4} times those of the model: {}", in_all()),
            match (factor / 1e3).ln().abs() < 0.2 {
                true => "they are in mNm, it seems: divide them by 1000".to_owned(),
                false => {
                    "look at their unit, at gear ratios and torque constants, and at the model's masses".to_owned()
                }
            },
        ),
        Change::JointTorqueFactor(j, factor) => refuse(
            Fault::TorqueUnit,
            vec![*j],
            format!("the torque of {} is {factor:.4} times that of the model: {}", names.of(*j), left(*j)),
            format!("look at the unit of tau_J_{j}, at the gear ratio and the torque constant"),
        ),
        Change::NoGravity => of_gravity(
            Fault::GravityMissing,
            everything,
            format!("the torques fit the model without gravity: {}", in_all()),
            "the weight of the arm is left out of them: add g(q), or log the whole torque; \
             a campaign can begin with --torque commanded_without_gravity"
                .to_owned(),
        ),
        Change::Gravity(g) => of_gravity(
            Fault::GravityDirection,
            everything,
            format!(
                "the torques fit the model with gravity along ({:.1}, {:.1}, {:.1}) m/s²: {}",
                g.x,
                g.y,
                g.z,
                in_all()
            ),
            "the base is mounted another way: say so with gravity_m_s2 in the model file".to_owned(),
        ),
        Change::OtherSide(side) => {
            let (side, option) = match side {
                TorqueSide::Link => ("link", "link"),
                TorqueSide::Motor => ("motor", "motor"),
            };
            Remark::warn(
                Fault::TorqueSide,
                everything,
                format!("the torques look like those of the {side} side of the gears: {}", in_all()),
                format!("say --torque-side {option}, or torque_side: {option} in the model file, if they are"),
            )
        }
        Change::OtherRobot(name) => refuse(
            Fault::OtherRobot,
            everything,
            format!("the log fits the arm {name} better than the model: {}", in_all()),
            format!("say --robot {name} if it is that one"),
        ),
    }
}

impl<const N: usize> Found<N> {
    /// Whether torque and position of a joint explain the log alike with the opposite sign.
    fn either_sign(&self, joint: usize) -> bool {
        let signs = [Change::TorqueSign(joint), Change::PositionSign(joint)];
        signs.contains(&self.change) && self.rivals.iter().any(|rival| signs.contains(rival))
    }
}
