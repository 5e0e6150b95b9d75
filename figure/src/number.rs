//! Numbers for people: as many digits as the interval supports, with the unit that the name carries.

/// Smallest and largest magnitude written without a power of ten.
const PLAIN: std::ops::Range<f64> = 1e-4..1e6;

/// A value with `digits` significant digits and a true minus sign; `–` if it is not finite.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    if !PLAIN.contains(&value.abs()) {
        return format!("{value:.*e}", digits.saturating_sub(1)).replace('-', "−");
    }
    fixed(value, digits as i32 - 1 - value.abs().log10().floor() as i32)
}

/// A value with `decimals` decimals and a true minus sign; never `−0`.
pub fn fixed(value: f64, decimals: i32) -> String {
    let text = format!("{value:.*}", decimals.clamp(0, 9) as usize);
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    text.replace('-', if zero { "" } else { "−" })
}

/// Decimals that show an interval: one digit of its half width, two where that begins with 1.
pub fn decimals_of_interval(low: f64, high: f64) -> Option<i32> {
    let half = 0.5 * (high - low).abs();
    if !half.is_finite() || half < 1e-12 {
        return None;
    }
    let magnitude = half.log10().floor();
    let leading = half / 10f64.powf(magnitude);
    Some(-(magnitude as i32) + i32::from(leading < 2.0))
}

/// `0.41 Nm [0.38, 0.44]`; without a finite interval three significant digits.
pub fn with_interval(value: f64, ci95: [f64; 2], unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let [low, high] = ci95;
    match decimals_of_interval(low, high) {
        Some(decimals) if value.abs() < PLAIN.end && decimals <= 6 => {
            format!("{}{unit} [{}, {}]", fixed(value, decimals), fixed(low, decimals), fixed(high, decimals))
        }
        Some(_) => format!("{}{unit} [{}, {}]", significant(value, 3), significant(low, 3), significant(high, 3)),
        None => format!("{}{unit}", significant(value, 3)),
    }
}

/// A part as percent: `62 %`; one decimal below ten.
pub fn percent(part: f64) -> String {
    if !part.is_finite() {
        return "–".to_owned();
    }
    // Far beyond the whole, digits mean nothing: a constant signal has no variance to be a part of.
    if part.abs() >= 100.0 {
        return format!("{} %", significant(100.0 * part, 2));
    }
    format!("{} %", fixed(100.0 * part, i32::from(part.abs() < 0.0995)))
}

/// A part with its interval as percent: `62 % [58, 66]`.
pub fn percent_with_interval(part: f64, [low, high]: [f64; 2]) -> String {
    if !(low.is_finite() && high.is_finite()) {
        return percent(part);
    }
    let decimals = i32::from(part.abs() < 0.0995 && high - low < 0.2);
    let [part, low, high] = [part, low, high].map(|value| fixed(100.0 * value, decimals));
    format!("{part} % [{low}, {high}]")
}

/// A probability: `p < 0.001` below what block permutations can resolve.
pub fn probability(p: f64) -> String {
    if !p.is_finite() {
        "–".to_owned()
    } else if p < 1e-3 {
        "< 0.001".to_owned()
    } else {
        significant(p, 2)
    }
}

/// Splits `stiffness_nm_per_rad` into what it is and its unit.
///
/// A name without a known suffix is without a unit.
pub fn quantity_and_unit(name: &str) -> (String, &'static str) {
    // Longest first: `_nm_s_per_rad` also ends with `_rad`.
    const SUFFIXES: [(&str, &str); 14] = [
        ("_nm_s_per_rad", "Nm s/rad"),
        ("_s_per_rad", "s/rad"),
        ("_first_moment_kg_m", "kg m"),
        ("_nm_per_rad", "Nm/rad"),
        ("_per_rev", "1/rev"),
        ("_kg_m2", "kg m²"),
        ("_rad_s", "rad/s"),
        ("_rad", "rad"),
        ("_nm", "Nm"),
        ("_kg", "kg"),
        ("_hz", "Hz"),
        ("_s", "s"),
        ("_m", "m"),
        ("_n", "N"),
    ];
    for (suffix, unit) in SUFFIXES {
        if let Some(stem) = name.strip_suffix(suffix) {
            let stem = if suffix == "_first_moment_kg_m" { format!("{stem} first moment") } else { stem.to_owned() };
            return (stem.replace('_', " "), unit);
        }
    }
    (name.replace('_', " "), "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_interval() {
        assert_eq!(with_interval(0.4123, [0.381, 0.443], "Nm"), "0.41 Nm [0.38, 0.44]");
        assert_eq!(with_interval(0.4123, [0.400, 0.424], "Nm"), "0.412 Nm [0.400, 0.424]");
        assert_eq!(with_interval(12_345.0, [11_900.0, 12_800.0], "Nm/rad"), "12345 Nm/rad [11900, 12800]");
        assert_eq!(with_interval(-0.02, [-0.05, 0.01], ""), "−0.02 [−0.05, 0.01]");
        assert_eq!(with_interval(2.0, [f64::NAN, 3.0], "s"), "2.00 s");
        assert_eq!(with_interval(2.0, [2.0, 2.0], "s"), "2.00 s");
        assert_eq!(with_interval(3.2e-7, [3.0e-7, 3.4e-7], "rad"), "3.20e−7 rad [3.00e−7, 3.40e−7]");
        assert_eq!(with_interval(0.0, [-0.02, 0.02], "Nm"), "0.00 Nm [−0.02, 0.02]");
    }

    #[test]
    fn parts_and_probabilities() {
        assert_eq!(percent(0.6234), "62 %");
        assert_eq!(percent(0.0123), "1.2 %");
        assert_eq!(percent(-0.0001), "0.0 %");
        assert_eq!(percent(5.2e300), "5.2e302 %");
        assert_eq!(percent_with_interval(0.62, [0.578, 0.661]), "62 % [58, 66]");
        assert_eq!(probability(1e-9), "< 0.001");
        assert_eq!(probability(0.0123), "0.012");
        assert_eq!(significant(f64::INFINITY, 3), "–");
        assert_eq!(significant(1234.5, 3), "1234");
    }

    #[test]
    fn every_parameter_name_has_its_unit() {
        for (name, quantity, unit) in [
            ("breakaway_minus_coulomb_nm", "breakaway minus coulomb", "Nm"),
            ("stribeck_velocity_rad_s", "stribeck velocity", "rad/s"),
            ("delta_viscous_nm_s_per_rad", "delta viscous", "Nm s/rad"),
            ("delta_first_moment_kg_m", "delta first moment", "kg m"),
            ("inverse_stribeck_velocity_s_per_rad", "inverse stribeck velocity", "s/rad"),
            ("delta_rotor_inertia_kg_m2", "delta rotor inertia", "kg m²"),
            ("cycles_per_rev", "cycles", "1/rev"),
            ("stiffness_nm_per_rad", "stiffness", "Nm/rad"),
            ("com_m", "com", "m"),
            ("force_n", "force", "N"),
            ("moment_nm", "moment", "Nm"),
            ("delay_s", "delay", "s"),
            ("gain_error", "gain error", ""),
            ("axis", "axis", ""),
            ("mass_kg", "mass", "kg"),
        ] {
            assert_eq!(quantity_and_unit(name), (quantity.to_owned(), unit));
        }
    }
}
