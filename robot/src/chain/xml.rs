//! Bounds of XML, before a parser sees it.

/// Largest file that is read (bytes), a hundred times that of any arm.
const LARGEST: usize = 16 << 20;
/// Deepest nesting of elements; an arm's links need thirty.
const DEEPEST: usize = 64;

/// Refuses texts that are too large or nested too deeply: parsers call themselves for every level, and a stack that ends
/// takes the program with it.
pub(crate) fn within_bounds(text: &str) -> Result<(), String> {
    if text.len() > LARGEST {
        return Err(format!("{} bytes; allowed: up to {LARGEST}", text.len()));
    }
    if nesting(text) > DEEPEST {
        return Err(format!("elements are nested more than {DEEPEST} deep"));
    }
    Ok(())
}

/// How deep the elements of a text are nested at most; what is in comments or quotes may count too.
fn nesting(text: &str) -> usize {
    let (mut depth, mut deepest) = (0usize, 0);
    for (at, _) in text.match_indices('<') {
        let rest = &text[at + 1..];
        let end = rest.find('>').unwrap_or(rest.len());
        match rest.as_bytes().first() {
            Some(b'/') => depth = depth.saturating_sub(1),
            Some(b'!' | b'?') | None => {}
            Some(_) if rest[..end].ends_with('/') => {}
            Some(_) => depth += 1,
        }
        deepest = deepest.max(depth);
    }
    deepest
}
