//! A report as one HTML file: inline style sheet and SVG, no script, no network, light or dark as the reader's system is.

use crate::Figure;
use crate::escape::escape;
use crate::svg::svg;

/// The whole file; `body` is what stands inside `<main>`.
pub fn page(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n",
        escape(title),
        include_str!("style.css"),
    )
}

/// A section with its heading; `body` is HTML.
pub fn section(heading: &str, body: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{body}</section>\n", escape(heading))
}

/// Figures with their titles, side by side where there is room.
pub fn figures<'a>(figures: impl IntoIterator<Item = &'a Figure>) -> String {
    let each = |figure: &Figure| {
        format!("<figure><figcaption>{}</figcaption>\n{}</figure>\n", escape(&figure.title), svg(figure))
    };
    let drawn: String = figures.into_iter().map(each).collect();
    if drawn.is_empty() { drawn } else { format!("<div class=\"plots\">\n{drawn}</div>\n") }
}

/// A table of text; columns in `left` are left-aligned.
pub fn table<R: IntoIterator<Item = String>>(header: &[&str], left: &[usize], rows: impl Iterator<Item = R>) -> String {
    let row = |row: R| {
        let cells =
            row.into_iter().enumerate().map(|(k, cell)| format!("<td{}>{}</td>", class(left, k), escape(&cell)));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    raw_table(header, left, &rows.map(row).collect::<String>())
}

/// A table whose `rows` are HTML.
pub fn raw_table(header: &[&str], left: &[usize], rows: &str) -> String {
    let names =
        header.iter().enumerate().map(|(k, name)| format!("<th scope=\"col\"{}>{}</th>", class(left, k), escape(name)));
    let names = names.collect::<String>();
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>\n<thead><tr>{names}</tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table></div>\n",
        escape(&format!("Table: {}", header.join(", ")))
    )
}

fn class(left: &[usize], column: usize) -> &'static str {
    if left.contains(&column) { " class=\"t\"" } else { "" }
}

#[cfg(test)]
mod tests {
    /// Relative luminance of WCAG 2.2 of `#rrggbb`.
    fn luminance(colour: &str) -> f64 {
        let channel = |from: usize| {
            let share = f64::from(u8::from_str_radix(&colour[from..from + 2], 16).unwrap()) / 255.0;
            if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    /// Text of every kind on every paper, light and dark, reaches the 4.5 : 1 of WCAG AA.
    #[test]
    fn text_has_contrast() {
        let style = include_str!("style.css");
        let themes: Vec<&str> = style.split(":root {").skip(1).map(|theme| theme.split('}').next().unwrap()).collect();
        assert_eq!(themes.len(), 2);
        for theme in themes {
            let colour = |name: &str| {
                let at = theme.find(&format!("--{name}: #")).unwrap() + name.len() + 4;
                luminance(&theme[at..at + 7])
            };
            for text in ["ink", "soft", "good", "warn", "bad"] {
                for paper in ["page", "card"] {
                    let (a, b) = (colour(text), colour(paper));
                    let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                    assert!(contrast >= 4.5, "{text} on {paper}: {contrast:.2}");
                }
            }
        }
    }
}
