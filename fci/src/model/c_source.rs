//! The model of version 5 as C.

use std::fmt::Write;

use nalgebra::Matrix3;
use tribo_robot::Arm;

/// Where the numbers of the arm are put in.
const NUMBERS: &str = "/* NUMBERS */";

/// C99 with the thirty functions of a Panda's model library (libfranka 0.9, `libfcimodels.h`): poses and Jacobians of the
/// joints, flange and end effector, mass matrix, Coriolis and gravity torque with a load; of the link side, as the
/// library's. Matrices column by column, Jacobians with linear rows first.
pub fn c_source(arm: &Arm<7>) -> String {
    let mut numbers = String::new();
    let list =
        |values: &mut dyn Iterator<Item = f64>| values.map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
    let rows = |matrix: &Matrix3<f64>| list(&mut matrix.transpose().iter().copied());
    let mut array = |name: &str, width: &str, entries: Vec<String>| {
        // Writing to a string cannot fail.
        let _ = writeln!(numbers, "static const double {name}[7]{width} = {{ {} }};", entries.join(", "));
    };
    let braced = |text: String| format!("{{ {text} }}");
    array("PLACED_R", "[9]", arm.placements.iter().map(|p| braced(rows(&p.rotation))).collect());
    array("PLACED_P", "[3]", arm.placements.iter().map(|p| braced(list(&mut p.translation.iter().copied()))).collect());
    array("MASS", "", arm.links.iter().map(|link| format!("{:?}", link.mass_kg)).collect());
    array("COM", "[3]", arm.links.iter().map(|link| braced(list(&mut link.com_m.iter().copied()))).collect());
    array("INERTIA", "[9]", arm.links.iter().map(|link| braced(rows(&link.inertia_kg_m2))).collect());
    let _ = writeln!(
        numbers,
        "static const double FLANGE_R[9] = {{ {} }};\nstatic const double FLANGE_P[3] = {{ {} }};",
        rows(&arm.link_from_flange_rotation),
        list(&mut arm.link_from_flange_translation.iter().copied())
    );
    include_str!("model.c").replace(NUMBERS, &numbers)
}
