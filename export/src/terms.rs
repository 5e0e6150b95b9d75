//! The terms of a compensator, each in C and in Rust side by side.

use tribo_friction::{JointEffects, MAX_BRISTLES, MAX_CURVES, MAX_RIPPLES, VelocitySource};

use super::TunedCompensator;
use super::columns::law_columns;
use super::float::{MOST_FINITE, float};

/// One term of the torque of joint j: its tables, one value per joint, and the statement that adds it to `torque`, in both
/// languages. Statements know `j`, `dq` [rad/s], `s` (the smoothed sign of dq), `q_j` (rad), `load_j` (Nm), `step` (s), all of
/// them finite ([`super::bounds`]), and the bristles `z`, those of whole joints first, then those of parts ([`memory`]); tables
/// have their name in capitals in Rust.
pub(super) struct Term<const N: usize> {
    /// Name and values of the tables.
    pub tables: Vec<(String, [f64; N])>,
    /// The formula, for people.
    pub formula: &'static str,
    /// In C.
    pub c: String,
    /// In Rust.
    pub rust: String,
}

/// A statement in both languages.
pub(super) struct Statement {
    /// In C.
    pub c: String,
    /// In Rust.
    pub rust: String,
}

/// `dq`, the velocity that the compensator believes; the hybrid one takes a measurement that is finite.
pub(super) fn velocity<const N: usize>(tuned: &TunedCompensator<N>, prefix: &str) -> Statement {
    let threshold = float(tuned.compensator.hybrid_threshold_rad_s);
    let (c, rust) = match tuned.compensator.source {
        VelocitySource::Measured => ("dq_measured[j]".to_owned(), "dq_measured[j]".to_owned()),
        VelocitySource::Reference => ("dq_reference[j]".to_owned(), "dq_reference[j]".to_owned()),
        VelocitySource::Hybrid => (
            format!(
                "{prefix}_within(&dq_measured[j], {MOST_FINITE}) && fabs(dq_measured[j]) > {threshold}\n        \
                 ? dq_measured[j] : dq_reference[j]"
            ),
            format!(
                "if within(dq_measured[j], f64::MAX) && dq_measured[j].abs() > {threshold} {{ dq_measured[j] }} \
                 else {{ dq_reference[j] }}"
            ),
        ),
    };
    Statement { c: format!("const double dq = {c};"), rust: format!("let dq = {rust};") }
}

/// `s`, the smoothed sign of `dq`.
pub(super) fn sign<const N: usize>(tuned: &TunedCompensator<N>) -> Statement {
    let smoothing = tuned.compensator.smoothing_rad_s;
    let (c, rust) = match smoothing > 0.0 {
        true => (format!("tanh(dq / {})", float(smoothing)), format!("(dq / {}).tanh()", float(smoothing))),
        false => {
            ("dq > 0.0 ? 1.0 : dq < 0.0 ? -1.0 : dq".to_owned(), "if dq == 0.0 { 0.0 } else { dq.signum() }".to_owned())
        }
    };
    Statement { c: format!("const double s = {c};"), rust: format!("let s = {rust};") }
}

/// The law, which begins `torque`.
pub(super) fn law_term<const N: usize>(tuned: &TunedCompensator<N>) -> Term<N> {
    let (name, mut columns) = law_columns(&tuned.compensator.friction);
    let (formula, c, rust) = match name {
        "stribeck" => (
            "Fv dq + (Fc + dF exp(-(|dq| inverse)^shape)) s",
            "viscous_nm_s_per_rad[j] * dq\n        + (coulomb_nm[j] + breakaway_minus_coulomb_nm[j]\n            \
             * exp(-pow(fabs(inverse_stribeck_velocity_s_per_rad[j] * dq), shape[j]))) * s",
            "VISCOUS_NM_S_PER_RAD[j] * dq\n            + (COULOMB_NM[j] + BREAKAWAY_MINUS_COULOMB_NM[j]\n                \
             * (-(INVERSE_STRIBECK_VELOCITY_S_PER_RAD[j] * dq).abs().powf(SHAPE[j])).exp()) * s",
        ),
        "gaz_sigmoid" => (
            "phi1 / (1 + exp(-phi2 (dq + phi3))) - phi1 / (1 + exp(-phi2 phi3))",
            "phi1_nm[j] * (1.0 / (1.0 + exp(-phi2_s_per_rad[j] * (dq + phi3_rad_s[j])))\n        \
             - 1.0 / (1.0 + exp(-phi2_s_per_rad[j] * phi3_rad_s[j])))",
            "PHI1_NM[j] * (1.0 / (1.0 + (-PHI2_S_PER_RAD[j] * (dq + PHI3_RAD_S[j])).exp())\n            \
             - 1.0 / (1.0 + (-PHI2_S_PER_RAD[j] * PHI3_RAD_S[j]).exp()))",
        ),
        "asymmetric" => (
            "Fv dq + Fc s, with Fv and Fc by the direction of motion",
            "(dq >= 0.0 ? viscous_positive_nm_s_per_rad[j] : viscous_negative_nm_s_per_rad[j]) * dq\n        \
             + 0.5 * (coulomb_positive_nm[j] + coulomb_negative_nm[j]) * s\n        \
             + 0.5 * (coulomb_positive_nm[j] - coulomb_negative_nm[j]) * fabs(s)",
            "(if dq >= 0.0 { VISCOUS_POSITIVE_NM_S_PER_RAD[j] } else { VISCOUS_NEGATIVE_NM_S_PER_RAD[j] }) * dq\n            \
             + 0.5 * (COULOMB_POSITIVE_NM[j] + COULOMB_NEGATIVE_NM[j]) * s\n            \
             + 0.5 * (COULOMB_POSITIVE_NM[j] - COULOMB_NEGATIVE_NM[j]) * s.abs()",
        ),
        // A compensator takes the steady sliding torque of bristles.
        _ => {
            columns.retain(|(key, _)| *key != "presliding_distance_rad");
            (
                "Fv dq + Fc s",
                "viscous_nm_s_per_rad[j] * dq + coulomb_nm[j] * s",
                "VISCOUS_NM_S_PER_RAD[j] * dq + COULOMB_NM[j] * s",
            )
        }
    };
    let tables = columns.into_iter().map(|(key, values)| (key.to_owned(), values)).collect();
    Term { tables, formula, c: format!("double torque = {c};"), rust: format!("let mut torque = {rust};") }
}

/// The effects that any joint has.
pub(super) fn effect_terms<const N: usize>(tuned: &TunedCompensator<N>, prefix: &str) -> Vec<Term<N>> {
    let effects = &tuned.compensator.effects;
    let column = |name: &str, value: &dyn Fn(&JointEffects) -> f64| {
        (format!("added_{name}"), std::array::from_fn(|j| value(&effects[j])))
    };
    let coulomb = || column("coulomb_nm", &|it| it.coulomb_nm);
    let presliding = column("presliding_distance_rad", &|it| it.presliding_distance_rad);
    let slides = presliding.1.iter().any(|distance| *distance > 0.0);
    let term = |tables: Vec<(String, [f64; N])>, formula, c: &str, rust: &str| Term {
        tables,
        formula,
        c: c.to_owned(),
        rust: rust.to_owned(),
    };
    let mut terms = vec![
        term(vec![coulomb()], "dFc s", "torque += added_coulomb_nm[j] * s;", "torque += ADDED_COULOMB_NM[j] * s;"),
        term(
            vec![column("viscous_nm_s_per_rad", &|it| it.viscous_nm_s_per_rad)],
            "dFv dq",
            "torque += added_viscous_nm_s_per_rad[j] * dq;",
            "torque += ADDED_VISCOUS_NM_S_PER_RAD[j] * dq;",
        ),
        term(
            vec![
                column("breakaway_minus_coulomb_nm", &|it| it.breakaway_minus_coulomb_nm),
                // Where there is no bump its speed matters nothing, but must not be zero.
                column("stribeck_velocity_rad_s", &|it| {
                    if it.breakaway_minus_coulomb_nm == 0.0 { 1.0 } else { it.stribeck_velocity_rad_s }
                }),
            ],
            "dF exp(-(dq / vs)^2) s",
            "{\n        const double x = dq / added_stribeck_velocity_rad_s[j];\n        \
             torque += added_breakaway_minus_coulomb_nm[j] * exp(-x * x) * s;\n    }",
            "let x = dq / ADDED_STRIBECK_VELOCITY_RAD_S[j];\n        \
             torque += ADDED_BREAKAWAY_MINUS_COULOMB_NM[j] * (-x * x).exp() * s;",
        ),
        term(
            vec![column("asymmetry_nm", &|it| it.asymmetry_nm)],
            "a |s|",
            "torque += added_asymmetry_nm[j] * fabs(s);",
            "torque += ADDED_ASYMMETRY_NM[j] * s.abs();",
        ),
        term(
            vec![column("offset_nm", &|it| it.offset_nm)],
            "offset",
            "torque += added_offset_nm[j];",
            "torque += ADDED_OFFSET_NM[j];",
        ),
        term(
            vec![column("load_coefficient", &|it| it.load_coefficient)],
            "gamma |load| s",
            "torque += added_load_coefficient[j] * fabs(load_j) * s;",
            "torque += ADDED_LOAD_COEFFICIENT[j] * load_j.abs() * s;",
        ),
        term(
            vec![
                column("spring_nm_per_rad", &|it| it.spring_nm_per_rad),
                column("spring_rest_rad", &|it| it.spring_rest_rad),
            ],
            "k (q - rest)",
            "torque += added_spring_nm_per_rad[j] * (q_j - added_spring_rest_rad[j]);",
            "torque += ADDED_SPRING_NM_PER_RAD[j] * (q_j - ADDED_SPRING_REST_RAD[j]);",
        ),
    ];
    for k in 0..MAX_RIPPLES {
        let name = |part: &str| format!("ripple_{k}_{part}");
        let [amplitude, cycles, phase] = ["amplitude_nm", "cycles_per_rev", "phase_rad"].map(name);
        let upper = |name: &str| format!("added_{name}").to_uppercase();
        let c = format!("torque += added_{amplitude}[j] * sin(added_{cycles}[j] * q_j + added_{phase}[j]);");
        let rust =
            format!("torque += {}[j] * ({}[j] * q_j + {}[j]).sin();", upper(&amplitude), upper(&cycles), upper(&phase));
        let tables = vec![
            column(&amplitude, &|it| it.ripples[k].amplitude_nm),
            column(&cycles, &|it| it.ripples[k].cycles_per_rev),
            column(&phase, &|it| it.ripples[k].phase_rad),
        ];
        terms.push(Term { tables, formula: "A sin(n q + phase)", c, rust });
    }
    for k in 0..MAX_CURVES {
        let [amplitude, width] = ["amplitude_nm", "width_rad_s"].map(|part| format!("curve_{k}_{part}"));
        let tables = vec![
            column(&amplitude, &|it| it.curves[k].amplitude_nm),
            // Where there is no curve its width matters nothing, but must not be zero.
            column(&width, &|it| if it.curves[k].amplitude_nm == 0.0 { 1.0 } else { it.curves[k].width_rad_s }),
        ];
        let [c_amplitude, c_width] = [&tables[0].0, &tables[1].0];
        let c = format!("torque += {c_amplitude}[j] * tanh(dq / {c_width}[j]);");
        let [amplitude, width] = [c_amplitude.to_uppercase(), c_width.to_uppercase()];
        let rust = format!("torque += {amplitude}[j] * (dq / {width}[j]).tanh();");
        terms.push(Term { tables, formula: "A tanh(dq / w)", c, rust });
    }
    // The first table of a term is its size.
    let any = |term: &Term<N>| term.tables[0].1.iter().any(|size| *size != 0.0);
    terms.retain(any);
    if slides {
        terms.push(presliding_term(tuned, prefix, presliding, coulomb()));
    }
    terms.extend((0..MAX_BRISTLES).map(|k| part_term(tuned, prefix, k)).filter(any));
    terms
}

/// Bristles in the memory: one per joint, and one more per joint for every part of dry friction that any joint has.
pub(super) fn memory<const N: usize>(tuned: &TunedCompensator<N>) -> usize {
    let effects = &tuned.compensator.effects;
    let used = |k: &usize| effects.iter().any(|it| it.bristles[*k].amplitude_nm != 0.0);
    N * (1 + (0..MAX_BRISTLES).rev().find(used).map_or(0, |last| last + 1))
}

/// The k-th parts of dry friction, each behind a bristle of its own.
fn part_term<const N: usize>(tuned: &TunedCompensator<N>, prefix: &str, k: usize) -> Term<N> {
    let effects = &tuned.compensator.effects;
    let (amplitude, distance) = (format!("added_bristle_{k}_amplitude_nm"), format!("added_bristle_{k}_distance_rad"));
    let (upper_amplitude, upper_distance) = (amplitude.to_uppercase(), distance.to_uppercase());
    let first = N * (k + 1);
    let c = format!(
        "if ({amplitude}[j] != 0.0) {{\n        \
         const double way = dq > 0.0 ? 1.0 : dq < 0.0 ? -1.0 : 0.0;\n        \
         double *const part = &z[{first} + j];\n        \
         *part = way + ({prefix}_bounded(part, 1.0) - way) * exp(-fabs(dq) * step / {distance}[j]);\n        \
         torque += {amplitude}[j] * (*part - s);\n    }}"
    );
    let rust = format!(
        "if {upper_amplitude}[j] != 0.0 {{\n            \
         let way = if dq == 0.0 {{ 0.0 }} else {{ dq.signum() }};\n            \
         let part = &mut z[{first} + j];\n            \
         *part = way + (bounded(*part, 1.0) - way) * (-dq.abs() * step / {upper_distance}[j]).exp();\n            \
         torque += {upper_amplitude}[j] * (*part - s);\n        }}"
    );
    let tables = vec![
        (amplitude, effects.each_ref().map(|it| it.bristles[k].amplitude_nm)),
        (distance, effects.each_ref().map(|it| it.bristles[k].distance_rad)),
    ];
    Term { tables, formula: "b (z_b - s)", c, rust }
}

/// Presliding: dry friction follows a bristle in place of s, integrated exactly over each period.
fn presliding_term<const N: usize>(
    tuned: &TunedCompensator<N>,
    prefix: &str,
    distance: (String, [f64; N]),
    added_coulomb: (String, [f64; N]),
) -> Term<N> {
    let (c_coulomb, rust_coulomb) = match law_columns(&tuned.compensator.friction).0 {
        "gaz_sigmoid" => ("0.0", "0.0"),
        "asymmetric" => (
            "(dq < 0.0 ? coulomb_negative_nm[j] : coulomb_positive_nm[j])",
            "if dq < 0.0 { COULOMB_NEGATIVE_NM[j] } else { COULOMB_POSITIVE_NM[j] }",
        ),
        _ => ("coulomb_nm[j]", "COULOMB_NM[j]"),
    };
    let c = format!(
        "if (added_presliding_distance_rad[j] > 0.0) {{\n        \
         const double way = dq > 0.0 ? 1.0 : dq < 0.0 ? -1.0 : 0.0;\n        \
         const double coulomb = {c_coulomb} + added_coulomb_nm[j];\n        \
         z[j] = way + ({prefix}_bounded(&z[j], 1.0) - way) * exp(-fabs(dq) * step / added_presliding_distance_rad[j]);\n        \
         torque += coulomb * (z[j] - s);\n    }}"
    );
    let rust = format!(
        "if ADDED_PRESLIDING_DISTANCE_RAD[j] > 0.0 {{\n            \
         let way = if dq == 0.0 {{ 0.0 }} else {{ dq.signum() }};\n            \
         let coulomb = ({rust_coulomb}) + ADDED_COULOMB_NM[j];\n            \
         z[j] = way + (bounded(z[j], 1.0) - way) * (-dq.abs() * step / ADDED_PRESLIDING_DISTANCE_RAD[j]).exp();\n            \
         torque += coulomb * (z[j] - s);\n        }}"
    );
    Term { tables: vec![distance, added_coulomb], formula: "Fc (z - s)", c, rust }
}
