//! A parameter file for a controller of yours.

use tribo_friction::{JointEffects, MAX_BRISTLES, MAX_CURVES, MAX_RIPPLES, VelocitySource};

use super::columns::law_columns;
use super::float::float;
use super::loss::{controller_arm, not_cancelled};
use super::parameter_file::ParameterFile;
use super::program::REFERENCE;
use super::text::yaml_string;
use super::{ExportError, Exported, TunedCompensator};

/// The node that is meant where nobody names one.
const NODE: &str = "friction_compensator";

/// The effects that are numbers, by their names in the file.
type Scalar = (&'static str, fn(&JointEffects) -> f64);
const SCALARS: [Scalar; 10] = [
    ("coulomb_nm", |it| it.coulomb_nm),
    ("viscous_nm_s_per_rad", |it| it.viscous_nm_s_per_rad),
    ("breakaway_minus_coulomb_nm", |it| it.breakaway_minus_coulomb_nm),
    ("stribeck_velocity_rad_s", |it| it.stribeck_velocity_rad_s),
    ("asymmetry_nm", |it| it.asymmetry_nm),
    ("offset_nm", |it| it.offset_nm),
    ("load_coefficient", |it| it.load_coefficient),
    ("spring_nm_per_rad", |it| it.spring_nm_per_rad),
    ("spring_rest_rad", |it| it.spring_rest_rad),
    ("presliding_distance_rad", |it| it.presliding_distance_rad),
];

/// Everything of the compensator as ROS 2 parameters: `law`, `velocity_source`, `hybrid_threshold_rad_s`,
/// `smoothing_rad_s`, one array per parameter of the law under `friction`, and where the model has effects, one array per
/// number of them under `effects`, and one group each for the first ripples, curves and bristles of the joints, the second,
/// and so on (those of amplitude 0 are none).
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>, name: Option<&str>) -> Result<Exported, ExportError> {
    let mut losses = not_cancelled(tuned);
    losses.extend(controller_arm(tuned));
    let remarks = [
        format!("Friction compensation of {}.", tuned.robot),
        format!("{}.", tuned.origin),
        "One value per joint, from the base; SI units.".to_owned(),
        match tuned.compensator.source {
            VelocitySource::Measured => "The law is taken at the measured velocity.".to_owned(),
            VelocitySource::Reference => format!("The law is taken at the reference velocity. {REFERENCE}"),
            VelocitySource::Hybrid => format!(
                "The law is taken at the measured velocity above hybrid_threshold_rad_s, else at the reference velocity. {REFERENCE}"
            ),
        },
    ];
    let mut file = ParameterFile::new(name.unwrap_or(NODE), &remarks, &losses)?;
    let (law, columns) = law_columns(&tuned.compensator.friction);
    file.value("robot", &yaml_string(&tuned.robot));
    if let Some(names) = &tuned.joint_names {
        file.value("joints", &format!("[{}]", names.each_ref().map(|name| yaml_string(name)).join(", ")));
    }
    file.value("law", &yaml_string(law));
    file.value("velocity_source", &yaml_string(tuned.source_name()));
    file.value("hybrid_threshold_rad_s", &float(tuned.compensator.hybrid_threshold_rad_s));
    file.value("smoothing_rad_s", &float(tuned.compensator.smoothing_rad_s));
    file.open("friction");
    for (key, values) in columns {
        file.array(key, values);
    }
    file.close();
    if tuned.has_effects() {
        let effects = &tuned.compensator.effects;
        file.open("effects");
        for (key, value) in SCALARS {
            file.array(key, effects.iter().map(value));
        }
        for k in (0..MAX_RIPPLES).filter(|&k| effects.iter().any(|it| it.ripples[k].amplitude_nm != 0.0)) {
            file.open(&format!("ripple_{k}"));
            file.array("cycles_per_rev", effects.iter().map(|it| it.ripples[k].cycles_per_rev));
            file.array("amplitude_nm", effects.iter().map(|it| it.ripples[k].amplitude_nm));
            file.array("phase_rad", effects.iter().map(|it| it.ripples[k].phase_rad));
            file.close();
        }
        for k in (0..MAX_CURVES).filter(|&k| effects.iter().any(|it| it.curves[k].amplitude_nm != 0.0)) {
            file.open(&format!("curve_{k}"));
            file.array("amplitude_nm", effects.iter().map(|it| it.curves[k].amplitude_nm));
            file.array("width_rad_s", effects.iter().map(|it| it.curves[k].width_rad_s));
            file.close();
        }
        for k in (0..MAX_BRISTLES).filter(|&k| effects.iter().any(|it| it.bristles[k].amplitude_nm != 0.0)) {
            file.open(&format!("bristle_{k}"));
            file.array("amplitude_nm", effects.iter().map(|it| it.bristles[k].amplitude_nm));
            file.array("distance_rad", effects.iter().map(|it| it.bristles[k].distance_rad));
            file.close();
        }
    }
    Ok(Exported { text: file.into_text(), losses })
}
