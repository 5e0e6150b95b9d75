//! What a terminal must not obey: control characters out of files.
//!
//! ```text
//! U+0000–U+001F but line feed and tab, U+007F–U+009F, marks that turn the direction of writing  ->  \u{1b} in text, \u001b in JSON
//! ```
//!
//! Names of joints, columns, topics and robots come from files of other people, and end up in tables and errors. Everything that
//! the program says goes through here, so that no place has to think of it.

use std::fmt;
use std::io::{self, Write};

/// How a character is written out.
#[derive(Clone, Copy)]
pub enum Form {
    /// `\u{1b}`, for people.
    Text,
    /// `\u001b`, which JSON reads back.
    Json,
}

/// Writes text and a line feed.
///
/// # Errors
/// Those of the stream.
pub fn write_line(stream: &mut dyn Write, form: Form, text: impl fmt::Display) -> io::Result<()> {
    let mut visible = Visible { stream, form, error: Ok(()) };
    let written = fmt::Write::write_fmt(&mut visible, format_args!("{text}\n"));
    visible.error?;
    written.map_err(|_| io::Error::other("text that cannot be formatted"))
}

/// Passes text on with what is not to be obeyed written out.
struct Visible<'s> {
    stream: &'s mut dyn Write,
    form: Form,
    error: io::Result<()>,
}

impl fmt::Write for Visible<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.error = self.pass_on(text);
        if self.error.is_ok() { Ok(()) } else { Err(fmt::Error) }
    }
}

impl Visible<'_> {
    fn pass_on(&mut self, text: &str) -> io::Result<()> {
        let mut rest = text;
        while let Some((at, letter)) = rest.char_indices().find(|&(_, letter)| is_obeyed(letter)) {
            self.stream.write_all(&rest.as_bytes()[..at])?;
            match self.form {
                Form::Text => write!(self.stream, "\\u{{{:x}}}", u32::from(letter))?,
                Form::Json => write!(self.stream, "\\u{:04x}", u32::from(letter))?,
            }
            rest = &rest[at + letter.len_utf8()..];
        }
        self.stream.write_all(rest.as_bytes())
    }
}

fn is_obeyed(letter: char) -> bool {
    (letter.is_control() && !matches!(letter, '\n' | '\t'))
        || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(form: Form, text: &str) -> String {
        let mut bytes = Vec::new();
        write_line(&mut bytes, form, text).expect("memory");
        String::from_utf8(bytes).expect("text")
    }

    #[test]
    fn nothing_is_obeyed_and_everything_else_is_as_it_was() {
        assert_eq!(
            written(Form::Text, "τ ± 1\n│ \u{1b}[2J\u{9b}1m\r\u{202e}x"),
            "τ ± 1\n│ \\u{1b}[2J\\u{9b}1m\\u{d}\\u{202e}x\n"
        );
        let every: String = (0..=0x10ffff_u32).filter_map(char::from_u32).collect();
        assert!(!written(Form::Text, &every).chars().any(is_obeyed));
    }

    #[test]
    fn json_reads_back_what_it_was() {
        let name = "\u{9b}2J\u{7f}\u{202e}\u{1b}\n";
        let text = written(Form::Json, &format!("{:#}", serde_json::json!({"name": name})));
        assert!(!text.chars().any(is_obeyed), "{text:?}");
        let back: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(back["name"], name);
    }
}
