//! Text in HTML and SVG.

/// Text as it stands in an element or a quoted attribute; control characters, which XML forbids, show as `�`.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(letter),
            control if control.is_control() => escaped.push('\u{fffd}'),
            letter => escaped.push(letter),
        }
    }
    escaped
}

/// [`escape`] for sentences: `joint 3`, `62 %` and the like stay on one line.
pub fn escape_sentence(text: &str) -> String {
    const BEFORE_DIGIT: [&str; 2] = ["joint ", "link "];
    let mut tied = escape(text).replace(" %", "\u{a0}%").replace(" Nm", "\u{a0}Nm");
    for digit in '0'..='9' {
        // A joint with its name: `panda_joint4 (3)`.
        tied = tied.replace(&format!(" ({digit})"), &format!("\u{a0}({digit})"));
        for word in BEFORE_DIGIT {
            tied = tied.replace(&format!("{word}{digit}"), &format!("{}\u{a0}{digit}", word.trim_end()));
        }
    }
    tied
}

#[cfg(test)]
mod tests {
    use super::{escape, escape_sentence};

    #[test]
    fn numbers_stay_with_what_they_count() {
        let tied = escape_sentence("joint 3 < joint x: 62 % of 4 Nm, elbow (2)");
        assert_eq!(tied, "joint\u{a0}3 &lt; joint x: 62\u{a0}% of 4\u{a0}Nm, elbow\u{a0}(2)");
    }

    #[test]
    fn nothing_gets_through() {
        let escaped = escape("<script>alert('\"&\u{0}\u{1b}')</script>");
        assert_eq!(escaped, "&lt;script&gt;alert(&#39;&quot;&amp;\u{fffd}\u{fffd}&#39;)&lt;/script&gt;");
        assert_eq!(escape("τ = −1 Nm²\n"), "τ = −1 Nm²\n");
    }
}
