//! Story: exported C and Rust is the compensator, for every law, velocity source and effect.
//!
//! Witnesses: the C and C++ compilers with every warning an error, rustc likewise, and 10 000 states per variant, among
//! them ±0, the smallest numbers, the threshold itself and its neighbours, 1e300 and what is not a number. What is hostile is in
//! `bounds.rs` beside this file.

#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{Draws, EFFECTS, SOURCES, exported, laws, model, output, there, tuned};
use nalgebra::SVector;
use tribo_export::{Format, TunedCompensator};
use tribo_friction::{Bristles, Compensator, CompensatorInput, VelocitySource};
use tribo_model::TunedFile;

const STATES: usize = 10_000;
/// Of the torques' own size, or of 1 Nm: rounding of a few terms of that size.
const TOLERANCE: f64 = 1e-12;
/// Numbers of one state: q, both velocities, load, and the period.
const WIDTH: usize = 4 * 7 + 1;

/// One exported compensator.
struct Variant {
    tuned: TunedFile,
    effects: bool,
    /// What it ought to give: all joints of all states.
    expected: Vec<f64>,
}

/// Every law by every source, with and without effects; hard signs; six joints.
fn variants(states: &[f64]) -> Vec<Variant> {
    let mut variants = Vec::new();
    for source in SOURCES {
        for friction in laws::<7>() {
            for (effects, smoothing) in [(false, None), (true, None), (true, Some(0.0))] {
                let mut tuned = tuned("panda", friction, source);
                tuned.model = effects.then(|| model(&format!("robot: panda\n{EFFECTS}")));
                tuned.friction.smoothing_rad_s = smoothing.unwrap_or(tuned.friction.smoothing_rad_s);
                variants.push(Variant { expected: expected::<7>(&tuned, states), tuned, effects });
            }
        }
        let tuned = tuned("ur10e", laws::<6>()[1], source);
        variants.push(Variant { expected: expected::<6>(&tuned, states), tuned, effects: false });
    }
    variants
}

fn expected<const N: usize>(tuned: &TunedFile, states: &[f64]) -> Vec<f64> {
    let compensator: Compensator<N> = TunedCompensator::of(tuned).expect("valid").compensator;
    let mut bristles = Bristles::default();
    let vector = |state: &[f64], k: usize| SVector::from_column_slice(&state[7 * k..7 * k + N]);
    let torque = |state: &[f64]| {
        let mut input = CompensatorInput {
            q: vector(state, 0),
            qd_measured: vector(state, 1),
            qd_reference: vector(state, 2),
            load_nm: vector(state, 3),
            dt_s: state[WIDTH - 1],
        };
        // The head of the file: no torque for a velocity that cannot be, which leaves the memory alone, as standing does.
        let mut left_out = [false; N];
        for (j, left_out) in left_out.iter_mut().enumerate() {
            let measured = input.qd_measured[j];
            let believed = match tuned.velocity {
                VelocitySource::Measured => measured,
                VelocitySource::Hybrid if measured.is_finite() && measured.abs() > tuned.hybrid_threshold_rad_s => {
                    measured
                }
                VelocitySource::Reference | VelocitySource::Hybrid => input.qd_reference[j],
            };
            *left_out = believed.is_nan() || believed.abs() > 1e3;
            let believed = if *left_out { 0.0 } else { believed };
            (input.qd_measured[j], input.qd_reference[j]) = (believed, believed);
        }
        let torque = compensator.tick(&mut bristles, &input).total();
        SVector::<f64, N>::from_fn(
            |j, _| if left_out[j] { 0.0 } else { torque[j].clamp(-most_nm(N, j), most_nm(N, j)) },
        )
    };
    states.chunks(WIDTH).map(torque).flat_map(|torque| torque.as_slice().to_vec()).collect()
}

/// Half of the largest torques (Nm) of the Panda (87 and 12 Nm) and of the UR10e (330, 150 and 56 Nm).
fn most_nm(joints: usize, joint: usize) -> f64 {
    match joints {
        7 => [43.5, 43.5, 43.5, 43.5, 6.0, 6.0, 6.0][joint],
        _ => [165.0, 165.0, 75.0, 28.0, 28.0, 28.0][joint],
    }
}

/// States of the loop: q, measured and reference velocity, load of seven joints, period.
fn states() -> Vec<f64> {
    let threshold = Compensator::<7>::DEFAULT_HYBRID_THRESHOLD_RAD_S;
    let odd = [
        0.0,
        f64::MIN_POSITIVE / 4.0,
        1e-300,
        1e-12,
        threshold.next_down(),
        threshold,
        threshold.next_up(),
        1e3,
        1e300,
        f64::NAN,
    ];
    let mut draws = Draws::new(1);
    let velocity = |draws: &mut Draws| {
        let size = match (draws.uniform() * 20.0) as usize {
            0 => odd[(draws.uniform() * odd.len() as f64) as usize],
            1..8 => 10_f64.powf(draws.between(-6.0, 0.5)),
            _ => draws.between(0.0, 3.0),
        };
        size.copysign(draws.uniform() - 0.5)
    };
    let mut states = Vec::new();
    for _ in 0..STATES {
        states.extend((0..7).map(|_| draws.between(-3.0, 3.0)));
        states.extend((0..14).map(|_| velocity(&mut draws)));
        states.extend((0..7).map(|_| draws.between(-80.0, 80.0)));
        states.push(draws.between(2e-4, 2e-3));
    }
    states
}

fn bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_ne_bytes()).collect()
}

/// Holds a program's torques of all variants and states against the expected ones.
fn compare(language: &str, variants: &[Variant], bytes: &[u8]) {
    let torques: Vec<f64> =
        bytes.chunks(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().expect("eight bytes"))).collect();
    assert_eq!(torques.len(), variants.iter().map(|variant| variant.expected.len()).sum::<usize>());
    let (mut at, mut worst) = (0, 0.0_f64);
    for (k, variant) in variants.iter().enumerate() {
        for (i, expected) in variant.expected.iter().enumerate() {
            let torque = torques[at + i];
            let same = torque == *expected;
            let off = if same { 0.0 } else { (torque - expected).abs() / expected.abs().max(1.0) };
            assert!(
                off <= TOLERANCE,
                "{language}, variant {k} {:?} {:?}, value {i}: {torque} in place of {expected}",
                variant.tuned.friction.law,
                variant.tuned.velocity
            );
            worst = worst.max(off);
        }
        at += variant.expected.len();
    }
    println!("{language}: {} variants of {STATES} states, off by at most {worst:.1e}", variants.len());
}

/// A program that includes every header and prints the torques of all states as bytes.
fn c_program(at: &Path, variants: &[Variant]) {
    let mut includes = String::from("#include <stdio.h>\n#include <stdlib.h>\n");
    let mut calls = String::new();
    for (k, variant) in variants.iter().enumerate() {
        let header = exported(&variant.tuned, Format::C, Some(&format!("v{k}"))).text;
        std::fs::write(at.join(format!("v{k}.h")), header).expect("written");
        includes.push_str(&format!("#include \"v{k}.h\"\n"));
        let call = match variant.effects {
            false => format!("v{k}_compensate(s + 7, s + 14, tau)"),
            true => format!("v{k}_compensate(s, s + 7, s + 14, s + 21, s[28], z, tau)"),
        };
        let memory = if variant.effects { format!("double z[V{k}_BRISTLES] = {{0}};") } else { String::new() };
        calls.push_str(&format!(
            "    {{\n        {memory}\n        double tau[V{k}_JOINTS];\n        \
             for (i = 0; i < {STATES}; ++i) {{\n            const double *s = states + {WIDTH} * i;\n            {call};\n            \
             fwrite(tau, sizeof(double), V{k}_JOINTS, stdout);\n        }}\n    }}\n"
        ));
    }
    let main = format!(
        "{includes}\nstatic double states[{} * {STATES}];\n\nint main(void)\n{{\n    int i;\n    \
         if (fread(states, sizeof(double), {WIDTH} * {STATES}, stdin) != {WIDTH} * {STATES}) return 1;\n{calls}    return 0;\n}}\n",
        WIDTH
    );
    std::fs::write(at.join("main.c"), main).expect("written");
}

/// The program reads the states from a file that it is given on standard input.
fn run(at: &Path) -> Vec<u8> {
    let states = std::fs::File::open(at.join("states")).expect("states");
    let output = std::process::Command::new(at.join("program")).stdin(states).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

#[test]
fn exported_sources_are_the_compensator() {
    let at = tempfile::tempdir().expect("a directory");
    let at = at.path();
    let states = states();
    std::fs::write(at.join("states"), bytes(&states)).expect("written");
    let variants = variants(&states);
    assert!(variants.iter().all(|variant| variant.expected.contains(&0.0)));
    assert!(variants.iter().any(|variant| variant.expected.contains(&6.0) && variant.expected.contains(&-6.0)));

    c_program(at, &variants);
    let warnings = ["-Wall", "-Wextra", "-Werror", "-pedantic", "-O2"];
    let mut c = vec!["-std=c99"];
    c.extend(warnings);
    output(at, "cc", &[&c[..], &["main.c", "-o", "program", "-lm"]].concat());
    compare("C99", &variants, &run(at));
    if there("c++") {
        let mut cpp = vec!["-std=c++11"];
        cpp.extend(warnings);
        output(at, "c++", &[&cpp[..], &["-x", "c++", "main.c", "-o", "program"]].concat());
        compare("C++11", &variants, &run(at));
    } else {
        println!("no C++ compiler here");
    }

    let (mut modules, mut calls) = (String::new(), String::new());
    for (k, variant) in variants.iter().enumerate() {
        std::fs::write(at.join(format!("v{k}.rs")), exported(&variant.tuned, Format::Rust, None).text)
            .expect("written");
        modules.push_str(&format!("mod v{k};\n"));
        let call = match variant.effects {
            false => format!("v{k}::compensate(part(s, 1), part(s, 2))"),
            true => format!("v{k}::compensate(part(s, 0), part(s, 1), part(s, 2), part(s, 3), s[28], &mut z)"),
        };
        let memory = if variant.effects { format!("let mut z = [0.0; v{k}::BRISTLES];") } else { String::new() };
        calls.push_str(&format!(
            "    {{\n        {memory}\n        for s in states.chunks({WIDTH}) {{\n            \
             let tau: [f64; v{k}::JOINTS] = {call};\n            print(&tau);\n        }}\n    }}\n"
        ));
    }
    let main = format!(
        "#![deny(warnings)]\nuse std::io::{{Read, Write}};\n{modules}\n\
         fn part<const N: usize>(s: &[f64], k: usize) -> &[f64; N] {{ s[7 * k..7 * k + N].try_into().unwrap() }}\n\
         fn print(tau: &[f64]) {{ for t in tau {{ std::io::stdout().write_all(&t.to_ne_bytes()).unwrap(); }} }}\n\
         fn main() {{\n    let mut bytes = Vec::new();\n    std::io::stdin().read_to_end(&mut bytes).unwrap();\n    \
         let states: Vec<f64> = bytes.chunks(8).map(|b| f64::from_ne_bytes(b.try_into().unwrap())).collect();\n{calls}}}\n"
    );
    std::fs::write(at.join("main.rs"), main).expect("written");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    output(at, &rustc, &["--edition", "2021", "-O", "main.rs", "-o", "program"]);
    compare("Rust", &variants, &run(at));
}

/// A robot may be called anything.
#[test]
fn odd_names_stay_in_the_comment() {
    let at = tempfile::tempdir().expect("a directory");
    let at = at.path();
    for (k, name) in ["a*/ int x;\n/* b", "??/\\", "\u{202e}τ\r\n#error", "//", "\" ' {} %s"].into_iter().enumerate() {
        let tuned = tuned(name, laws::<7>()[0], SOURCES[2]);
        std::fs::write(at.join("v.h"), exported(&tuned, Format::C, None).text).expect("written");
        std::fs::write(at.join("main.c"), "#include \"v.h\"\nint main(void) { return TRIBO_JOINTS - 7; }\n")
            .expect("written");
        output(at, "cc", &["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "main.c", "-o", "program", "-lm"]);
        std::fs::write(at.join("v.rs"), exported(&tuned, Format::Rust, None).text).expect("written");
        std::fs::write(at.join("main.rs"), "#![deny(warnings)]\npub mod v;\n").expect("written");
        output(at, "rustc", &["--crate-type", "lib", "--edition", "2021", "main.rs", "-o", &format!("v{k}.rlib")]);
    }
}

/// A compensator without effects needs two velocities; with effects a call with fewer arguments does not compile.
#[test]
fn effects_change_the_signature() {
    let mut tuned = tuned("panda", laws::<7>()[0], SOURCES[2]);
    let plain = exported(&tuned, Format::C, None).text;
    assert!(
        plain.contains("tribo_compensate(const double dq_measured[TRIBO_JOINTS], const double dq_reference"),
        "{plain}"
    );
    tuned.model = Some(model(&format!("robot: panda\n{EFFECTS}- {{cause: time_delay, delay_s: 0.001}}\n")));
    let with_effects = exported(&tuned, Format::C, Some("left_arm"));
    assert!(with_effects.text.contains("left_arm_compensate(const double q[LEFT_ARM_JOINTS]"), "{}", with_effects.text);
    assert!(with_effects.text.contains("#define LEFT_ARM_BRISTLES 21\n"), "two more per joint: {}", with_effects.text);
    let lost =
        |tuned: &TunedFile| exported(tuned, Format::C, None).losses.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert!(matches!(&lost(&tuned)[..], [one] if one.starts_with("time_delay: not cancelled by Tribo either")));
    // A payload is no friction.
    tuned.model = Some(model("robot: panda\npayload: {mass_kg: 1.0}\n"));
    assert!(matches!(&lost(&tuned)[..], [one] if one.starts_with("payload, ") && !one.contains("off by")));
    assert!(exported(&tuned, Format::C, None).text.contains("Not in this file: payload, "));
}
