//! Inputs that ask for more time, stack or memory than their size justifies; too large to be found by mutation.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use tribo_tests::fuzz_inputs::{TARGETS, Target};

use super::take;

/// Levels of nesting, far beyond any stack.
const DEEP: usize = 200_000;

/// The targets whose name ends so, or is this.
fn targets(ending: &str) -> impl Iterator<Item = Target> {
    TARGETS.into_iter().filter(move |target| target.0.ends_with(ending))
}

fn take_all(ending: &str, what: &str, input: &[u8]) {
    let mut count = 0;
    for target in targets(ending) {
        take(target, what, input);
        count += 1;
    }
    assert!(count > 0, "no target {ending}");
}

#[test]
fn yaml() {
    // Each list holds the one before ten times: 10^12 entries in 600 bytes.
    let mut laughs = "a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n".to_owned();
    for k in 1..12 {
        let before = format!("*a{}", k - 1);
        laughs += &format!("a{k}: &a{k} [{}]\n", [&before[..]; 10].join(", "));
    }
    take_all("_yaml", "billion laughs", laughs.as_bytes());
    take_all("_yaml", "billion effects", format!("{laughs}effects: *a11\nposes: *a11\n").as_bytes());
    let merges = format!("{}c: {{{}}}\n", "b: &b {x: 1}\n", "<<: *b, ".repeat(20_000));
    take_all("_yaml", "merges", merges.as_bytes());

    for (what, opened) in [("lists", "["), ("maps", "{a: "), ("items", "- "), ("keys", "? "), ("tags", "!a ")] {
        take_all("_yaml", what, opened.repeat(DEEP).as_bytes());
        take_all("_yaml", what, format!("effects: {}", opened.repeat(DEEP)).as_bytes());
    }
    let indented: String = (0..2_000).map(|k| format!("{}a:\n", " ".repeat(k))).collect();
    take_all("_yaml", "indented", indented.as_bytes());
    take_all("_yaml", "documents", "---\na: 1\n".repeat(20_000).as_bytes());
    take_all("_yaml", "anchors", (0..20_000).map(|k| format!("a{k}: &a{k} *a{k}\n")).collect::<String>().as_bytes());
    take_all("_yaml", "one long key", format!("{}: 1\n", "a".repeat(1 << 20)).as_bytes());

    for value in ["1e400", "-1e400", ".nan", ".inf", "1e9", "99999999999999999999", "-1", "1e-400"] {
        let model = format!("schema: tribo.model/1\nrobot: panda\njoints: {value}\ngravity_m_s2: [{value}, 0, 0]\n");
        take_all("model_yaml", value, model.as_bytes());
        let tune = format!("seed: {value}\n");
        take_all("tune_yaml", value, tune.as_bytes());
        for key in ["trials", "init", "sub_steps", "pose", "lever_arm_m", "failure_rate", "stop_below"] {
            take_all("tune_yaml", value, format!("{key}: {value}\n").as_bytes());
        }
    }
    let effects = "- {cause: payload, mass_kg: 0, com_m: [0, 0, 0]}\n".repeat(20_000);
    take_all("model_yaml", "effects", format!("schema: tribo.model/1\nrobot: panda\neffects:\n{effects}").as_bytes());
    let joints = "- {coulomb_nm: 1, viscous_nm_s_per_rad: 1}\n".repeat(40_000);
    let friction = format!("friction:\n  law: coulomb_viscous\n  joints:\n{joints}");
    take_all("model_yaml", "joints", format!("schema: tribo.model/1\nrobot: panda\n{friction}").as_bytes());
    let points: String =
        (0..20_000).map(|k| format!("- {{time_s: {k}e-3, q_rad: [0,-0.7,0,-2.3,0,1.5,0.7]}}\n")).collect();
    let trajectory = format!("schema: tribo.trajectory/1\nrobot: panda\nvia_points:\n{points}");
    take_all("trajectory_yaml", "points", trajectory.as_bytes());
}

#[test]
fn grids() {
    let study = |seeds: &str, poses: &str, cases: &str, strategies: &str| {
        format!("schema: tribo.study/1\nseeds: {seeds}\nposes: [{poses}]\ncases:\n{cases}strategies:\n{strategies}")
    };
    let case = "- {truth: stribeck, friction: stribeck}\n";
    let sobol = "- {strategy: sobol, trials: 1}\n";
    let budgets: String = (1..=10_000).map(|k| format!("- {{strategy: sobol, trials: {k}}}\n")).collect();
    for grid in [
        study("10000", &"0, ".repeat(40_000), case, sobol),
        study("10000", "0, 1, 2", &case.repeat(20_000), sobol),
        study("10000", "0, 1, 2", case, &budgets),
        study("18446744073709551615", "0", case, sobol),
    ] {
        take_all("study_yaml", "grid", grid.as_bytes());
    }
}

#[test]
fn json() {
    for (ending, before) in [
        ("expected_json", ""),
        ("study_cell_json", "{\"result\":"),
        ("journal", "{\"op_code\":0}\n{\"op_code\":4}\n{\"op_code\":8,\"trial_id\":0,\"user_attr\":"),
        ("mcap_message", "m\n--\n\n--\n"),
    ] {
        for opened in ["[", "{\"a\":"] {
            take_all(ending, opened, format!("{before}{}\n", opened.repeat(DEEP)).as_bytes());
        }
        take_all(ending, "numbers", format!("{before}[1e400,{}1]\n", "1e9,".repeat(DEEP)).as_bytes());
    }
    let trials = "{\"op_code\":4}\n".repeat(50_000);
    take_all("journal", "trials", format!("{{\"op_code\":0}}\n{trials}").as_bytes());
    let far = "{\"op_code\":0}\n{\"op_code\":5,\"trial_id\":18446744073709551615,\"param_name\":\"x\"}\n";
    take_all("journal", "a trial far away", far.as_bytes());
}

/// Parsers compare each attribute of an element with all before it: 80 000 took half a minute.
#[test]
fn attributes() {
    let many = |quote: &str| (0..80_000).map(|k| format!("a{k} = {quote}>{quote} ")).collect::<String>();
    for (target, root, inner) in [("urdf", "robot", "link"), ("mjcf", "mujoco", "worldbody")] {
        for quote in ["\"", "'"] {
            let many = many(quote);
            take_all(target, "attributes of the root", format!("<{root} {many}><{inner}/></{root}>").as_bytes());
            take_all(target, "attributes within", format!("<{root}><{inner} {many}/></{root}>").as_bytes());
        }
    }
}

#[test]
fn urdf() {
    take_all("urdf", "links", "<link name=\"a\">".repeat(DEEP).as_bytes());
    let entities: String =
        (1..20).map(|k| format!("<!ENTITY a{k} \"{}\">", format!("&a{};", k - 1).repeat(10))).collect();
    let laughs = format!(
        "<!DOCTYPE robot [<!ENTITY a0 \"lol\">{entities}]><robot name=\"&a19;\"><link name=\"&a19;\"/></robot>"
    );
    take_all("urdf", "billion laughs", laughs.as_bytes());
    take_all("mjcf", "billion laughs", laughs.replace("robot", "mujoco").as_bytes());
    take_all("mjcf", "bodies", "<body>".repeat(DEEP).as_bytes());
    let classes: String =
        (0..20_000).map(|k| format!("<default class=\"c{k}\"><geom size=\"1\"/></default>")).collect();
    let geoms = "<geom class=\"c19999\"/>".repeat(20_000);
    let model = format!("<mujoco><default>{classes}</default><worldbody><body>{geoms}</body></worldbody></mujoco>");
    take_all("mjcf", "classes", model.as_bytes());
    take_all("mjcf", "includes", format!("<mujoco>{}</mujoco>", "<include file=\"a\"/>".repeat(20_000)).as_bytes());
    let links: String = (0..3_000).map(|k| format!("<link name=\"l{k}\"/>")).collect();
    let joints: String = (1..3_000)
        .map(|k| {
            let before = k - 1;
            format!("<joint name=\"j{k}\" type=\"fixed\"><parent link=\"l{before}\"/><child link=\"l{k}\"/></joint>")
        })
        .collect();
    take_all("urdf", "a long chain", format!("<robot name=\"r\">{links}{joints}</robot>").as_bytes());
    let star: String = (1..3_000)
        .map(|k| format!("<joint name=\"j{k}\" type=\"fixed\"><parent link=\"l0\"/><child link=\"l{k}\"/></joint>"))
        .collect();
    take_all("urdf", "a star", format!("<robot name=\"r\">{links}{star}</robot>").as_bytes());
}

#[test]
fn logs() {
    let packed = |piece: &[u8], times: usize| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(b"time,q_0,dq_0,tau_J_0\n0,1,2,3\n").expect("memory");
        for _ in 0..times {
            encoder.write_all(piece).expect("memory");
        }
        encoder.finish().expect("memory")
    };
    // 64 MB each: blank lines, rows that repeat, one line without end.
    take_all("csv_log", "blank lines", &packed(&[b'\n'; 1 << 16], 1 << 10));
    take_all("csv_log", "repeats", &packed(&b"0,1,2,3\n".repeat(1 << 13), 1 << 10));
    take_all("csv_log", "one line", &packed(&[b'1'; 1 << 16], 1 << 10));
    take_all("csv_log", "quotes", "\"".repeat(1 << 20).as_bytes());
    take_all("csv_log", "columns", format!("time,q_0,dq_0,tau_J_0{}\n", ",x".repeat(DEEP)).as_bytes());
    take_all("csv_log", "joints", format!("time,q_0,dq_0,tau_J_{}\n", u64::MAX).as_bytes());
    for header in [b"PAR1".to_vec(), b"\x89MCAP0\r\n".to_vec()] {
        let lengths = [&header[..], &[0xff; 4096], b"PAR1"].concat();
        take_all("parquet_log", "lengths", &lengths);
        take_all("mcap_log", "lengths", &lengths);
    }
    // A definition that doubles at every level.
    let levels: String = (0..60).map(|k| format!("===\nMSG: p/M{k}\nM{0} a\nM{0} b\n", k + 1)).collect();
    take_all(
        "mcap_message",
        "definition",
        format!("p/M\n--\nM0 a\n{levels}===\nMSG: p/M60\nuint8 x\n--\nx").as_bytes(),
    );
}

#[test]
fn arguments() {
    take_all("arguments", "many", "tune\n--json\n".repeat(20_000).as_bytes());
    take_all("arguments", "long", format!("tune\n--seed\n{}", "9".repeat(1 << 20)).as_bytes());
    take_all("arguments", "dashes", "-".repeat(1 << 20).as_bytes());
    take_all("arguments", "flags", format!("-{}", "v".repeat(1 << 16)).as_bytes());
}
