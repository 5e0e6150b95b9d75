//! Names that come from elsewhere (of robots, joints, nodes) in the text of another program.

/// Text inside a comment of any language here, on one line: letters, digits and harmless signs of ASCII; all else is `_`,
/// and so is the second of two strokes. Nothing can end the comment, continue its line or turn the direction of writing.
pub(super) fn in_comment(text: &str) -> String {
    let harmless = |letter: char| letter.is_ascii_alphanumeric() || " _.,:;()[]+-=/'".contains(letter);
    let mut safe: String = text.chars().map(|letter| if harmless(letter) { letter } else { '_' }).collect();
    for (stroke, broken) in [("--", "-_"), ("//", "/_")] {
        while safe.contains(stroke) {
            safe = safe.replace(stroke, broken);
        }
    }
    safe
}

/// A YAML scalar in double quotes; what YAML does not print, and all beyond ASCII, is escaped.
pub(super) fn yaml_string(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match (letter, u32::from(letter)) {
            ('"' | '\\', _) => quoted.extend(['\\', letter]),
            (' '..='~', _) => quoted.push(letter),
            (_, code @ 0..=0xff) => quoted.push_str(&format!("\\x{code:02x}")),
            (_, code @ 0..=0xffff) => quoted.push_str(&format!("\\u{code:04x}")),
            (_, code) => quoted.push_str(&format!("\\U{code:08x}")),
        }
    }
    quoted.push('"');
    quoted
}

/// Whether a text is an identifier of C, Rust and ROS.
pub(super) fn is_identifier(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_')
        && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leaves_a_comment() {
        assert_eq!(in_comment("a*/b--c\\\n//x\u{202e}τ??/"), "a_/b-_c__/_x____/");
        assert_eq!(in_comment("J 2.95 [N + Nm], ur10e"), "J 2.95 [N + Nm], ur10e");
    }

    #[test]
    fn yaml_reads_back_any_string() {
        let odd = "\"\\\n\t\u{0}\u{7f}\u{85}τ\u{2028}\u{1f600}: # - & * ! | > ' % @ `";
        assert_eq!(serde_saphyr::from_str::<String>(&yaml_string(odd)).expect("YAML"), odd);
    }

    #[test]
    fn identifiers_begin_with_a_letter() {
        assert!(is_identifier("tribo_2") && is_identifier("_x"));
        assert!(!is_identifier("2x") && !is_identifier("") && !is_identifier("a b") && !is_identifier("é"));
    }
}
