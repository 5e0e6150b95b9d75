//! Story: a stranger asks a command for help and finds what an option does if it is left out.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use crate::common::{run, scratch};

/// The text of an option up to the next one.
fn option<'a>(help: &'a str, name: &str) -> &'a str {
    let start = help.find(&format!("{name} <")).unwrap_or_else(|| panic!("no {name} in\n{help}"));
    help[start..].split("\n      --").next().unwrap()
}

/// Every setting of a campaign says its default, and a choice its values; what every command takes stands by itself.
#[test]
fn options_say_their_defaults_and_values() {
    let at = scratch();
    let help = run(at.path(), "tune --help").ok().stdout;
    let settings = [
        "--out",
        "--robot",
        "--seed",
        "--truth",
        "--pose",
        "--velocity",
        "--model",
        "--friction",
        "--residual",
        "--cost",
        "--strategy",
        "--trials",
        "--init",
        "--batch",
        "--stop-below",
        "--bounds",
        "--phases",
    ];
    for name in settings {
        let text = option(&help, name);
        assert!(text.contains("[default:"), "{text}");
    }
    for name in ["--velocity", "--friction", "--residual", "--cost", "--strategy", "--bounds", "--phases"] {
        let text = option(&help, name);
        assert!(text.contains("[possible values:"), "{text}");
    }
    let help = run(at.path(), "ask --help").ok().stdout;
    assert!(option(&help, "--bounds").contains("[possible values:"), "{help}");
    let help = run(at.path(), "listen --help").ok().stdout;
    // Its usage names options too.
    let (_, help) = help.split_once("Options:").unwrap();
    for name in [
        "--model",
        "--robot",
        "--torque-side",
        "--compensator",
        "--residual",
        "--joints",
        "--joint-states",
        "--compensation",
        "--wrench",
        "--diagnostics",
        "--frame",
        "--rate",
        "--domain",
        "--address",
        "--record",
        "--for",
    ] {
        let text = option(help, name);
        assert!(text.contains("[default:"), "{text}");
    }
    for name in ["--torque-side", "--residual"] {
        assert!(option(help, name).contains("[possible values:"), "{help}");
    }
    for command in
        ["tune", "ask", "tell", "simulate", "listen", "estimate", "diagnose", "convert", "export", "report", "study"]
    {
        let help = run(at.path(), &format!("{command} --help")).ok().stdout;
        let (own, common) = help.split_once("Options of every command:").unwrap_or_else(|| panic!("{help}"));
        assert!(["--json", "--quiet", "--verbose", "--threads"].iter().all(|name| common.contains(name)), "{help}");
        assert!(!own.contains("--threads"), "{help}");
    }
}
