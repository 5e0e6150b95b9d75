//! Files of other programs, each after the conventions of its maker, all of one motion: read as the canonical log of that motion is, or
//! refused with the sentence that helps.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod motion;
mod python_writers;

use std::f64::consts::PI;
use std::io::{Cursor, Read as _, Write as _};
use std::path::Path;

use motion::{
    AS_LISTED, Cell, IN_ORDER, JOINTS, UR, archive, bag, each, episodes, frame, long, motion, number, stamps_ns,
    structured, text,
};
use tribo_logs::{ColumnMap, LogSummary, ReadOptions, RobotLog, read_from};

/// What is expected of a file.
enum Expected {
    /// Read; the text of the map that was taken begins so.
    Read(&'static str),
    /// Refused, with all of these words.
    Refused(&'static [&'static str]),
}
use Expected::{Read, Refused};

/// A file, how it is asked for, what is expected.
struct Row {
    name: &'static str,
    content: Vec<u8>,
    map: &'static str,
    joints: &'static [&'static str],
    expected: Expected,
}

const DEG: f64 = 180.0 / PI;

/// The tables's rows.
fn table(log: &RobotLog) -> Vec<Row> {
    let time =
        |name: &str, factor: f64| -> (String, Cell) { (name.to_owned(), number(move |row| log.time_s[row] * factor)) };
    let from = |names: [&str; 3], first: usize| -> Vec<(String, Cell)> {
        let [q, dq, tau] = names;
        [(q, &log.q_rad), (dq, &log.dq_rad_s), (tau, &log.tau_j_nm)]
            .into_iter()
            .flat_map(|(name, columns)| each(&IN_ORDER, |j| name.replace('#', &(j + first).to_string()), columns, 1.0))
            .collect()
    };
    let named = |names: [&str; 3]| -> Vec<(String, Cell)> {
        let [q, dq, tau] = names;
        [(q, &log.q_rad), (dq, &log.dq_rad_s), (tau, &log.tau_j_nm)]
            .into_iter()
            .flat_map(|(name, columns)| each(&AS_LISTED, |j| name.replace('#', UR[j]), columns, 1.0))
            .collect()
    };
    let wide = |clock: (String, Cell<'_>), rest: Vec<(String, Cell<'_>)>| -> Vec<u8> {
        let mut columns = vec![clock];
        columns.extend(rest);
        text(",", &columns, true)
    };

    // Universal Robots, record.py of RTDE: spaces, currents, moments of the controller.
    let rtde = || {
        let mut columns = vec![("timestamp".to_owned(), number(|row| 1234.5 + log.time_s[row]))];
        columns.extend(each(&IN_ORDER, |j| format!("target_q_{j}"), &log.q_rad, 1.0));
        columns.extend(each(&IN_ORDER, |j| format!("actual_q_{j}"), &log.q_rad, 1.0));
        columns.extend(each(&IN_ORDER, |j| format!("actual_qd_{j}"), &log.dq_rad_s, 1.0));
        columns.extend(each(&IN_ORDER, |j| format!("actual_current_{j}"), &log.tau_j_nm, 0.1));
        columns.extend(each(&IN_ORDER, |j| format!("target_moment_{j}"), &log.tau_j_nm, 1.0));
        columns.push(("actual_TCP_force_0".to_owned(), number(|_| 0.0)));
        text(" ", &columns, true)
    };
    // `ros2 topic echo --csv /joint_states`: no header.
    let echo = || {
        let stamp = |row: usize| stamps_ns()[row];
        let mut columns: Vec<(String, Cell)> = vec![
            (String::new(), Box::new(move |row| (stamp(row) / 1_000_000_000).to_string())),
            (String::new(), Box::new(move |row| (stamp(row) % 1_000_000_000).to_string())),
            (String::new(), Box::new(|_| String::new())),
        ];
        columns.extend(AS_LISTED.map(|j| (String::new(), Box::new(move |_| UR[j].to_owned()) as Cell)));
        columns.extend(named(["#", "#", "#"]));
        text(",", &columns, false)
    };
    // ROS 1: `rostopic echo -p /joint_states`.
    let rostopic = || {
        let mut columns: Vec<(String, Cell)> = vec![
            ("%time".to_owned(), Box::new(|row| stamps_ns()[row].to_string())),
            ("field.header.seq".to_owned(), number(|row| row as f64)),
        ];
        columns.extend(
            (0..JOINTS).map(|k| (format!("field.name{k}"), Box::new(move |_| UR[AS_LISTED[k]].to_owned()) as Cell)),
        );
        for (name, of) in [("position", &log.q_rad), ("velocity", &log.dq_rad_s), ("effort", &log.tau_j_nm)] {
            columns.extend((0..JOINTS).map(|k| (format!("field.{name}{k}"), number(move |row| of[AS_LISTED[k]][row]))));
        }
        text(",", &columns, true)
    };
    // A frame of pandas made of messages.
    let pandas = || {
        let mut columns: Vec<(String, Cell)> = vec![
            (String::new(), number(|row| row as f64)),
            ("header.stamp.sec".to_owned(), Box::new(|row| (stamps_ns()[row] / 1_000_000_000).to_string())),
            ("header.stamp.nanosec".to_owned(), Box::new(|row| (stamps_ns()[row] % 1_000_000_000).to_string())),
        ];
        columns.extend(from(["position_#", "velocity_#", "effort_#"], 0));
        text(",", &columns, true)
    };
    let gripper = || {
        let mut rest = from(["joint_#_pos", "joint_#_vel", "joint_#_torque"], 1);
        rest.insert(6, ("gripper_pos".to_owned(), number(|_| 0.04)));
        wide(time("t", 1.0), rest)
    };
    let degrees = || {
        let mut columns = vec![time("Time (ms)", 1e3)];
        columns.extend(each(&IN_ORDER, |j| format!("q{} [deg]", j + 1), &log.q_rad, DEG));
        columns.extend(each(&IN_ORDER, |j| format!("dq{} [deg/s]", j + 1), &log.dq_rad_s, DEG));
        columns.extend(each(&IN_ORDER, |j| format!("torque{} [mNm]", j + 1), &log.tau_j_nm, 1e3));
        text(",", &columns, true)
    };
    let xarm = || {
        let mut columns = vec![time("timestamp_ms", 1e3)];
        for j in 0..JOINTS {
            columns.push((format!("J{}_angle_deg", j + 1), number(move |row| log.q_rad[j][row] * DEG)));
            columns.push((format!("J{}_speed_deg_s", j + 1), number(move |row| log.dq_rad_s[j][row] * DEG)));
            columns.push((format!("J{}_torque_Nm", j + 1), number(move |row| log.tau_j_nm[j][row])));
        }
        text("\t", &columns, true)
    };
    let comma = || {
        let mut columns = vec![time("time", 1.0)];
        columns.extend(from(["pos#", "vel#", "tau#"], 1));
        String::from_utf8(text(";", &columns, true)).unwrap().replace('.', ",").into_bytes()
    };
    let currents = || {
        let mut columns = vec![time("t", 1.0)];
        columns.extend(each(&IN_ORDER, |j| format!("pos_{j}"), &log.q_rad, 1.0));
        columns.extend(each(&IN_ORDER, |j| format!("vel_{j}"), &log.dq_rad_s, 1.0));
        columns
            .extend((0..JOINTS).map(|j| {
                (format!("current_{j}_mA"), number(move |row| log.tau_j_nm[j][row] * 1e3 / (1.0 + j as f64)))
            }));
        text(",", &columns, true)
    };
    let two = || {
        let mut rest = from(["q#", "qd#", "tau_measured#"], 1);
        rest.extend(each(&IN_ORDER, |j| format!("tau_cmd{}", j + 1), &log.tau_j_nm, 2.0));
        wide(time("time", 1.0), rest)
    };
    let units_row = || {
        let lines = String::from_utf8(comma()).unwrap().replace(',', ".");
        let (header, rows) = lines.split_once('\n').unwrap();
        let units: Vec<&str> = ["s"].into_iter().chain(["rad"; 6]).chain(["rad/s"; 6]).chain(["Nm"; 6]).collect();
        format!("{header}\n{}\n{rows}", units.join(";")).into_bytes()
    };
    let savetxt = || {
        let mut columns = vec![time("# time", 1.0)];
        columns.extend(from(["q_#", "dq_#", "tau_#"], 0));
        text(" ", &columns, true)
    };
    let row = |name, content, map, expected| Row { name, content, map, joints: &[], expected };
    vec![
        row(
            "UR RTDE",
            rtde(),
            "",
            Refused(&[
                "currents (actual_current_{joint})",
                "target_moment_{joint}",
                "torque constants are needed",
                "--map 'time=timestamp,q=actual_q_{joint},dq=actual_qd_{joint},tau=actual_current_{joint}[A*CONSTANT]'",
            ]),
        ),
        row(
            "UR RTDE, constants",
            rtde(),
            "tau=actual_current_{joint}[A*10]",
            Read("time=timestamp,q=actual_q_{joint},dq=actual_qd_{joint},tau=actual_current_{joint}[A*10]"),
        ),
        row(
            "UR RTDE, moments",
            rtde(),
            "tau=target_moment_{joint}",
            Read("time=timestamp,q=actual_q_{joint},dq=actual_qd_{joint},tau=target_moment_{joint}"),
        ),
        row(
            "LeRobot Parquet",
            episodes(log),
            "",
            Refused(&["2 episodes in column `episode_index` (0 to 1)", "--map episode=0"]),
        ),
        row(
            "LeRobot Parquet, one episode",
            episodes(log),
            "episode=1",
            Read("time=timestamp,q=observation.state,dq=observation.velocity,tau=observation.effort,episode=1"),
        ),
        row("LeRobot Parquet, no such episode", episodes(log), "episode=7", Refused(&["no episode 7", "2 episodes"])),
        row("rosbag2 SQLite", bag(log), "", Read("")),
        row(
            "rosbag2 SQLite, topic",
            bag(log),
            "topic=/rosout",
            Refused(&["/rosout (rcl_interfaces/msg/Log)", "how its messages are laid out"]),
        ),
        row(
            "rosbag2 SQLite, no such topic",
            bag(log),
            "topic=/nothing",
            Refused(&["no messages on topic /nothing; topics: /rosout, /joint_states"]),
        ),
        row(
            "PlotJuggler CSV",
            wide(
                time("__time", 1.0),
                named(["/joint_states/#/position", "/joint_states/#/velocity", "/joint_states/#/effort"]),
            ),
            "",
            Read(
                "time=__time,q=/joint_states/{joint}/position,dq=/joint_states/{joint}/velocity,tau=/joint_states/{joint}/effort",
            ),
        ),
        row(
            "ros2 topic echo --csv",
            echo(),
            "",
            Read(
                "time=header.stamp.sec+header.stamp.nanosec,q=position[{joint}],dq=velocity[{joint}],tau=effort[{joint}],joint=name[{joint}]",
            ),
        ),
        row(
            "rostopic echo -p",
            rostopic(),
            "",
            Read(
                "time=%time[ns],q=field.position{joint},dq=field.velocity{joint},tau=field.effort{joint},joint=field.name{joint}",
            ),
        ),
        row("pandas of messages", pandas(), "", Read("time=header.stamp.sec+header.stamp.nanosec,q=position_{joint}")),
        row(
            "MATLAB writetable",
            wide(time("t", 1.0), from(["q_#", "qd_#", "tau_#"], 1))
                .into_iter()
                .flat_map(|b| if b == b'\n' { vec![b'\r', b'\n'] } else { vec![b] })
                .collect(),
            "",
            Read("time=t,q=q_{joint},dq=qd_{joint},tau=tau_{joint}"),
        ),
        row(
            "MATLAB writematrix",
            text(",", &[vec![time("", 1.0)], from(["", "", ""], 1)].into_iter().flatten().collect::<Vec<_>>(), false),
            "",
            Refused(&[
                "no column is understood as joint positions",
                "columns: column_1, column_2",
                "--map 'time=COLUMN,q=COLUMNS,tau=COLUMNS'",
            ]),
        ),
        row(
            "MATLAB writematrix, map",
            text(",", &[vec![time("", 1.0)], from(["", "", ""], 1)].into_iter().flatten().collect::<Vec<_>>(), false),
            "time=column_1,q=column_{2..7},dq=column_{8..13},tau=column_{14..19}",
            Read("time=column_1,q=column_{2..7}"),
        ),
        row(
            "xArm",
            xarm(),
            "",
            Read(
                "time=timestamp_ms[ms],q=J{joint}_angle_deg[deg],dq=J{joint}_speed_deg_s[deg/s],tau=J{joint}_torque_Nm[Nm]",
            ),
        ),
        row(
            "DataFrame.to_parquet",
            frame(log),
            "",
            Read("time=timestamp[ns],q=position_{joint},dq=velocity_{joint},tau=effort_{joint}"),
        ),
        row("npz", archive(log, true), "", Read("time=time,q=q,dq=dq,tau=tau")),
        row(
            "npz without time",
            archive(log, false),
            "",
            Refused(&[
                "no column is understood as time (without one: rate=HZ)",
                "columns: q[0..5], dq[0..5], tau[0..5]",
            ]),
        ),
        row("npz with a rate", archive(log, false), "rate=500", Read("q=q,dq=dq,tau=tau,rate=500")),
        row("structured npy", structured(log), "", Read("time=time,q=q,dq=dq,tau=tau")),
        row("long table", long(log, false), "", Read("time=time,q=position,dq=velocity,tau=effort,joint=joint")),
        row(
            "long table, joint by joint",
            long(log, true),
            "",
            Read("time=time,q=position,dq=velocity,tau=effort,joint=joint"),
        ),
        row("semicolons, decimal commas", comma(), "", Read("time=time,q=pos{joint},dq=vel{joint},tau=tau{joint}")),
        row(
            "commas as both",
            String::from_utf8(comma()).unwrap().replace(';', ",").into_bytes(),
            "",
            Refused(&["decimal commas between commas cannot be told apart"]),
        ),
        row(
            "a line of units",
            units_row(),
            "",
            Read("time=time[s],q=pos{joint}[rad],dq=vel{joint}[rad/s],tau=tau{joint}[Nm]"),
        ),
        row("numpy.savetxt", savetxt(), "", Read("time=time,q=q_{joint},dq=dq_{joint},tau=tau_{joint}")),
        row(
            "currents in mA",
            currents(),
            "",
            Refused(&[
                "currents (current_{joint}_mA): their torque constants are needed",
                "tau=current_{joint}_mA[mA*CONSTANT]",
            ]),
        ),
        row(
            "currents in mA, constants",
            currents(),
            "tau=current_{joint}_mA[mA*1:2:3:4:5:6]",
            Read("time=t,q=pos_{joint},dq=vel_{joint},tau=current_{joint}_mA[mA*1:2:3:4:5:6]"),
        ),
        row(
            "currents in mA, too few constants",
            currents(),
            "tau=current_{joint}_mA[mA*1:2]",
            Refused(&["tau: 2 factors for 6 columns; allowed: 1 or 6"]),
        ),
        row(
            "units in headers",
            degrees(),
            "",
            Read("time=Time[ms],q=q{joint}[deg],dq=dq{joint}[deg/s],tau=torque{joint}[mNm]"),
        ),
        row(
            "stamps in ns",
            wide(
                ("stamp".to_owned(), Box::new(|row| stamps_ns()[row].to_string())),
                from(["pos_#", "vel_#", "eff_#"], 1),
            ),
            "",
            Read("time=stamp[ns],q=pos_{joint},dq=vel_{joint},tau=eff_{joint}"),
        ),
        Row {
            joints: &UR,
            ..row(
                "ROS names, order of the file",
                wide(time("time", 1.0), named(["#_pos", "#_vel", "#_eff"])),
                "",
                Read("time=time,q={joint}_pos,dq={joint}_vel,tau={joint}_eff"),
            )
        },
        row(
            "ROS names, map",
            wide(time("time", 1.0), named(["a/#", "b/#", "c/#"])),
            "time=time,q=a/{joint},dq=b/{joint},tau=c/{joint}",
            Read("time=time,q=a/{joint}"),
        ),
        row(
            "a gripper beside the arm",
            gripper(),
            "",
            Read("time=t,q=joint_{joint}_pos,dq=joint_{joint}_vel,tau=joint_{joint}_torque"),
        ),
        row(
            "two torques",
            two(),
            "",
            Refused(&[
                "torques measured and commanded are there: tau_measured{joint}, tau_cmd{joint}",
                "--map 'time=time,q=q{joint},dq=qd{joint},tau=tau_measured{joint},tau_d=tau_cmd{joint}'",
            ]),
        ),
        row(
            "two torques, map",
            two(),
            "time=time,q=q{joint},dq=qd{joint},tau=tau_measured{joint},tau_d=tau_cmd{joint}",
            Read("time=time,q=q{joint}"),
        ),
        row(
            "no torque",
            wide(time("time", 1.0), from(["q_#", "dq_#", "x_#"], 1)),
            "",
            Refused(&["no column is understood as joint torques", "q_1, q_2"]),
        ),
        row(
            "one joint less",
            wide(time("time", 1.0), from(["q_#", "dq_#", "tau_#"], 1)),
            "time=time,q=q_{1..5},tau=tau_{joint}",
            Refused(&["tau: 6 columns, q has 5"]),
        ),
        row(
            "a column that is not there",
            wide(time("time", 1.0), from(["q_#", "dq_#", "tau_#"], 1)),
            "q=p_{joint},tau=tau_{joint},time=time",
            Refused(&["q: no column of the form `p_{joint}`; columns: time, q_1"]),
        ),
        row(
            "time that is not canonical",
            wide(time("t", 1.0), from(["q_#", "dq_#", "tau_J_#"], 0)),
            "",
            Read("time=t,q=q_{joint},dq=dq_{joint},tau=tau_J_{joint}"),
        ),
    ]
}

fn read(row: &Row) -> Result<(RobotLog, LogSummary), String> {
    let map =
        if row.map.is_empty() { None } else { Some(row.map.parse::<ColumnMap>().map_err(|error| error.to_string())?) };
    let joints = row.joints.iter().map(|name| (*name).to_owned()).collect();
    let options = ReadOptions { map, joints, most_rows: None };
    read_from(row.content.clone(), Path::new("foreign"), &options).map_err(|error| error.to_string())
}

/// The largest difference of two logs, relative to 1.
fn difference(a: &RobotLog, b: &RobotLog) -> f64 {
    assert_eq!((a.joints(), a.rows()), (b.joints(), b.rows()));
    let mut worst = 0.0_f64;
    for (one, other) in [(&a.q_rad, &b.q_rad), (&a.dq_rad_s, &b.dq_rad_s), (&a.tau_j_nm, &b.tau_j_nm)] {
        for (one, other) in one.iter().flatten().zip(other.iter().flatten()) {
            worst = worst.max((one - other).abs() / other.abs().max(1.0));
        }
    }
    let start = a.time_s[0] - b.time_s[0];
    for (one, other) in a.time_s.iter().zip(&b.time_s) {
        worst = worst.max((one - start - other).abs());
    }
    worst
}

#[test]
fn every_file_is_read_right_or_refused_with_the_way_out() {
    let log = motion();
    let mut failed = Vec::new();
    for row in table(&log) {
        match (read(&row), &row.expected) {
            (Ok((got, summary)), Read(map)) => {
                let said = summary.mapping.as_ref().map_or(String::new(), |mapping| mapping.map.clone());
                if !said.starts_with(map) {
                    failed.push(format!("{}: read as {said}, expected {map}", row.name));
                }
                let worst = difference(&got, &log);
                if worst > 1e-9 {
                    failed.push(format!("{}: differs by {worst:.1e}", row.name));
                }
                if !summary.warnings.is_empty() {
                    failed.push(format!("{}: {:?}", row.name, summary.warnings));
                }
            }
            (Err(error), Refused(words)) => {
                for word in words.iter().filter(|word| !error.contains(**word)) {
                    failed.push(format!("{}: lacks `{word}`: {error}", row.name));
                }
            }
            (Ok((_, summary)), Refused(_)) => {
                failed.push(format!("{}: read as {:?}", row.name, summary.mapping.map(|m| m.map)))
            }
            (Err(error), Read(_)) => failed.push(format!("{}: {error}", row.name)),
        }
    }
    assert!(failed.is_empty(), "\n{}\n", failed.join("\n"));
}

/// Zeros pack a thousand times: what a file asks for stays in proportion to it.
#[test]
fn an_array_that_unpacks_without_end_is_refused() {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    for name in ["time", "q", "tau"] {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (37500000,), }\n";
        writer.start_file(format!("{name}.npy"), options).unwrap();
        let start = [&b"\x93NUMPY\x01\x00"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
        writer.write_all(&start).unwrap();
        std::io::copy(&mut std::io::repeat(0).take(300_000_000), &mut writer).unwrap();
    }
    let bytes = writer.finish().unwrap().into_inner();
    let error = read_from(bytes, Path::new("zeros.npz"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("unpacks to more than 268435456 bytes"), "{error}");
}

/// Pages of a database that point at each other would be rows without end.
#[test]
fn a_bag_whose_pages_go_in_circles_ends() {
    let good = bag(&motion());
    let page = usize::from(u16::from_be_bytes([good[16], good[17]]));
    let mut ends = 0;
    // Every pointer of every interior page turned to the first page that is a leaf of messages.
    let interior: Vec<usize> = (1..good.len() / page).filter(|k| good[k * page] == 5).collect();
    let leaves: Vec<usize> = (1..good.len() / page).filter(|k| good[k * page] == 13).collect();
    for target in leaves.iter().rev().take(3).chain(&interior) {
        let mut bad = good.clone();
        for &at in &interior {
            let cells = usize::from(u16::from_be_bytes([bad[at * page + 3], bad[at * page + 4]]));
            for cell in 0..cells {
                let place = at * page + 12 + 2 * cell;
                let cell = at * page + usize::from(u16::from_be_bytes([bad[place], bad[place + 1]]));
                bad[cell..cell + 4].copy_from_slice(&(*target as u32 + 1).to_be_bytes());
            }
        }
        let started = std::time::Instant::now();
        ends += usize::from(read_from(bad, Path::new("bad.db3"), &ReadOptions::default()).is_err());
        assert!(started.elapsed().as_secs() < 20);
    }
    assert!(!interior.is_empty() && ends > 0);
}
