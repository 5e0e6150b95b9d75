//! The compensator as a C99 header.

use super::bounds;
use super::float::floats;
use super::program::Program;
use super::text::{in_comment, is_identifier};
use super::{ExportError, Exported, TunedCompensator};

/// Prefix of the names where nobody gives one.
const PREFIX: &str = "tribo";

/// One `static inline` function in C99 that C++ takes as well, in need of the standard library alone: `PREFIX_compensate`. Without
/// effects it maps two velocities to torques; with effects (see [`tribo_model::ControllerModel`]) it also takes position, load, period
/// and the bristles' memory, `PREFIX_BRISTLES` numbers. It is the compensator to rounding, 1e-12 Nm,
/// within the bounds of [`super::bounds`].
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>, name: Option<&str>) -> Result<Exported, ExportError> {
    let prefix = name.unwrap_or(PREFIX);
    if !is_identifier(prefix) || prefix.starts_with('_') {
        let allowed = "letters, digits and _, beginning with a letter";
        return Err(ExportError::Name { name: prefix.to_owned(), allowed });
    }
    let program = Program::of(tuned, prefix);
    let macros = prefix.to_uppercase();
    let mut text = String::from("/*\n");
    for remark in &program.remarks {
        text.push_str(&format!(" * {}\n", in_comment(remark)));
    }
    text.push_str(&format!(
        " */\n#ifndef {macros}_COMPENSATOR_H\n#define {macros}_COMPENSATOR_H\n\n#include <math.h>\n#include <stdint.h>\n#include <string.h>\n\n#define {macros}_JOINTS {N}\n"
    ));
    if program.effects {
        text.push_str(&format!("#define {macros}_BRISTLES {}\n", program.memory));
    }
    text.push('\n');
    text.push_str(&bounds::c_functions(prefix));

    let vector = |name: &str| format!("const double {name}[{macros}_JOINTS]");
    let velocities = format!("{}, {}", vector("dq_measured"), vector("dq_reference"));
    let arguments = match program.effects {
        false => velocities,
        true => {
            format!("{}, {velocities}, {}, double dt, double z[{macros}_BRISTLES]", vector("q"), vector("load"))
        }
    };
    text.push_str(&format!("static inline void {prefix}_compensate({arguments}, double tau[{macros}_JOINTS])\n{{\n"));
    for (table, values) in program.tables() {
        text.push_str(&format!("    static const double {table}[{macros}_JOINTS] = {{{}}};\n", floats(*values)));
    }
    text.push_str(&format!("    int j;\n    for (j = 0; j < {macros}_JOINTS; ++j) {{\n"));
    let statements = body(&program, prefix);
    for line in statements.iter().flat_map(|statement| statement.lines()) {
        text.push_str(&format!("    {}{line}\n", if line.starts_with(' ') { "" } else { "    " }));
    }
    text.push_str("    }\n");
    for unused in unused(&program) {
        text.push_str(&format!("    (void){unused};\n"));
    }
    text.push_str(&format!("}}\n\n#endif /* {macros}_COMPENSATOR_H */\n"));
    Ok(Exported { text, losses: program.losses })
}

/// The statements of the loop over joints.
fn body<const N: usize>(program: &Program<N>, prefix: &str) -> Vec<String> {
    let mut statements: Vec<String> = program.opening.iter().map(|statement| statement.c.clone()).collect();
    statements.extend(program.terms.iter().map(|term| term.c.clone()));
    statements.push(bounds::closing(prefix).c);
    statements
}

/// Arguments that this compensator does not need.
fn unused<const N: usize>(program: &Program<N>) -> Vec<&'static str> {
    let velocities = ["dq_measured", "dq_reference"].into_iter().zip(program.takes).filter(|(_, takes)| !takes);
    let others = ["q", "load", "dt", "z"].into_iter().filter(|name| program.effects && !program.uses(name));
    velocities.map(|(name, _)| name).chain(others).collect()
}
