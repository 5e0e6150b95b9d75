//! Story: an exported compensator hurts nobody, whatever it is given and however it is compiled.
//!
//! Inputs, period and memory are any bits at all: NaN of both signs, infinities, the largest and smallest numbers, garbage. Every torque
//! is finite and within half of its joint's largest; afterwards, on a normal motion, it is that of a compensator that never saw any
//! of it. Witnesses: gcc with the address and undefined-behaviour sanitizers, with `-O3 -ffast-math`, and rustc.

#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{Draws, EFFECTS, SOURCES, exported, laws, model, output, tuned};
use tribo_export::Format;
use tribo_model::TunedFile;

/// Hostile calls, then calls of a normal motion.
const HOSTILE: usize = 8_000;
const NORMAL: usize = 2_000;
/// Calls of the normal motion, at 1 rad/s, after which garbage in the memory is forgotten: 34 of the longest distance of presliding.
const FORGOTTEN: usize = 1_700;
/// q, both velocities, load of seven joints, period, and what is written into the memory before the call.
const WIDTH: usize = 4 * 7 + 1 + 28;
/// Half of the largest torques of a Panda (Nm): 87 and 12.
const MOST_NM: [f64; 7] = [43.5, 43.5, 43.5, 43.5, 6.0, 6.0, 6.0];

/// Every law by every source with all effects, hard signs, and one without effects.
fn variants() -> Vec<TunedFile> {
    let mut variants = vec![tuned("panda", laws::<7>()[1], SOURCES[2])];
    for source in SOURCES {
        for (k, friction) in laws::<7>().into_iter().enumerate() {
            for smoothing in [None, Some(0.0)].into_iter().take(if k == 0 { 2 } else { 1 }) {
                let mut tuned = tuned("panda", friction, source);
                tuned.model = Some(model(&format!("robot: panda\n{EFFECTS}")));
                tuned.friction.smoothing_rad_s = smoothing.unwrap_or(tuned.friction.smoothing_rad_s);
                variants.push(tuned);
            }
        }
    }
    variants
}

fn hostile(draws: &mut Draws) -> f64 {
    let odd = [
        f64::NAN,
        -f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN,
        f64::MIN_POSITIVE,
        f64::from_bits(1),
        -0.0,
        1e9,
        -1e9,
        f64::from_bits(0x7ff0_0000_0000_0001),
    ];
    match (draws.uniform() * 8.0) as usize {
        0..2 => odd[(draws.uniform() * odd.len() as f64) as usize],
        2 => f64::from_bits(
            (draws.uniform() * 2_f64.powi(53)) as u64 ^ ((draws.uniform() * 2_f64.powi(32)) as u64) << 32,
        ),
        3 => draws.between(-1e4, 1e4),
        _ => draws.between(-3.0, 3.0),
    }
}

/// The hostile calls and the normal motion; the memory is written in hostile calls alone.
fn calls() -> Vec<f64> {
    let mut draws = Draws::new(5);
    let mut calls: Vec<f64> = (0..HOSTILE * WIDTH).map(|_| hostile(&mut draws)).collect();
    for k in 0..NORMAL {
        let t = 1e-3 * k as f64;
        calls.extend((0..7).map(|j| 0.3 * t + 0.1 * f64::from(j)));
        calls.extend((0..14).map(|j| 1.0 + 0.3 * (20.0 * t + f64::from(j)).sin()));
        calls.extend((0..7).map(|j| 10.0 - f64::from(j)));
        calls.extend([1e-3].into_iter().chain([0.0; 28]));
    }
    calls
}

fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().expect("eight bytes"))).collect()
}

/// What a program printed: of every variant hostile and normal calls, then the normal ones of a fresh memory.
fn check(how: &str, torques: &[f64], tolerance_nm: f64) {
    let per_variant = 7 * (HOSTILE + 2 * NORMAL);
    assert_eq!(torques.len(), variants().len() * per_variant, "{how}");
    for (v, torques) in torques.chunks(per_variant).enumerate() {
        for (k, torque) in torques.iter().enumerate() {
            assert!(torque.abs() <= MOST_NM[k % 7], "{how}, variant {v}, call {}, joint {}: {torque} Nm", k / 7, k % 7);
        }
        let (after, fresh) = torques[7 * HOSTILE..].split_at(7 * NORMAL);
        for k in 7 * FORGOTTEN..7 * NORMAL {
            assert!(
                (after[k] - fresh[k]).abs() <= tolerance_nm,
                "{how}, variant {v}, value {k}: {} {}",
                after[k],
                fresh[k]
            );
        }
        assert!(fresh.iter().any(|torque| torque.abs() > 0.1), "{how}, variant {v}");
    }
}

fn c_program(at: &Path) {
    let mut includes = "#include <stdio.h>\n#include <stdlib.h>\n".to_owned();
    let mut blocks = String::new();
    for (v, tuned) in variants().iter().enumerate() {
        std::fs::write(at.join(format!("v{v}.h")), exported(tuned, Format::C, Some(&format!("v{v}"))).text)
            .expect("written");
        includes.push_str(&format!("#include \"v{v}.h\"\n"));
        let effects = tuned.model.is_some();
        let call = match effects {
            false => format!("v{v}_compensate(c + 7, c + 14, tau)"),
            true => format!("v{v}_compensate(c, c + 7, c + 14, c + 21, c[28], z, tau)"),
        };
        let (memory, garbage, fresh) = match effects {
            false => (String::new(), String::new(), String::new()),
            true => (
                format!("double z[V{v}_BRISTLES] = {{0}};"),
                format!("if (i < {HOSTILE}) memcpy(z, c + 29, sizeof z);"),
                "memset(z, 0, sizeof z);".to_owned(),
            ),
        };
        let put = "fwrite(tau, sizeof(double), 7, stdout)";
        blocks.push_str(&format!(
            "    {{\n        {memory}\n        double tau[7];\n        \
             for (i = 0; i < {total}; ++i) {{ const double *c = calls + {WIDTH} * i; {garbage} {call}; {put}; }}\n        {fresh}\n        \
             for (i = {HOSTILE}; i < {total}; ++i) {{ const double *c = calls + {WIDTH} * i; {call}; {put}; }}\n    }}\n",
            total = HOSTILE + NORMAL
        ));
    }
    let main = format!(
        "{includes}\nstatic double calls[{count}];\n\nint main(void)\n{{\n    int i;\n    \
         if (fread(calls, sizeof(double), {count}, stdin) != {count}) return 1;\n{blocks}    return 0;\n}}\n",
        count = WIDTH * (HOSTILE + NORMAL)
    );
    std::fs::write(at.join("main.c"), main).expect("written");
}

/// Runs the program on the calls; it says nothing else (a sanitizer would).
fn run(at: &Path) -> Vec<f64> {
    let calls = std::fs::File::open(at.join("calls")).expect("calls");
    let output = std::process::Command::new(at.join("program")).stdin(calls).output().expect("it runs");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    doubles(&output.stdout)
}

fn directory() -> tempfile::TempDir {
    let at = tempfile::tempdir().expect("a directory");
    let bytes: Vec<u8> = calls().iter().flat_map(|number| number.to_ne_bytes()).collect();
    std::fs::write(at.path().join("calls"), bytes).expect("written");
    at
}

/// Whether the compiler can link a program with these flags.
fn links(at: &Path, flags: &[&str]) -> bool {
    std::fs::write(at.join("try.c"), "int main(void) { return 0; }\n").expect("written");
    let mut cc = std::process::Command::new("cc");
    cc.current_dir(at).args(flags).args(["try.c", "-o", "try"]).stderr(std::process::Stdio::null());
    cc.status().is_ok_and(|status| status.success())
}

#[test]
fn no_input_and_no_memory_makes_c_hurt() {
    let at = directory();
    let at = at.path();
    c_program(at);
    let flags: [(&str, &[&str], f64); 3] = [
        ("gcc -O2", &["-O2"], 1e-12),
        // Other mathematics: sums in any order, functions to a few units of the last place.
        ("gcc -O3 -ffast-math", &["-O3", "-ffast-math"], 1e-9),
        ("sanitizers", &["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"], 1e-12),
    ];
    for (how, flags, tolerance_nm) in flags {
        if !links(at, flags) {
            println!("SKIPPED {how}: cc does not link a program with {flags:?}");
            continue;
        }
        let mut all = vec!["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"];
        all.extend(flags);
        output(at, "cc", &[&all[..], &["main.c", "-o", "program", "-lm"]].concat());
        check(how, &run(at), tolerance_nm);
        println!("{how}: {HOSTILE} hostile calls of {} variants", variants().len());
    }
}

#[test]
fn no_input_and_no_memory_makes_rust_hurt() {
    let at = directory();
    let at = at.path();
    let (mut modules, mut blocks) = (String::new(), String::new());
    for (v, tuned) in variants().iter().enumerate() {
        std::fs::write(at.join(format!("v{v}.rs")), exported(tuned, Format::Rust, None).text).expect("written");
        modules.push_str(&format!("mod v{v};\n"));
        let effects = tuned.model.is_some();
        let call = match effects {
            false => format!("v{v}::compensate(part(c, 1), part(c, 2))"),
            true => format!("v{v}::compensate(part(c, 0), part(c, 1), part(c, 2), part(c, 3), c[28], &mut z)"),
        };
        let (memory, garbage, fresh) = match effects {
            false => (String::new(), String::new(), ""),
            true => (
                format!("let mut z = [0.0; v{v}::BRISTLES];"),
                format!("if i < {HOSTILE} {{ z.copy_from_slice(&c[29..29 + v{v}::BRISTLES]); }}"),
                "z.fill(0.0);",
            ),
        };
        blocks.push_str(&format!(
            "    {{\n        {memory}\n        for (i, c) in calls.chunks({WIDTH}).enumerate() {{ let _ = i; {garbage} print(&{call}); }}\n        \
             {fresh}\n        for c in calls.chunks({WIDTH}).skip({HOSTILE}) {{ print(&{call}); }}\n    }}\n"
        ));
    }
    let main = format!(
        "#![deny(warnings)]\nuse std::io::{{Read, Write}};\n{modules}\n\
         fn part(c: &[f64], k: usize) -> &[f64; 7] {{ c[7 * k..7 * k + 7].try_into().unwrap() }}\n\
         fn print(tau: &[f64]) {{ for t in tau {{ std::io::stdout().write_all(&t.to_ne_bytes()).unwrap(); }} }}\n\
         fn main() {{\n    let mut bytes = Vec::new();\n    std::io::stdin().read_to_end(&mut bytes).unwrap();\n    \
         let calls: Vec<f64> = bytes.chunks(8).map(|b| f64::from_ne_bytes(b.try_into().unwrap())).collect();\n{blocks}}}\n"
    );
    std::fs::write(at.join("main.rs"), main).expect("written");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    output(at, &rustc, &["--edition", "2021", "-O", "-C", "overflow-checks=on", "main.rs", "-o", "program"]);
    check("rustc", &run(at), 1e-12);
}

/// Without a known arm the bound is the law's torque at a turn per second; a weak motor's is said to be cut off.
#[test]
fn the_bound_is_said() {
    let known = exported(&tuned("panda", laws::<7>()[0], SOURCES[0]), Format::C, None);
    assert!(known.text.contains("most_nm[TRIBO_JOINTS] = {43.5, 43.5, 43.5, 43.5, 6.0, 6.0, 6.0};"), "{}", known.text);
    assert!(known.text.contains(" * tau is within +- most_nm, always: 0.5 of the joints' largest torques tau_max."));
    assert!(known.losses.is_empty(), "{:?}", known.losses);

    let unknown = exported(&tuned("its_own", laws::<7>()[0], SOURCES[0]), Format::Rust, None).text;
    assert!(
        unknown.contains("always: the torque of the law at 6.28 rad/s, as the joints' largest torques are not known"),
        "{unknown}"
    );
    let first = 1.0 + 1e-3 / 3.0;
    let most = 0.6 * first + 0.9 / first * std::f64::consts::TAU;
    let table = unknown.split("const MOST_NM: [f64; JOINTS] = [").nth(1).expect("a table");
    let written: f64 = table.split(',').next().and_then(|number| number.parse().ok()).expect("a number");
    assert!((written - most).abs() < 1e-12, "{written} {most}");

    let mut strong = laws::<7>()[0];
    strong.joints[6] = tribo_friction::law::CoulombViscous { coulomb_nm: 7.0, viscous_nm_s_per_rad: 0.0 }.into();
    let cut = exported(&tuned("panda", strong, SOURCES[0]), Format::C, None);
    let [loss] = &cut.losses[..] else { panic!("{:?}", cut.losses) };
    assert_eq!(
        loss.to_string(),
        "torques beyond 0.5 of the joints' largest: cut off there; off by up to [0, 0, 0, 0, 0, 0, 1] Nm"
    );
    assert!(cut.text.contains(" * Not in this file: torques beyond 0.5"), "{}", cut.text);
}
