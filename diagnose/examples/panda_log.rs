//! Diagnoses a link-side Panda log against the bare link model and prints what it finds.
#![allow(clippy::unwrap_used, reason = "an example")]
use tribo_diagnose::{DiagnoseSettings, Nominal, diagnose};
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_robot::presets;
use tribo_sim::TorqueSide;

fn main() {
    let path = std::env::args().nth(1).unwrap();
    let (log, _) = tribo_logs::read_log(std::path::Path::new(&path)).unwrap();
    let nominal = Nominal {
        arm: presets::panda().link_side(),
        friction: FrictionModel::uniform(CoulombViscous::default().into()),
        smoothing_rad_s: 0.005,
        effects: Vec::new(),
        torque_side: TorqueSide::Link,
    };
    let start = std::time::Instant::now();
    let stage = |s: &str, f: f64| {
        eprintln!("{:6.2} s {s} {f:.2}", start.elapsed().as_secs_f64());
        true
    };
    let d = diagnose::<7>(&[log], &nominal, &[], &DiagnoseSettings::default(), &stage).unwrap();
    println!("{:?} gain {:.3} {:?} band {} rate {} n {}", d.verdict, d.gain_heldout, d.gain_heldout_ci95, d.band_hz, d.rate_hz, d.samples);
    for f in &d.findings {
        println!("{} {} ev {:.0} p {:.1e} gain {:.3} [{:.3} {:.3}] rms {:.4} {:?}", f.label, f.location, f.evidence, f.p_value, f.held_out_gain, f.held_out_gain_ci95[0], f.held_out_gain_ci95[1], f.explained_rms_nm, f.signature);
        for p in &f.parameters {
            println!("     {} {:?} {:?}", p.name, p.value, p.ci95);
        }
        for a in &f.alternatives {
            println!("     or {} {} gap {:.1}", a.label, a.location, a.evidence_gap);
        }
    }
    for (j, m) in d.joints.iter().enumerate() {
        println!("J{j} rms {:.4} bias {:.3} unexpl {:.4} floor {:.4} after {:.4} heldout {:.4} -> {:.4} {:?}", m.rms_nm, m.bias_nm, m.unexplained, m.noise_floor_nm, m.rms_after_nm, m.held_out_nm[0], m.held_out_nm[1], m.goes_with);
    }
    println!("{:?} {:#?}\n{:#?}", d.pattern, d.notes, d.assumptions);
    for r in d.rejected.iter().take(12) {
        println!("rejected {} {} {:?} {}", r.label, r.location, r.evidence, r.reason);
    }
}
