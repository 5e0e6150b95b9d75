//! The compensator as a C99 header.

use tribo_friction::VelocitySource;

use super::float::{float, floats};
use super::program::Program;
use super::text::{in_comment, is_identifier};
use super::{ExportError, Exported, TunedCompensator};

/// Prefix of the names where nobody gives one.
const PREFIX: &str = "tribo";

/// One `static inline` function in C99 that C++ takes as well, in need of `math.h` alone: `PREFIX_compensate`. Without
/// effects it maps two velocities to torques; with effects (see [`crate::Believed`]) it also takes position, load, period
/// and the bristles' memory. It is the compensator to rounding: 1e-12 Nm.
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>, name: Option<&str>) -> Result<Exported, ExportError> {
    let prefix = name.unwrap_or(PREFIX);
    if !is_identifier(prefix) || prefix.starts_with('_') {
        let allowed = "letters, digits and _, beginning with a letter";
        return Err(ExportError::Name { name: prefix.to_owned(), allowed });
    }
    let program = Program::of(tuned);
    let macros = prefix.to_uppercase();
    let mut text = String::from("/*\n");
    for remark in &program.remarks {
        text.push_str(&format!(" * {}\n", in_comment(remark)));
    }
    text.push_str(&format!(
        " */\n#ifndef {macros}_COMPENSATOR_H\n#define {macros}_COMPENSATOR_H\n\n#include <math.h>\n\n#define {macros}_JOINTS {N}\n\n"
    ));

    let vector = |name: &str| format!("const double {name}[{macros}_JOINTS]");
    let velocities = format!("{}, {}", vector("dq_measured"), vector("dq_reference"));
    let arguments = match program.effects {
        false => velocities,
        true => {
            format!("{}, {velocities}, {}, double dt, double z[{macros}_JOINTS]", vector("q"), vector("load"))
        }
    };
    text.push_str(&format!("static inline void {prefix}_compensate({arguments}, double tau[{macros}_JOINTS])\n{{\n"));
    for (table, values) in program.tables() {
        text.push_str(&format!("    static const double {table}[{macros}_JOINTS] = {{{}}};\n", floats(*values)));
    }
    text.push_str(&format!("    int j;\n    for (j = 0; j < {macros}_JOINTS; ++j) {{\n"));
    let statements = body(tuned, &program);
    for line in statements.iter().flat_map(|statement| statement.lines()) {
        text.push_str(&format!("    {}{line}\n", if line.starts_with(' ') { "" } else { "    " }));
    }
    text.push_str("    }\n");
    for unused in unused(tuned, &program) {
        text.push_str(&format!("    (void){unused};\n"));
    }
    text.push_str(&format!("}}\n\n#endif /* {macros}_COMPENSATOR_H */\n"));
    Ok(Exported { text, losses: program.losses })
}

/// The statements of the loop over joints.
fn body<const N: usize>(tuned: &TunedCompensator<N>, program: &Program<N>) -> Vec<String> {
    let velocity = match tuned.compensator.source {
        VelocitySource::Measured => "dq_measured[j]".to_owned(),
        VelocitySource::Reference => "dq_reference[j]".to_owned(),
        VelocitySource::Hybrid => format!(
            "fabs(dq_measured[j]) > {} ? dq_measured[j] : dq_reference[j]",
            float(tuned.compensator.hybrid_threshold_rad_s)
        ),
    };
    let mut statements = vec![format!("const double dq = {velocity};")];
    if program.uses("s") {
        let smoothing = tuned.compensator.smoothing_rad_s;
        statements.push(match smoothing > 0.0 {
            true => format!("const double s = tanh(dq / {});", float(smoothing)),
            false => "const double s = dq > 0.0 ? 1.0 : dq < 0.0 ? -1.0 : dq;".to_owned(),
        });
    }
    statements.extend(program.terms.iter().map(|term| term.c.clone()));
    statements.push("tau[j] = torque;".to_owned());
    statements
}

/// Arguments that this compensator does not need.
fn unused<const N: usize>(tuned: &TunedCompensator<N>, program: &Program<N>) -> Vec<&'static str> {
    let velocity = match tuned.compensator.source {
        VelocitySource::Measured => Some("dq_reference"),
        VelocitySource::Reference => Some("dq_measured"),
        VelocitySource::Hybrid => None,
    };
    let others = ["q", "load", "dt", "z"].into_iter().filter(|name| program.effects && !program.uses(name));
    velocity.into_iter().chain(others).collect()
}
