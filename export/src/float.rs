//! Numbers in the text of another program.

/// The largest finite number, in C.
pub(super) const MOST_FINITE: &str = "1.7976931348623157e+308";

/// The shortest text that reads back as `value`, in a form that every target takes for a floating-point number: YAML 1.1
/// (and with it ROS, where `3` is an integer and `1e-5` a string to some readers), C99, Rust, XML.
///
/// ```text
/// 3 → 3.0     1e-5 → 1.0e-05     −0 → −0.0
/// ```
///
/// `value` must be finite; what is validated is.
pub(super) fn float(value: f64) -> String {
    let shortest = format!("{value:?}");
    match shortest.split_once('e') {
        None => shortest,
        Some((mantissa, exponent)) => {
            let dot = if mantissa.contains('.') { "" } else { ".0" };
            let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |digits| ('-', digits));
            format!("{mantissa}{dot}e{sign}{digits:0>2}")
        }
    }
}

/// Values of all joints, separated by commas.
pub(super) fn floats(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(float).collect::<Vec<_>>().join(", ")
}

/// Values separated by spaces, as attributes of XML have them.
pub(super) fn spaced(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(float).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_like_a_floating_point_number_and_reads_back_to_the_last_bit() {
        for (value, text) in [(3.0, "3.0"), (1e-5, "1.0e-05"), (-0.0, "-0.0"), (1.5e300, "1.5e+300"), (0.1, "0.1")] {
            assert_eq!(float(value), text);
        }
        let mut state = 0x9E37_79B9_7F4A_7C15_u64;
        for _ in 0..100_000 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let value = f64::from_bits(state);
            if value.is_finite() {
                let text = float(value);
                assert_eq!(text.parse::<f64>().expect(&text).to_bits(), value.to_bits());
                assert!(
                    text.contains('.') && text.split('e').nth(1).is_none_or(|e| e.starts_with(['+', '-'])),
                    "{text}"
                );
            }
        }
    }
}
