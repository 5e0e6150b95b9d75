//! The parameters of a law as one array per parameter.

use tribo_friction::FrictionModel;

use tribo_model::{FrictionSection, LawName};

/// Name of the law, and name and values of each of its parameters, joint by joint from the base.
pub(super) fn law_columns<const N: usize>(
    friction: &FrictionModel<N>,
) -> (&'static str, Vec<(&'static str, [f64; N])>) {
    let section = FrictionSection::of(friction, 0.0);
    let rows: Vec<Vec<(&str, f64)>> = section.joints.iter().map(|joint| joint.given()).collect();
    let columns = (0..rows[0].len()).map(|k| (rows[0][k].0, std::array::from_fn(|j| rows[j][k].1))).collect();
    let name = match section.law {
        LawName::CoulombViscous => "coulomb_viscous",
        LawName::Stribeck => "stribeck",
        LawName::GazSigmoid => "gaz_sigmoid",
        LawName::Asymmetric => "asymmetric",
        LawName::Lugre => "lugre",
    };
    (name, columns)
}
