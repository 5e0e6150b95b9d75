//! A figure's numbers as CSV.

use std::fmt::Write;

use crate::{Figure, Mark};

/// `layer,x,y[,high,note]`, one row per point, every number to the last bit. Bars give their top as y and their foot
/// as `low`; bands give `low` and `high`.
pub fn csv(figure: &Figure) -> String {
    let mut text = format!("layer,{},{},low,high,note\n", quoted(&figure.x.label), quoted(&figure.y.label));
    for layer in &figure.layers {
        let name = quoted(&layer.name);
        // Writing to a String cannot fail.
        let mut row = |x: &str, y: &str, low: &str, high: &str, note: &str| {
            let _ = writeln!(text, "{name},{x},{y},{low},{high},{}", quoted(note));
        };
        let number = |value: &f64| value.to_string();
        match &layer.mark {
            Mark::Line { x, y, .. } | Mark::Cloud { x, y } => {
                x.iter().zip(y).for_each(|(x, y)| row(&number(x), &number(y), "", "", ""));
            }
            Mark::Symbols { x, y, notes, .. } => {
                for (k, (x, y)) in x.iter().zip(y).enumerate() {
                    row(&number(x), &number(y), "", "", notes.get(k).map_or("", String::as_str));
                }
            }
            Mark::Band { x, low, high } => {
                for (x, (low, high)) in x.iter().zip(low.iter().zip(high)) {
                    row(&number(x), "", &number(low), &number(high), "");
                }
            }
            Mark::Bars { x, base, height, .. } => {
                for (x, (base, height)) in x.iter().zip(base.iter().zip(height)) {
                    row(&number(x), &number(&(base + height)), &number(base), "", "");
                }
            }
            Mark::Level { y } => row("", &number(y), "", "", ""),
        }
    }
    text
}

/// A field, in quotes where it needs them.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layer, Scale, Symbol};

    #[test]
    fn every_mark_has_its_rows() {
        let figure = Figure::new("t", Scale::of("time [s]"), Scale::of("force [N], base axes"))
            .with(Layer::line("a", 0, vec![0.1 + 0.2], vec![f64::NAN]))
            .with(Layer::symbols("f", 1, Symbol::Cross, vec![1.0], vec![2.0], vec!["say \"no\"".to_owned()]))
            .with(Layer::band("b", 0, vec![1.0], vec![2.0], vec![3.0]))
            .with(Layer::bars("c", 0, vec![1.0], vec![2.0], 0.5))
            .with(Layer::level("l", 0, 4.0));
        let expected = "layer,time [s],\"force [N], base axes\",low,high,note\na,0.30000000000000004,NaN,,,\n\
                        f,1,2,,,\"say \"\"no\"\"\"\nb,1,,2,3,\nc,1,2,0,,\nl,,4,,,\n";
        assert_eq!(csv(&figure), expected);
    }
}
