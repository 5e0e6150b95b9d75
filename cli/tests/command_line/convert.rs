//! Story: somebody brings logs of other programs, learns what they hold, and takes them to a viewer.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use crate::common::{run, scratch, tribo};

/// A log of two joints with motion and, in row k, a stamp of k ms; `lost` rows are left out.
fn canonical(rows: usize, columns: &[&str], lost: &[usize]) -> String {
    let names: Vec<String> =
        columns.iter().flat_map(|stem| (0..2).map(move |joint| format!("{stem}_{joint}"))).collect();
    let mut text = format!("time,{}\n", names.join(","));
    for k in (0..rows).filter(|k| !lost.contains(k)) {
        write!(text, "{}", k as f64 * 1e-3).unwrap();
        (0..names.len()).for_each(|c| write!(text, ",{}", ((k + 7 * c) as f64 * 1e-3).sin()).unwrap());
        text.push('\n');
    }
    text
}

#[test]
fn a_conversion_says_what_is_there_what_is_missing_and_what_that_switches_off() {
    let at = scratch();
    let mut text = canonical(50, &["q", "dq", "tau_J", "tau_J_d"], &[20, 21]);
    text.push_str(&text.clone().lines().last().unwrap().replace('\n', ""));
    fs::write(at.path().join("log.csv"), &text).unwrap();
    let table = run(at.path(), "convert log.csv log.mcap").ok();
    for needle in [
        "rows         48 (1 repeated rows dropped)",
        "duration     0.049 s at 1000.0 Hz",
        "bursts       2 (longest gap 3.00 ms)",
        "columns      time, q_i, dq_i, tau_J_i, tau_J_d_i",
        "absent       tau_friction_i, tau_link_i, theta_i",
        "without      theta_i: estimate leaves out double_encoder",
        "without      O_F_ext_i: estimate has no error figures",
        "warning      line 50 has no line ending",
        "written      log.mcap",
    ] {
        assert!(table.stdout.contains(needle), "{needle}\n{}", table.stdout);
    }
    assert!(table.stderr.is_empty(), "no bar where standard error is no terminal: {}", table.stderr);

    let json = run(at.path(), "convert log.mcap log.parquet --json").ok().json();
    assert_eq!((&json["format"], &json["rows"], &json["bursts"]), (&"MCAP".into(), &48.into(), &2.into()));
    assert!(json["source"].as_str().unwrap().starts_with("topic /robot (tribo.Log), 2 joints"), "{json}");
    assert_eq!(json["columns"].as_array().unwrap().len(), 5);
    let missing = json["missing"].as_array().unwrap();
    let theta = missing.iter().find(|entry| entry["column"] == "theta_i").unwrap();
    assert!(theta["switches_off"].as_str().unwrap().contains("double_encoder"));
    let warm = missing.iter().find(|entry| entry["column"] == "temperature_i").unwrap();
    assert!(warm["switches_off"].is_null(), "nobody reads temperatures");

    // Round and round: nothing is lost on the way.
    for step in ["log.parquet tree.csv --for plotjuggler", "tree.csv back.csv.gz", "back.csv.gz back.csv"] {
        run(at.path(), &format!("convert {step} --quiet")).ok();
    }
    let expected: String = text.lines().take(49).map(|line| format!("{line}\n")).collect();
    let numbers = |text: &str| -> Vec<Vec<f64>> {
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    assert_eq!(numbers(&fs::read_to_string(at.path().join("back.csv")).unwrap()), numbers(&expected));
    let tree = fs::read_to_string(at.path().join("tree.csv")).unwrap();
    assert!(tree.starts_with("time,/joint_0/q,/joint_1/q,"), "{}", &tree[..60]);
}

#[test]
fn libfranka_logs_and_turning_kinovas_come_in() {
    let at = scratch();
    let block = |prefix: &str, name: &str, count: usize| {
        (0..count).map(|i| format!("{prefix}{name}[{i}]")).collect::<Vec<_>>().join(", ")
    };
    let state = ["q", "q_d", "dq", "dq_d", "tau_J", "tau_ext_hat_filtered"].map(|name| block("state.", name, 7));
    let command = [("q_d", 7), ("dq_d", 7), ("O_T_EE_d", 16), ("O_dP_EE_d", 6), ("tau_J_d", 7)]
        .map(|(name, n)| block("cmd.", name, n));
    let row =
        |ms: usize| format!("{ms},1,{}\n", (0..85).map(|c| format!("{}.5", c + ms)).collect::<Vec<_>>().join(","));
    let rows: String = (0..30).map(row).collect();
    fs::write(
        at.path().join("franka.csv"),
        format!("time, success_rate, {},{}\n{rows}", state.join(","), command.join(",")),
    )
    .unwrap();
    let json = run(at.path(), "convert franka.csv out.parquet --json").ok().json();
    assert_eq!(
        (&json["format"], &json["joints"], &json["rate_hz"]),
        (&"libfranka CSV".into(), &7.into(), &1000.0.into())
    );

    let names: Vec<String> = ["Position", "Velocity", "TorqueCur", "TorqueSm", "Temp"]
        .iter()
        .flat_map(|stem| (1..=7).map(move |joint| format!("{stem}{joint}")))
        .collect();
    let turning = |k: usize| (3.0 + 0.05 * k as f64).sin().atan2((3.0 + 0.05 * k as f64).cos());
    let row = |k: usize| {
        (0..35).map(|c| if c == 2 { turning(k).to_string() } else { "1".to_owned() }).collect::<Vec<_>>().join(",")
    };
    let rows: String = (0..300).map(|k| format!("{k},{}\n", row(k))).collect();
    fs::write(at.path().join("kinova.csv"), format!("Time,{}\n{rows}", names.join(","))).unwrap();
    let table = run(at.path(), "convert kinova.csv kinova.parquet").ok().stdout;
    assert!(table.contains("unwrapped    3 jumps of a turn in q_i"), "{table}");
}

/// Peak memory of a process while it lives, as the kernel counts it (MB).
#[cfg(target_os = "linux")]
fn peak_mb(process: u32) -> Option<f64> {
    let status = fs::read_to_string(Path::new("/proc").join(process.to_string()).join("status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

/// 220 MB of columns, if they were all in memory; a batch is 26 MB (measured with the program: 45 MB).
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_log() {
    const MOST_MB: f64 = 90.0;
    let at = scratch();
    let stems = ["q", "dq", "tau_J", "tau_J_d", "tau_link", "theta", "dtheta"];
    let names: Vec<String> = stems.iter().flat_map(|stem| (0..7).map(move |joint| format!("{stem}_{joint}"))).collect();
    let tail: String = (0..49).map(|c| format!(",0.{c}")).collect();
    let mut text = format!("time,{}\n", names.join(","));
    (0..550_000).for_each(|k| writeln!(text, "{}{tail}", f64::from(k) * 1e-3).unwrap());
    fs::write(at.path().join("long.csv"), text).unwrap();
    for out in ["long.parquet", "long.csv.gz"] {
        let mut call = tribo(at.path(), ["convert", "long.csv", out]);
        let mut child = call.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let mut most_mb: f64 = 0.0;
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            most_mb = most_mb.max(peak_mb(child.id()).unwrap_or(0.0));
            std::thread::sleep(Duration::from_millis(5));
        };
        println!("{out}: {most_mb:.0} MB");
        assert!(status.success() && (5.0..MOST_MB).contains(&most_mb), "{out}: {most_mb} MB");
    }
}
