//! Story: on a processor from before 2013 the command says so, in place of an illegal instruction.
//!
//! Witness: the machine code. What runs before the answer has no instruction with a VEX prefix (their names begin with v).

#![cfg(target_arch = "x86_64")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::process::Command;

const TRIBO: &str = env!("CARGO_BIN_EXE_tribo");

/// Bytes of machine code that are read from the start of a function.
const LONGEST_FUNCTION: u64 = 0x4000;
/// Bytes in which something is compiled for this processor.
const A_LOT_OF_CODE: u64 = 0x10_0000;

/// What a program prints; none where there is no such program.
fn printed(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// So many bytes of machine code from an address on: name and operands of each instruction. The command is built without symbols.
fn disassembled(from: u64, bytes: u64) -> Vec<(String, String)> {
    let range = [format!("--start-address={from:#x}"), format!("--stop-address={:#x}", from + bytes)];
    let text = printed("objdump", &["--disassemble", "--no-show-raw-insn", &range[0], &range[1], TRIBO]).unwrap();
    let parted = text.lines().filter_map(|line| line.trim().split_once(":\t"));
    let split = |code: &str| {
        code.split_once(' ').map_or((code.to_owned(), String::new()), |(a, b)| (a.to_owned(), b.trim().to_owned()))
    };
    parted.map(|(_, code)| split(code.trim())).collect()
}

/// Those of a function, up to the padding behind it.
fn instructions(from: u64) -> Vec<(String, String)> {
    disassembled(from, LONGEST_FUNCTION).into_iter().take_while(|(name, _)| name != "int3").collect()
}

/// The address that an instruction loads: `lea 0x10(%rip),%rdi   # 6ba080 <main>`.
fn loaded((name, operands): &(String, String)) -> Option<u64> {
    let address = operands.split_once("# ")?.1.split_whitespace().next()?;
    (name == "lea").then(|| u64::from_str_radix(address, 16).ok())?
}

/// The address that an instruction calls: `call 6b9f40 <…>`.
fn called((name, operands): &(String, String)) -> Option<u64> {
    (name == "call").then(|| u64::from_str_radix(operands.split_whitespace().next()?, 16).ok())?
}

/// Whether a processor needs AVX for it.
fn new((name, _): &&(String, String)) -> bool {
    name.starts_with('v')
}

#[test]
fn nothing_before_the_question_needs_a_new_processor() {
    let Some(header) = printed("objdump", &["--file-headers", TRIBO]) else {
        return println!("SKIPPED: no objdump here");
    };
    // Entry of the file, `main` of C, `main` of Rust: each loads the address of the next.
    let entry = header.lines().find_map(|line| line.strip_prefix("start address 0x")).unwrap();
    let entry = instructions(u64::from_str_radix(entry.trim(), 16).unwrap());
    let to_c_main = |one: &&(String, String)| one.1.contains("%rdi") && loaded(one).is_some();
    let c_main = instructions(entry.iter().find(to_c_main).and_then(loaded).unwrap());
    let main_at = c_main.iter().find_map(loaded).unwrap();
    let main = instructions(main_at);
    assert_eq!(c_main.iter().find(new), None);
    // The standard library's way to main.
    assert_eq!(c_main.iter().filter_map(called).flat_map(instructions).find(|one| new(&one)), None);

    let asked = main.iter().position(|(name, _)| name == "call").unwrap();
    assert_eq!(main[..asked].iter().find(new), None);
    let question = instructions(called(&main[asked]).unwrap());
    assert_eq!(question.iter().find(new), None);
    // Asked in place, or, without optimisation, by a function of the standard library that was compiled here.
    let asks = |all: &[(String, String)]| all.iter().any(|(name, _)| name == "cpuid");
    let asked_within: Vec<_> = question.iter().filter_map(called).map(instructions).filter(|all| asks(all)).collect();
    assert_eq!(asked_within.iter().flatten().find(new), None);
    assert!(asks(&question) || !asked_within.is_empty(), "{question:?}");

    // The answer of the witness can be no: the command itself is compiled for new ones.
    let code = disassembled(main_at, A_LOT_OF_CODE);
    assert!(
        !cfg!(target_feature = "avx2") || code.iter().any(|one| new(&one)),
        "nothing is compiled for new processors"
    );
}
