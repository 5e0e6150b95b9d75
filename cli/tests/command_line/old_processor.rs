//! Story: on a processor from before 2013 the command says so, in place of an illegal instruction.
//!
//! Witness: the machine code. What runs before the answer has no instruction with a VEX prefix (their names begin with v).

#![cfg(target_arch = "x86_64")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::process::Command;

const TRIBO: &str = env!("CARGO_BIN_EXE_tribo");

/// What a program prints; none where there is no such program.
fn printed(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The instructions of a function: name and operands.
fn instructions(symbol: &str) -> Vec<(String, String)> {
    let disassemble = format!("--disassemble={symbol}");
    let text = printed("objdump", &["--no-show-raw-insn", &disassemble, TRIBO]).unwrap();
    let parted = text.lines().filter_map(|line| line.trim().split_once(":\t"));
    let split = |code: &str| {
        code.split_once(' ').map_or((code.to_owned(), String::new()), |(a, b)| (a.to_owned(), b.trim().to_owned()))
    };
    parted.map(|(_, code)| split(code.trim())).collect()
}

#[test]
fn nothing_before_the_question_needs_a_new_processor() {
    let Some(symbols) = printed("nm", &[TRIBO]) else { return println!("SKIPPED: no nm here") };
    if printed("objdump", &["--version"]).is_none() {
        return println!("SKIPPED: no objdump here");
    }
    let symbol = |part: &str| {
        let names = symbols.lines().filter_map(|line| line.split_whitespace().last());
        names.filter(|name| name.contains(part)).min_by_key(|name| name.len()).unwrap_or_else(|| panic!("no {part}"))
    };
    let (main, question) =
        (instructions(symbol("5tribo4main")), instructions(symbol("5tribo9processor15lacks_something")));
    let new = |(name, _): &&(String, String)| name.starts_with('v');
    assert_eq!(question.iter().find(new), None);
    // Asked in place, or, without optimisation, by a function of the standard library that was compiled here.
    let calls = question.iter().filter(|(name, to)| name == "call" && to.contains("cpuid"));
    let called: Vec<_> =
        calls.filter_map(|(_, to)| Some(instructions(to.split_once('<')?.1.trim_end_matches('>')))).collect();
    assert_eq!(called.iter().flatten().find(new), None);
    assert!(question.iter().chain(called.iter().flatten()).any(|(name, _)| name == "cpuid"), "{question:?}");
    let asked = main.iter().position(|(name, to)| name == "call" && to.contains("lacks_something")).unwrap();
    assert_eq!(main[..asked].iter().find(new), None);
    // The standard library's way to main, where it was compiled here.
    for start in symbols
        .lines()
        .filter_map(|line| line.split_whitespace().last())
        .filter(|name| name.contains("2rt10lang_start17"))
    {
        assert_eq!(instructions(start).iter().find(new), None, "{start}");
    }
    // The answer of the witness can be no: the command itself is compiled for new ones.
    let run = instructions(symbol("9tribo_cli3run"));
    assert!(
        !cfg!(target_feature = "avx2") || run.iter().any(|one| new(&one)),
        "nothing is compiled for new processors"
    );
}
