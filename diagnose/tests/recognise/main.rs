#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]
mod good;
use good::{good, lively};
use tribo_logs::{LogColumns, RobotLog};

#[test]
fn explore_good() {
    let t = std::time::Instant::now();
    for seed in 0..40u64 {
        for name in ["panda", "kinova_gen3", "iiwa14", "fr3"] {
            let g = good::<7>(name, seed);
            let own = tribo_logs::recognise::recognise(&g.log);
            println!("GOOD {}", g.description);
            for r in own {
                println!("   OWN {r}");
            }
            for r in tribo_diagnose::recognise::recognise(&g.log, &g.nominal) {
                println!("   ALARM {r}");
            }
        }
        let g = good::<6>("ur10e", seed);
        println!("GOOD {}", g.description);
        for r in tribo_logs::recognise::recognise(&g.log) {
            println!("   OWN {r}");
        }
        for r in tribo_diagnose::recognise::recognise(&g.log, &g.nominal) {
            println!("   ALARM {r}");
        }
    }
    println!("took {:?}", t.elapsed());
}

fn broken(log: &RobotLog, f: impl Fn(&mut LogColumns)) -> RobotLog {
    let mut c = log.clone().into_columns();
    f(&mut c);
    c.validate().unwrap()
}

#[test]
fn explore_wrong() {
    let neg = |x: &mut Vec<f64>| x.iter_mut().for_each(|x| *x = -*x);
    for seed in 0..6u64 {
        for name in ["panda", "iiwa14"] {
            let g = lively::<7>(name, seed);
            println!("WRONG {}", g.description);
            let show = |what: String, log: RobotLog| {
                let t = std::time::Instant::now();
                let own = tribo_logs::recognise::recognise(&log);
                for r in &own {
                    println!("   {what} OWN {r}");
                }
                println!("   -- {what}");
                if own.is_empty() {
                    for r in tribo_diagnose::recognise::recognise(&log, &g.nominal) {
                        println!("   {what}: {r}");
                    }
                }
                println!("   {what} took {:?}", t.elapsed());
            };
            for j in 0..7 {
                show(format!("tau {j}"), broken(&g.log, |c| neg(&mut c.tau_j_nm[j])));
                show(
                    format!("q {j}"),
                    broken(&g.log, |c| {
                        neg(&mut c.q_rad[j]);
                        neg(&mut c.dq_rad_s[j])
                    }),
                );
                show(
                    format!("axis {j}"),
                    broken(&g.log, |c| {
                        neg(&mut c.q_rad[j]);
                        neg(&mut c.dq_rad_s[j]);
                        neg(&mut c.tau_j_nm[j])
                    }),
                );
                show(format!("gain4 {j}"), broken(&g.log, |c| c.tau_j_nm[j].iter_mut().for_each(|x| *x *= 4.0)));
                show(format!("tau swap {j}"), broken(&g.log, |c| c.tau_j_nm.swap(j, (j + 1) % 7)));
                show(
                    format!("q swap {j}"),
                    broken(&g.log, |c| {
                        c.q_rad.swap(j, (j + 1) % 7);
                        c.dq_rad_s.swap(j, (j + 1) % 7)
                    }),
                );
                show(
                    format!("joint swap {j}"),
                    broken(&g.log, |c| {
                        c.q_rad.swap(j, (j + 1) % 7);
                        c.dq_rad_s.swap(j, (j + 1) % 7);
                        c.tau_j_nm.swap(j, (j + 1) % 7)
                    }),
                );
            }
            show("all tau".into(), broken(&g.log, |c| c.tau_j_nm.iter_mut().for_each(neg)));
            show("mNm".into(), broken(&g.log, |c| c.tau_j_nm.iter_mut().flatten().for_each(|x| *x *= 1e3)));
            show("gain4".into(), broken(&g.log, |c| c.tau_j_nm.iter_mut().flatten().for_each(|x| *x *= 4.0)));
            show(
                "deg".into(),
                broken(&g.log, |c| c.q_rad.iter_mut().chain(&mut c.dq_rad_s).flatten().for_each(|x| *x *= 57.29578)),
            );
            show("deg q only".into(), broken(&g.log, |c| c.q_rad.iter_mut().flatten().for_each(|x| *x *= 57.29578)));
            show("ms".into(), broken(&g.log, |c| c.time_s.iter_mut().for_each(|x| *x *= 1e3)));
            show("ns".into(), broken(&g.log, |c| c.time_s.iter_mut().for_each(|x| *x *= 1e9)));
            show("dq scale".into(), broken(&g.log, |c| c.dq_rad_s.iter_mut().flatten().for_each(|x| *x *= 1.05)));
            show("dq sign".into(), broken(&g.log, |c| c.dq_rad_s.iter_mut().for_each(neg)));
            show("dq zero".into(), broken(&g.log, |c| c.dq_rad_s.iter_mut().flatten().for_each(|x| *x = 0.0)));
            show(
                "dq late".into(),
                broken(&g.log, |c| {
                    c.dq_rad_s.iter_mut().for_each(|x| {
                        let n = (0.05 / 0.002) as usize;
                        x.rotate_right(n);
                    })
                }),
            );
            show("frozen q".into(), broken(&g.log, |c| c.q_rad[2].fill(0.3)));
            show(
                "frozen q part".into(),
                broken(&g.log, |c| {
                    let n = c.q_rad[2].len();
                    let v = c.q_rad[2][n / 3];
                    c.q_rad[2][n / 3..n / 2].fill(v);
                    c.dq_rad_s[2][n / 3..n / 2].fill(0.0);
                }),
            );
        }
    }
}

#[test]
fn explore_robot() {
    for seed in 0..6u64 {
        for name in ["panda", "kinova_gen3", "iiwa14", "fr3"] {
            let g = lively::<7>(name, seed);
            for other in ["panda", "kinova_gen3", "iiwa14", "fr3"] {
                let mut nominal = lively::<7>(other, seed).nominal;
                if other == name {
                    nominal.arm = g.nominal.arm.clone();
                }
                println!("ROBOT {name} as {other}");
                for r in tribo_diagnose::recognise::recognise(&g.log, &nominal) {
                    println!("   {r}");
                }
            }
            let mut nominal = g.nominal.clone();
            nominal.torque_side = match nominal.torque_side {
                tribo_sim::TorqueSide::Motor => tribo_sim::TorqueSide::Link,
                _ => tribo_sim::TorqueSide::Motor,
            };
            nominal.arm = match nominal.torque_side {
                tribo_sim::TorqueSide::Motor => {
                    tribo_robot::presets::find(name).unwrap().with_joints::<7>().unwrap().arm.clone()
                }
                _ => nominal.arm.link_side(),
            };
            println!("SIDE {}", g.description);
            for r in tribo_diagnose::recognise::recognise(&g.log, &nominal) {
                println!("   {r}");
            }
        }
    }
}

#[test]
fn explore_real() {
    use tribo_robot::{presets, urdf};
    let data = std::path::PathBuf::from(std::env::var("TRIBO_DATA").unwrap());
    fn nominal<const N: usize>(arm: tribo_robot::Arm<N>, side: tribo_sim::TorqueSide) -> tribo_diagnose::Nominal<N> {
        let arm = if side == tribo_sim::TorqueSide::Link { arm.link_side() } else { arm };
        tribo_diagnose::Nominal {
            arm,
            friction: tribo_friction::FrictionModel::none(),
            smoothing_rad_s: 0.005,
            effects: vec![],
            torque_side: side,
        }
    }
    let preset = |name: &str| presets::find(name).unwrap().with_joints::<7>().unwrap().arm.clone();
    let lwr = urdf::UrdfChain::parse(&std::fs::read_to_string(data.join("kuka_lwr4/lwr4.urdf")).unwrap(), None, None)
        .unwrap()
        .arm::<7>()
        .unwrap()
        .arm;
    let show = |path: &str, n: tribo_diagnose::Nominal<7>| {
        let (log, _) = tribo_logs::read_log(data.join(path)).unwrap();
        println!("REAL {path} {:?}", n.torque_side);
        let t = std::time::Instant::now();
        for r in tribo_logs::recognise::recognise(&log) {
            println!("   OWN {r}");
        }
        for r in tribo_diagnose::recognise::recognise(&log, &n) {
            println!("   ALARM {r}");
        }
        println!("   took {:?}", t.elapsed());
    };
    use tribo_sim::TorqueSide::{Link, Motor};
    show("panda_gaz2019", nominal(preset("panda"), Link));
    show("panda_gaz2019", nominal(preset("panda"), Motor));
    for f in [
        "opti_traj_testing1",
        "opti_traj_testing2",
        "RunTrajectory1",
        "RecordTrajectory_quadratic",
        "joint_1_trapez",
        "joint_2_trapez",
        "joint_3_trapez",
        "joint_4_trapez",
        "joint_5_trapez",
        "joint_6_trapez",
        "joint_7_trapez",
    ] {
        show(&format!("kinova_gen3/{f}.csv.gz"), nominal(preset("kinova_gen3"), Motor));
    }
    for k in 1..4 {
        show(&format!("kuka_lwr4/run_{k}.csv.gz"), nominal(lwr.clone(), Link));
    }
    let ur = urdf::UrdfChain::parse(&std::fs::read_to_string(data.join("ur10_unisa/ur10.urdf")).unwrap(), None, None)
        .unwrap()
        .arm::<6>()
        .unwrap()
        .arm;
    let (log, _) = tribo_logs::read_log(data.join("ur10_unisa/exciting_trajectory.csv.gz")).unwrap();
    println!("REAL ur10");
    for r in tribo_logs::recognise::recognise(&log) {
        println!("   OWN {r}");
    }
    for r in tribo_diagnose::recognise::recognise(&log, &nominal(ur, Motor)) {
        println!("   ALARM {r}");
    }
}
