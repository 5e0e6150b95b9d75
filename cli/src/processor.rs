//! Whether this processor can run what was compiled.
//!
//! What asks must run where the answer is no: this module is arithmetic on words and calls of the standard library, which comes
//! compiled for every processor. A table, a vector or a formatted message would be moved by the very instructions in question
//! (`cli/tests/command_line/old_processor.rs` looks at the machine code).

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{__cpuid, __cpuid_count};
use std::io::Write;

/// Bits of AVX2, FMA and BMI2 that this binary was compiled for. Standard Rust answers `is_x86_feature_detected!` for these without asking
/// the processor.
const COMPILED: u32 = cfg!(target_feature = "avx2") as u32
    | (cfg!(target_feature = "fma") as u32) << 1
    | (cfg!(target_feature = "bmi2") as u32) << 2;

macro_rules! sentence {
    ($lacking:literal) => {
        concat!(
            "tribo: this binary needs ",
            $lacking,
            ", which this processor does not have; build it here with RUSTFLAGS=\"-C target-cpu=x86-64\"\n"
        )
    };
}

/// What is said where these bits are lacking.
static SENTENCES: [&str; 8] = [
    "",
    sentence!("AVX2"),
    sentence!("FMA"),
    sentence!("AVX2, FMA"),
    sentence!("BMI2"),
    sentence!("AVX2, BMI2"),
    sentence!("FMA, BMI2"),
    sentence!("AVX2, FMA, BMI2"),
];

/// Says on standard error what this processor lacks, and whether it lacks anything.
#[inline(never)]
pub fn lacks_something() -> bool {
    let sentence = SENTENCES[lacking(COMPILED, there())];
    if sentence.is_empty() {
        return false;
    }
    // Whoever cannot be told gets the exit code.
    let _ = std::io::stderr().write_all(sentence.as_bytes());
    true
}

/// Bits that are compiled in and not there.
#[inline(always)]
const fn lacking(compiled: u32, there: u32) -> usize {
    (compiled & !there & 7) as usize
}

/// Bits of this processor.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn there() -> u32 {
    let most = __cpuid(0).eax;
    let fma = __cpuid(1).ecx >> 12 & 1;
    let extended = if most >= 7 { __cpuid_count(7, 0).ebx } else { 0 };
    (extended >> 5 & 1) | fma << 1 | (extended >> 8 & 1) << 2
}

/// Nobody can tell.
#[cfg(not(target_arch = "x86_64"))]
fn there() -> u32 {
    7
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_compiled_in_must_be_there() {
        assert!(!lacks_something(), "this test would not run");
        let said = |compiled, there| SENTENCES[lacking(compiled, there)];
        assert!(said(3, 6).starts_with("tribo: this binary needs AVX2, which this processor"), "{}", said(3, 6));
        assert!(said(7, 0).contains("AVX2, FMA, BMI2") && said(5, 2).contains("needs AVX2, BMI2,"));
        assert_eq!((said(0, 0), said(7, 7), said(2, 7)), ("", "", ""));
    }

    /// An independent answer: the standard library asks the processor for what was not compiled in.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn the_processor_has_what_it_was_compiled_for() {
        assert_eq!(there() & COMPILED, COMPILED);
        let standard =
            [is_x86_feature_detected!("avx2"), is_x86_feature_detected!("fma"), is_x86_feature_detected!("bmi2")];
        for (k, known) in standard.into_iter().enumerate() {
            assert_eq!(there() >> k & 1 == 1, known, "{k}");
        }
    }
}
