//! What keeps an exported compensator harmless, whatever it is given.
//!
//! ```text
//! |tau_j| <= most_j = 0.5 tau_max_j            always, by the bits of the number
//! tau_j = 0                                    where an input of the joint is not finite or beyond what robots have
//! dt <- 0 where it is not above 0, 1 s where it is longer;    z <- within +-1, 0 where it is not finite
//! ```
//!
//! Comparisons of bits hold where a compiler is told that nothing is ever NaN (`-ffast-math`); in C they look at memory that it must
//! read, since it may take an argument or a result for finite.

use super::float::MOST_FINITE;
use super::terms::Statement;
use super::{Loss, TunedCompensator};

/// Part of a joint's largest torque that compensation may take [-]; friction takes a tenth to a third of it.
const SHARE_OF_TAU_MAX: f64 = 0.5;
/// Where the arm is not known, the bound is the law's torque at this speed [rad/s], a turn per second: above what most arms reach.
const TOP_SPEED_RAD_S: f64 = std::f64::consts::TAU;
/// Arguments of a joint: the argument, the variable that statements use, and the largest size believed.
const ARGUMENTS: [(&str, &str, &str); 2] = [("q", "q_j", "1.0e+06"), ("load", "load_j", "1.0e+06")];
/// The largest velocity believed [rad/s].
const MOST_RAD_S: &str = "1.0e+03";

/// The largest torque (Nm) that joint's compensation has.
pub(super) fn most_nm<const N: usize>(tuned: &TunedCompensator<N>, joint: usize) -> f64 {
    match &tuned.arm {
        Some(arm) => SHARE_OF_TAU_MAX * arm.limits.tau_max_nm[joint],
        None => [TOP_SPEED_RAD_S, -TOP_SPEED_RAD_S]
            .map(|qd| tuned.sliding_torque_nm(joint, qd, tuned.compensator.smoothing_rad_s).abs())
            .into_iter()
            .fold(0.0, f64::max),
    }
}

/// What the bound takes away within the speed limits; nothing from most robots.
pub(super) fn cut_off<const N: usize>(tuned: &TunedCompensator<N>) -> Option<Loss> {
    tuned.arm.as_ref()?;
    let smoothing = tuned.compensator.smoothing_rad_s;
    let bounded =
        |j: usize, qd: f64| tuned.sliding_torque_nm(j, qd, smoothing).clamp(-most_nm(tuned, j), most_nm(tuned, j));
    let beyond = tuned.largest_difference_nm(smoothing, bounded);
    Loss::of_torque(format!("torques beyond {SHARE_OF_TAU_MAX} of the joints' largest"), "cut off there", beyond)
}

/// Lines for people.
pub(super) fn remarks<const N: usize>(tuned: &TunedCompensator<N>, effects: bool) -> Vec<String> {
    let most = match tuned.arm {
        Some(_) => format!("{SHARE_OF_TAU_MAX} of the joints' largest torques tau_max"),
        None => {
            format!("the torque of the law at {TOP_SPEED_RAD_S:.2} rad/s, as the joints' largest torques are not known")
        }
    };
    let others = if effects { ", q beyond 1e6 rad, load beyond 1e6 Nm" } else { "" };
    let mut lines = vec![
        format!("tau is within +- most_nm, always: {most}."),
        format!(
            "A joint with an input that is not finite, or absurd (dq beyond 1e3 rad/s{others}), gets the torque 0 and keeps its memory; \
             what is not used is not looked at. This holds with -ffast-math, too."
        ),
    ];
    if effects {
        lines.push("dt counts as 0 where it is negative or not finite, as 1 s where it is longer.".to_owned());
    }
    lines
}

/// The variable that stands for an argument in the statements.
pub(super) fn checked(argument: &str) -> &str {
    match argument {
        "dt" => "step",
        _ => ARGUMENTS.iter().find(|(name, ..)| *name == argument).map_or(argument, |(_, variable, _)| variable),
    }
}

/// The statements after `dq`: they leave a joint out whose inputs cannot be used, and name what the terms use.
pub(super) fn opening(prefix: &str, uses: impl Fn(&str) -> bool) -> Vec<Statement> {
    let used: Vec<_> = ARGUMENTS.iter().filter(|(_, variable, _)| uses(variable)).collect();
    let each = |function: &dyn Fn(&str, &str) -> String| -> Vec<String> {
        let arguments = used.iter().map(|(argument, _, most)| function(&format!("{argument}[j]"), most));
        [function("dq", MOST_RAD_S)].into_iter().chain(arguments).collect()
    };
    let c = each(&|value, most| format!("{prefix}_within(&{value}, {most})")).join(" && ");
    let rust = each(&|value, most| format!("within({value}, {most})")).join(" && ");
    let mut statements = vec![Statement {
        c: format!("if (!({c})) {{\n        tau[j] = 0.0;\n        continue;\n    }}"),
        rust: format!("if !({rust}) {{\n            continue;\n        }}"),
    }];
    statements.extend(used.iter().map(|(argument, variable, _)| Statement {
        c: format!("const double {variable} = {argument}[j];"),
        rust: format!("let {variable} = {argument}[j];"),
    }));
    if uses("step") {
        statements.push(Statement {
            c: format!(
                "const double step = {prefix}_within(&dt, {MOST_FINITE}) && dt > 0.0 ? (dt < 1.0 ? dt : 1.0) : 0.0;"
            ),
            rust: "let step = if within(dt, f64::MAX) && dt > 0.0 { dt.min(1.0) } else { 0.0 };".to_owned(),
        });
    }
    statements
}

/// The statement that hands the torque over.
pub(super) fn closing(prefix: &str) -> Statement {
    Statement {
        c: format!("tau[j] = {prefix}_bounded(&torque, most_nm[j]);"),
        rust: "tau[j] = bounded(torque, MOST_NM[j]);".to_owned(),
    }
}

/// `PREFIX_within` and `PREFIX_bounded`.
pub(super) fn c_functions(prefix: &str) -> String {
    format!(
        "/* Does not compile where double is not 64 bits. */\n\
         typedef char {prefix}_needs_64_bit_double[sizeof(double) == sizeof(uint64_t) ? 1 : -1];\n\n\
         /* Whether |value| <= bound; what is not a number is not. Numbers without sign are in the order of their bits. */\n\
         static inline int {prefix}_within(const double *value, double bound)\n{{\n    \
             const double read = *(const volatile double *)value;\n    \
             uint64_t bits, most;\n    \
             memcpy(&bits, &read, sizeof bits);\n    \
             memcpy(&most, &bound, sizeof most);\n    \
             return (bits & UINT64_C(0x7fffffffffffffff)) <= most;\n}}\n\n\
         /* The value within +- bound, 0 where it is not finite. */\n\
         static inline double {prefix}_bounded(const double *value, double bound)\n{{\n    \
             if ({prefix}_within(value, bound)) return *value;\n    \
             if (!{prefix}_within(value, {MOST_FINITE})) return 0.0;\n    \
             return *value > 0.0 ? bound : -bound;\n}}\n\n"
    )
}

/// The same in Rust.
pub(super) const RUST_FUNCTIONS: &str = "\
/// Whether |value| <= bound; what is not a number is not.
fn within(value: f64, bound: f64) -> bool {
    value.abs() <= bound
}

/// The value within ± bound, 0 where it is not finite.
fn bounded(value: f64, bound: f64) -> f64 {
    if value.is_finite() { value.max(-bound).min(bound) } else { 0.0 }
}

";
