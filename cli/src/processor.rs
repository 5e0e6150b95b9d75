//! Whether this processor can run what was compiled.

/// Instructions this binary was compiled for and this processor lacks; empty where nobody can tell.
///
/// Standard Rust answers `is_x86_feature_detected!` for what it was compiled with without asking the processor.
pub fn lacking() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    {
        let cpuid = raw_cpuid::CpuId::new();
        let basic = cpuid.get_feature_info();
        let extended = cpuid.get_extended_feature_info();
        lacking_of(
            [cfg!(target_feature = "avx2"), cfg!(target_feature = "fma"), cfg!(target_feature = "bmi2")],
            [
                extended.as_ref().is_some_and(|features| features.has_avx2()),
                basic.as_ref().is_some_and(|features| features.has_fma()),
                extended.as_ref().is_some_and(|features| features.has_bmi2()),
            ],
        )
    }
    #[cfg(not(target_arch = "x86_64"))]
    Vec::new()
}

/// Names of what is compiled in and not there, of AVX2, FMA and BMI2.
#[cfg(target_arch = "x86_64")]
fn lacking_of(compiled: [bool; 3], there: [bool; 3]) -> Vec<&'static str> {
    let names = ["AVX2", "FMA", "BMI2"].into_iter().zip(compiled).zip(there);
    names.filter_map(|((name, compiled), there)| (compiled && !there).then_some(name)).collect()
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn what_was_compiled_in_must_be_there() {
        assert!(lacking().is_empty(), "this test would not run");
        assert_eq!(lacking_of([true, true, false], [false, true, false]), ["AVX2"]);
        assert!(lacking_of([false; 3], [false; 3]).is_empty());
    }
}
