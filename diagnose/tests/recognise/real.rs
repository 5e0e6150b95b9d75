//! The real logs in `$TRIBO_DATA`, each on the robot and the side of the gears that its README names.

use std::io::Write;
use std::path::{Path, PathBuf};

use tribo_diagnose::Diagnosable;
use tribo_diagnose::recognise::recognise;
use tribo_friction::FrictionModel;
use tribo_logs::read_log;
use tribo_logs::recognise::Use;
use tribo_regression::Nominal;
use tribo_robot::{Arm, presets, urdf};
use tribo_sim::TorqueSide;

use super::remarks;

fn nominal<const N: usize>(arm: Arm<N>, torque_side: TorqueSide) -> Nominal<N> {
    let arm = if torque_side == TorqueSide::Link { arm.link_side() } else { arm };
    Nominal { smoothing_rad_s: 0.005, ..Nominal::new(arm, FrictionModel::none(), torque_side) }
}

fn preset(name: &str) -> Arm<7> {
    presets::find(name).unwrap().with_joints::<7>().unwrap().arm.clone()
}

fn urdf<const N: usize>(path: &Path) -> Arm<N> {
    let chain = urdf::parse(&std::fs::read_to_string(path).unwrap(), None, None).unwrap();
    chain.arm::<N>().unwrap().arm
}

/// Lengths of parts of a log (s) that are asked like the whole.
const PARTS_S: [f64; 2] = [6.0, 12.0];

/// What is said of a log, and against the model of its parts: a wrist that carries nothing moves too little in some of them to tell anything, but
/// what it shows must not be told as a turned sign.
fn said(path: &Path, nominal: &impl Diagnosable) -> Vec<String> {
    let log = read_log(path).unwrap().0;
    let rows_per_s = (log.rows() - 1) as f64 / (log.time_s[log.rows() - 1] - log.time_s[0]);
    let parts = PARTS_S.into_iter().flat_map(|length_s| {
        let rows = (length_s * rows_per_s) as usize;
        (0..log.rows() / rows).map(move |k| k * rows..(k + 1) * rows)
    });
    let of_whole = remarks(&log, nominal).into_iter().map(|remark| ("whole".to_owned(), remark));
    let of_parts = parts.flat_map(|rows| {
        let of_part = recognise(&log.slice(rows.clone()).unwrap(), nominal);
        let refused = of_part.into_iter().filter(|remark| remark.refuses(Use::Diagnosis));
        refused.map(|remark| (format!("rows {rows:?}"), remark)).collect::<Vec<_>>()
    });
    of_whole.chain(of_parts).map(|(part, remark)| format!("{}, {part}: {remark}", path.display())).collect()
}

#[test]
fn every_real_log_is_believed() {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let data = std::env::var_os("TRIBO_DATA").map_or_else(beside, PathBuf::from);
    if !data.is_dir() {
        // Past the capture of the test harness: nobody should think that they were read.
        let _ =
            writeln!(std::io::stderr(), "SKIPPED: no real logs under $TRIBO_DATA or ../shared/data; they are UNTESTED");
        return;
    }
    let mut alarms = said(&data.join("panda_gaz2019"), &nominal(preset("panda"), TorqueSide::Link));
    let gen3 = nominal(preset("kinova_gen3"), TorqueSide::Motor);
    let motions = ["opti_traj_testing1", "opti_traj_testing2", "RunTrajectory1", "RecordTrajectory_quadratic"];
    let all = motions.iter().map(|name| (*name).to_owned()).chain((1..8).map(|joint| format!("joint_{joint}_trapez")));
    for name in all {
        alarms.extend(said(&data.join(format!("kinova_gen3/{name}.csv.gz")), &gen3));
    }
    let lwr = nominal(urdf::<7>(&data.join("kuka_lwr4/lwr4.urdf")), TorqueSide::Link);
    for run in 1..4 {
        alarms.extend(said(&data.join(format!("kuka_lwr4/run_{run}.csv.gz")), &lwr));
    }
    let ur10 = nominal(urdf::<6>(&data.join("ur10_unisa/ur10.urdf")), TorqueSide::Motor);
    alarms.extend(said(&data.join("ur10_unisa/exciting_trajectory.csv.gz"), &ur10));
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
}
