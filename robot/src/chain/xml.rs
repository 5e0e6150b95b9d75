//! Bounds of XML, before a parser sees it.

/// Largest file that is read (bytes), a hundred times that of any arm.
const LARGEST: usize = 16 << 20;
/// Deepest nesting of elements; an arm's links need thirty.
const DEEPEST: usize = 64;
/// Most attributes of an element, some thirty times those of any.
const MOST_ATTRIBUTES: usize = 1000;

/// Refuses texts that are too large, nested too deeply or have too many attributes in an element: parsers call themselves for every
/// level, and a stack that ends takes the program with it; and they compare each attribute with all before it.
pub(crate) fn within_bounds(text: &str) -> Result<(), String> {
    if text.len() > LARGEST {
        return Err(format!("{} bytes; allowed: up to {LARGEST}", text.len()));
    }
    if nesting(text) > DEEPEST {
        return Err(format!("elements are nested more than {DEEPEST} deep"));
    }
    if attributes(text) > MOST_ATTRIBUTES {
        return Err(format!("an element has more than {MOST_ATTRIBUTES} attributes"));
    }
    Ok(())
}

/// Most attributes of an element of a text; the text after the element, and what is commented out, may count too. No value holds a `<`.
fn attributes(text: &str) -> usize {
    let elements = text.split('<').filter(|element| !element.starts_with(['!', '?']));
    elements.map(|element| element.matches('=').count()).max().unwrap_or(0)
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
