//! Friction of the gears, where `tribo estimate` finds torque on both of their sides.

use serde_json::{Value, json};
use tribo_logs::LogSummary;
use tribo_robot::JointNames;
use tribo_trial::TransmissionFriction;

use crate::arguments::Common;
use crate::output::{log_json, print, print_json, significant, table};

/// The table of a log that nobody gave a model for.
pub fn show_alone(gears: &TransmissionFriction, summary: &LogSummary, common: &Common) {
    if common.json {
        print_json(&json!({
            "schema": "tribo.estimate/1",
            "log": log_json(summary),
            "estimators": {},
            "torque_residual": null,
            "transmission": json(gears),
        }));
    } else if !common.quiet {
        print(summary);
        show(gears, &JointNames::default());
        print("No --model: what the arm takes and the wrench at the tool are left out.");
    }
}

/// What the gears take, before and after the fit.
pub fn show(gears: &TransmissionFriction, names: &JointNames) {
    print(format_args!(
        "\nFriction of the gears: tau_J less tau_link [Nm], {} Hz band, {} samples",
        significant(gears.band_hz, 3),
        gears.samples
    ));
    let mut rows = table(&["joint", "rms", "rms after fit", "Fc [Nm]", "Fv [Nm s/rad]", "offset [Nm]"]);
    for (number, joint) in gears.joints.iter().enumerate() {
        let mut row = vec![names.of(number).to_string(), significant(joint.rms_before_nm, 3)];
        match &joint.fit {
            Ok((fit, rms_after_nm)) => {
                let apart = |value: f64| if joint.one_way() { "-".to_owned() } else { significant(value, 3) };
                row.extend([
                    significant(*rms_after_nm, 3),
                    apart(fit.coulomb_nm),
                    significant(fit.viscous_nm_s_per_rad, 3),
                    apart(fit.offset_nm),
                ]);
            }
            Err(_) => row.extend(std::iter::repeat_n("-".to_owned(), 4)),
        }
        rows.add_row(row);
    }
    print(rows);
    for (number, joint) in gears.joints.iter().enumerate() {
        match &joint.fit {
            Err(error) => print(format_args!("{}: {error}", names.of(number))),
            Ok(_) if joint.one_way() => {
                print(format_args!(
                    "{} turned one way only: its Coulomb friction and its offset are one number",
                    names.of(number)
                ));
            }
            Ok(_) => {}
        }
    }
}

/// The same for programs.
pub fn json(gears: &TransmissionFriction) -> Value {
    let joint = |(number, joint): (usize, &tribo_trial::TransmissionJoint)| {
        let fit = joint.fit.as_ref().ok();
        json!({
            "joint": number,
            "rms_before_nm": joint.rms_before_nm,
            "rms_after_nm": fit.map(|(_, rms_after_nm)| rms_after_nm),
            "fit": fit.map(|(fit, _)| json!({
                "coulomb_nm": fit.coulomb_nm,
                "viscous_nm_s_per_rad": fit.viscous_nm_s_per_rad,
                "offset_nm": fit.offset_nm,
            })),
            "one_way": joint.one_way(),
            "reason": joint.fit.as_ref().err().map(ToString::to_string),
        })
    };
    json!({
        "band_hz": gears.band_hz,
        "samples": gears.samples,
        "smoothing_rad_s": gears.smoothing_rad_s,
        "joints": gears.joints.iter().enumerate().map(joint).collect::<Vec<_>>(),
    })
}
