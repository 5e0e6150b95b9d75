//! The compensator as a Rust module.

use super::bounds;
use super::float::floats;
use super::program::Program;
use super::text::in_comment;
use super::{ExportError, Exported, TunedCompensator};

/// A module without dependencies, `JOINTS` and `compensate`, as a file of its own or by `include!`. Without effects
/// `compensate` maps two velocities to torques; with effects (see [`tribo_model::ControllerModel`]) it also takes position, load, period
/// and the bristles' memory, `BRISTLES` numbers. It is the compensator to rounding, 1e-12 Nm, within the bounds of
/// [`super::bounds`].
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>) -> Result<Exported, ExportError> {
    let program = Program::of(tuned, "");
    let mut text = String::new();
    for remark in &program.remarks {
        text.push_str(&format!("// {}\n", in_comment(remark)));
    }
    text.push_str(&format!("\n/// Number of joints.\npub const JOINTS: usize = {N};\n\n"));
    if program.effects {
        let memory = program.memory;
        text.push_str(&format!("/// Number of bristles in the memory.\npub const BRISTLES: usize = {memory};\n\n"));
    }
    text.push_str(bounds::RUST_FUNCTIONS);
    text.push_str("/// Friction compensation torque (Nm) of every joint.\n#[allow(clippy::needless_range_loop)]\n");

    let argument = |name: &str, used: bool, kind: &str| format!("{}{name}: {kind}", if used { "" } else { "_" });
    let vector = "&[f64; JOINTS]";
    let mut arguments =
        vec![argument("dq_measured", program.takes[0], vector), argument("dq_reference", program.takes[1], vector)];
    if program.effects {
        arguments.insert(0, argument("q", program.uses("q"), vector));
        arguments.push(argument("load", program.uses("load"), vector));
        arguments.push(argument("dt", program.uses("dt"), "f64"));
        arguments.push(argument("z", program.uses("z"), "&mut [f64; BRISTLES]"));
    }
    text.push_str(&format!("pub fn compensate(\n    {},\n) -> [f64; JOINTS] {{\n", arguments.join(",\n    ")));
    for (table, values) in program.tables() {
        text.push_str(&format!("    const {}: [f64; JOINTS] = [{}];\n", table.to_uppercase(), floats(*values)));
    }
    text.push_str("    let mut tau = [0.0; JOINTS];\n    for j in 0..JOINTS {\n");
    for statement in body(&program) {
        text.push_str(&format!("        {statement}\n"));
    }
    text.push_str("    }\n    tau\n}\n");
    Ok(Exported { text, losses: program.losses })
}

/// The statements of the loop over joints.
fn body<const N: usize>(program: &Program<N>) -> Vec<String> {
    let mut statements: Vec<String> = program.opening.iter().map(|statement| statement.rust.clone()).collect();
    let law = &program.terms[0].rust;
    statements.push(if program.terms.len() > 1 { law.clone() } else { law.replacen("let mut", "let", 1) });
    statements.extend(program.terms[1..].iter().map(|term| term.rust.clone()));
    statements.push(bounds::closing("").rust);
    statements
}
