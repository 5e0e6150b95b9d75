//! A diagnosis as one JSON document, `tribo.diagnosis/1`.

use serde_json::{Map, Value, json};
use tribo_regression::{CauseLabel, Location};

use crate::{Alternative, Diagnosis, Finding, JointMisfit, NextExperiment, Rejected, Unseen};

/// What a run has to say besides the diagnosis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// Cost with the old and the extended model, where it was asked for.
    pub closed_loop: Option<Value>,
    /// What a compensator cannot cancel of the extended model, one sentence each.
    pub not_cancelled: Vec<String>,
    /// Files written: option and path.
    pub written: Vec<(&'static str, String)>,
    /// Why something that was asked for is missing.
    pub remarks: Vec<String>,
    /// Which columns were read as which, log by log.
    pub read_as: Vec<Value>,
}

/// The diagnosis as a JSON document, `tribo.diagnosis/1`: what `tribo diagnose --json` prints. A number that is not finite is null.
pub fn document(diagnosis: &Diagnosis, extras: &Extras) -> Value {
    let column = |pick: fn(&JointMisfit) -> f64| diagnosis.joints.iter().map(pick).collect::<Vec<f64>>();
    json!({
        "schema": "tribo.diagnosis/1",
        "verdict": diagnosis.verdict.name(),
        "findings": diagnosis.findings.iter().map(finding).collect::<Vec<_>>(),
        "rms_nm": {
            "before": column(|joint| joint.rms_nm),
            "after": column(|joint| joint.rms_after_nm),
            "held_out_before": column(|joint| joint.held_out_nm[0]),
            "held_out_after": column(|joint| joint.held_out_nm[1]),
        },
        "gain_heldout": diagnosis.gain_heldout,
        "gain_heldout_ci95": diagnosis.gain_heldout_ci95,
        "unseen": diagnosis.unseen.as_ref().map(unseen),
        "predictive_sd_nm": diagnosis.predictive_sd_nm,
        "smoothing_rad_s": diagnosis.smoothing_rad_s,
        "sticks": diagnosis.sticks,
        "closed_loop": extras.closed_loop,
        "next_experiment": diagnosis.next_experiment.as_ref().map(next_experiment),
        "validation": diagnosis.validation.iter().map(|validation| json!({
            "log": validation.log,
            "before_nm": validation.before_nm,
            "after_nm": validation.after_nm,
            "plain_nm": validation.plain_nm,
            "full_nm": validation.full_nm,
            "inside95": validation.inside95,
            "gain": validation.gain,
            "gain_ci95": validation.gain_ci95,
        })).collect::<Vec<_>>(),
        "joints": diagnosis.joints.iter().map(joint).collect::<Vec<_>>(),
        "pattern": {
            "wrench": diagnosis.pattern.wrench,
            "gravity": diagnosis.pattern.gravity,
            "inertial": diagnosis.pattern.inertial,
        },
        "rejected": diagnosis.rejected.iter().map(rejected).collect::<Vec<_>>(),
        "assumptions": diagnosis.assumptions,
        "notes": diagnosis.notes,
        "remarks": extras.remarks,
        "logs": extras.read_as,
        "not_cancelled": extras.not_cancelled,
        "written": extras.written.iter().map(|(what, path)| ((*what).to_owned(), json!(path))).collect::<Map<_, _>>(),
        "bands": {"band_hz": diagnosis.band_hz, "rate_hz": diagnosis.rate_hz},
        "samples": diagnosis.samples,
        "bursts": diagnosis.bursts,
    })
}

/// An object that begins with `label`, `cause` (the same word under the name that model files have for it), `joint` and `link`.
fn located(label: CauseLabel, location: Location) -> Map<String, Value> {
    let (joint, link) = match location {
        Location::Joint(joint) => (Some(joint), None),
        Location::Link(link) => (None, Some(link)),
        Location::Arm => (None, None),
    };
    let name = json!(label.name());
    let entries = [("label", name.clone()), ("cause", name), ("joint", json!(joint)), ("link", json!(link))];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn with(mut object: Map<String, Value>, more: Value) -> Value {
    if let Value::Object(more) = more {
        object.extend(more);
    }
    Value::Object(object)
}

fn finding(finding: &Finding) -> Value {
    let mut params = Map::new();
    let mut params_ci95 = Map::new();
    for parameter in &finding.parameters {
        // A scalar stands for itself, a vector for its components.
        let (value, ci95) = match (&parameter.value[..], &parameter.ci95[..]) {
            ([value], [ci95]) => (json!(value), json!(ci95)),
            (values, ci95) => (json!(values), json!(ci95)),
        };
        params.insert(parameter.name.to_owned(), value);
        params_ci95.insert(parameter.name.to_owned(), ci95);
    }
    if let Some(signature) = &finding.signature {
        params.insert("signature".to_owned(), json!(signature));
    }
    let mut more = json!({
        "joints": finding.joints,
        "links": finding.links,
        "params": params,
        "params_ci95": params_ci95,
        "p_value": finding.p_value,
        "held_out_gain": finding.held_out_gain,
        "held_out_gain_ci95": finding.held_out_gain_ci95,
        "explained_rms_nm": finding.explained_rms_nm,
        "evidence": finding.evidence,
        "alternatives": finding.alternatives.iter().map(alternative).collect::<Vec<_>>(),
    });
    if finding.label == CauseLabel::ExternalContact {
        let said = finding.said();
        let value = |name: &str| said.iter().find(|parameter| parameter.name == name).map(|parameter| &parameter.value);
        more["wrench_by_robot"] =
            json!({"force_n": value("force_by_robot_n"), "moment_nm": value("moment_by_robot_nm")});
    }
    with(located(finding.label, finding.location), more)
}

/// RMS on held-out parts by model, and how the extended model compares with the better baseline.
fn unseen(unseen: &Unseen) -> Value {
    json!({
        "split": unseen.split,
        "nominal_nm": unseen.nominal_nm,
        "extended_nm": unseen.extended_nm,
        "plain_nm": unseen.plain_nm,
        "full_nm": unseen.full_nm,
        "better_baseline": unseen.better_baseline().0,
        "ratio_to_better_baseline": unseen.ratio(),
    })
}

fn alternative(rival: &Alternative) -> Value {
    with(located(rival.label, rival.location), json!({"evidence_gap": rival.evidence_gap, "why": rival.why}))
}

fn rejected(rejected: &Rejected) -> Value {
    let more = json!({"evidence": rejected.evidence, "reason": rejected.reason});
    with(located(rejected.label, rejected.location), more)
}

fn joint(joint: &JointMisfit) -> Value {
    json!({
        "rms_nm": joint.rms_nm,
        "bias_nm": joint.bias_nm,
        "unexplained": joint.unexplained,
        "noise_floor_nm": joint.noise_floor_nm,
        "goes_with": joint.goes_with.iter().map(|(name, part)| ((*name).to_owned(), json!(part))).collect::<Map<_, _>>(),
    })
}

fn next_experiment(next: &NextExperiment) -> Value {
    json!({
        "motion": next.motion,
        "instruction": next.instruction,
        "separates": next.separates.map(|(label, location)| located(label, location)),
        "expected_evidence": next.expected_evidence,
        "evidence_of_this_log": next.evidence_of_this_log,
        "via_points": next.via_points.iter().map(|(time_s, q)| json!({"time_s": time_s, "q_rad": q})).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use tribo_robot::JointNames;

    use super::*;
    use crate::{CrossJointPattern, Parameter, Validation, Verdict};

    fn sample() -> Diagnosis {
        let payload = Finding {
            label: CauseLabel::Payload,
            location: Location::Arm,
            joints: Vec::new(),
            links: Vec::new(),
            effect: None,
            parameters: vec![
                Parameter { name: "mass_kg", value: vec![0.85], ci95: vec![[0.83, 0.87]] },
                Parameter {
                    name: "com_m",
                    value: vec![0.0, 0.01, 0.06],
                    ci95: vec![[-0.01, 0.01], [0.0, 0.02], [0.05, 0.07]],
                },
            ],
            signature: None,
            p_value: 0.0005,
            held_out_gain: 0.62,
            held_out_gain_ci95: [0.58, 0.66],
            explained_rms_nm: 1.5,
            evidence: 5000.0,
            alternatives: vec![Alternative {
                label: CauseLabel::LinkInertial,
                location: Location::Link(6),
                evidence_gap: 4.5,
                why: "one body".to_owned(),
            }],
            plots: Vec::new(),
        };
        let unknown = Finding {
            label: CauseLabel::Unknown,
            location: Location::Joint(3),
            joints: vec![3],
            parameters: Vec::new(),
            signature: Some("position order 2".to_owned()),
            alternatives: Vec::new(),
            evidence: f64::NAN,
            ..payload.clone()
        };
        Diagnosis {
            verdict: Verdict::Unknown,
            findings: vec![payload, unknown],
            joint_names: JointNames::default(),
            joints: vec![JointMisfit {
                rms_nm: 0.5,
                bias_nm: -0.1,
                unexplained: 0.02,
                noise_floor_nm: 0.03,
                goes_with: [("velocity", 0.6), ("position", 0.2), ("load", 0.1), ("time", 0.0), ("reversals", 0.4)],
                rms_after_nm: 0.1,
                held_out_nm: [0.52, 0.12],
            }],
            pattern: CrossJointPattern { wrench: 0.4, gravity: 0.1, inertial: 0.7 },
            gain_heldout: 0.7,
            gain_heldout_ci95: [0.6, 0.8],
            validation: vec![Validation {
                log: "b.csv".to_owned(),
                before_nm: vec![0.4],
                after_nm: vec![0.1],
                plain_nm: vec![0.2],
                full_nm: vec![0.3],
                inside95: Some(0.95),
                gain: 0.75,
                gain_ci95: [0.7, 0.8],
            }],
            rejected: vec![Rejected {
                label: CauseLabel::Backlash,
                location: Location::Joint(0),
                evidence: None,
                reason: "no theta_0".to_owned(),
            }],
            extension: Vec::new(),
            smoothing_rad_s: None,
            sticks: false,
            unseen: Some(Unseen {
                split: "each log in turn",
                nominal_nm: vec![0.5],
                extended_nm: vec![0.1],
                plain_nm: vec![0.2],
                full_nm: vec![0.4],
            }),
            predictive_sd_nm: vec![0.11],
            assumptions: vec!["motor side".to_owned()],
            notes: vec!["short".to_owned()],
            next_experiment: Some(NextExperiment {
                motion: "slow_cruise",
                instruction: "Slowly.".to_owned(),
                separates: [(CauseLabel::Payload, Location::Arm), (CauseLabel::LinkInertial, Location::Link(6))],
                expected_evidence: 400.0,
                evidence_of_this_log: 4.5,
                via_points: vec![(0.0, vec![0.1, 0.2])],
            }),
            overview: Vec::new(),
            band_hz: 25.0,
            rate_hz: 62.5,
            samples: 2000,
            bursts: 3,
        }
    }

    /// Scripts read these keys: a change here is a change of the schema.
    #[test]
    fn the_document_is_as_it_was() {
        let extras = Extras {
            closed_loop: Some(json!({
                "cost_before": 24.0,
                "cost_after": 12.0,
                "tracking_rms_mm_before": 3.0,
                "tracking_rms_mm_after": 1.0,
                "tracking_rms_mrad_before": 9.0,
                "tracking_rms_mrad_after": 2.0,
                "reason_before": null,
                "reason_after": null,
            })),
            not_cancelled: vec!["time_delay is not cancelled: …".to_owned()],
            written: vec![("report", "r.html".to_owned())],
            remarks: vec!["a remark".to_owned()],
            read_as: vec![json!({"log": "a.csv", "read_as": null})],
        };
        let document = document(&sample(), &extras);
        let golden: Value = serde_json::from_str(include_str!("document_golden.json")).unwrap();
        // As text: the order of the keys is for people, and part of it.
        assert_eq!(format!("{document:#}"), format!("{golden:#}"));
    }

    #[test]
    fn what_was_not_asked_for_is_null() {
        let mut diagnosis = sample();
        diagnosis.next_experiment = None;
        let document = document(&diagnosis, &Extras::default());
        assert_eq!((&document["closed_loop"], &document["next_experiment"]), (&Value::Null, &Value::Null));
        assert_eq!(document["written"], json!({}));
    }
}
