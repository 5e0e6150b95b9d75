//! The report as one HTML file.

use tribo_figure::escape::{escape, escape_sentence};
use tribo_figure::number::significant;
use tribo_figure::page;

use super::closed_loop::ClosedLoop;
use super::section;
use super::sentence::verdict_sentence;
use crate::{Diagnosis, Verdict};

/// What a diagnosis does not know about itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReportContext {
    /// Names of the logs.
    pub logs: Vec<String>,
    /// Name of the model.
    pub model: String,
    /// Program and version: `tribo 0.1.0`.
    pub program: String,
    /// What the findings are worth in the loop, where it was simulated.
    pub closed_loop: Option<ClosedLoop>,
}

/// The whole file.
pub fn html(diagnosis: &Diagnosis, context: &ReportContext) -> String {
    let sections = [
        section::findings(diagnosis),
        section::worth(diagnosis, context.closed_loop),
        section::next_experiment(diagnosis),
        section::pattern(diagnosis),
        section::rejected(diagnosis),
        section::small_print(diagnosis),
        section::overview(diagnosis),
    ];
    page::page(
        &format!("Diagnosis: {}", verdict_name(diagnosis.verdict)),
        &(head(diagnosis, context) + &sections.concat()),
    )
}

fn head(diagnosis: &Diagnosis, context: &ReportContext) -> String {
    let mut facts = vec![
        format!("Logs: {}", context.logs.join(", ")),
        format!("model: {}", context.model),
        format!(
            "{} samples at {} Hz in {} {}, torques up to {} Hz",
            diagnosis.samples,
            significant(diagnosis.rate_hz, 3),
            diagnosis.bursts,
            if diagnosis.bursts == 1 { "burst" } else { "bursts" },
            significant(diagnosis.band_hz, 3)
        ),
        "joints and links count from 0; brackets are 95 % intervals".to_owned(),
        context.program.clone(),
    ];
    facts.retain(|fact| !fact.is_empty());
    format!(
        "<header>\n<span class=\"badge {}\">{}</span>\n<h1>{}</h1>\n<p class=\"meta\">{}</p>\n</header>\n",
        diagnosis.verdict.name(),
        verdict_name(diagnosis.verdict),
        escape_sentence(&verdict_sentence(diagnosis)),
        escape(&facts.join(" · "))
    )
}

fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NothingMissing => "nothing missing",
        Verdict::Named => "named",
        Verdict::Ambiguous => "ambiguous",
        Verdict::Unknown => "unknown",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample::{NASTY, diagnosis};

    fn context() -> ReportContext {
        ReportContext {
            logs: vec![format!("a{NASTY}.csv"), "b.csv".to_owned()],
            model: format!("m{NASTY}.yaml"),
            program: "tribo 0.1.0".to_owned(),
            closed_loop: Some(ClosedLoop { cost: [24.2, 12.1], tracking_rms_mm: [3.1, 1.2] }),
        }
    }

    #[test]
    fn everything_foreign_is_escaped() {
        let page = html(&diagnosis(), &context());
        assert!(!page.contains("<script") && !page.contains("alert('1')"));
        assert_eq!(
            page.matches("&lt;script&gt;").count(),
            7,
            "logs, model, rival, signature, validation, reason, note"
        );
    }

    #[test]
    fn the_page_stands_alone() {
        let page = html(&diagnosis(), &context());
        let address = page.replace("http://www.w3.org/2000/svg", "");
        for word in ["http:", "https:", "src=", "href=", "url(", "@import", "NaN", "inf "] {
            assert!(!address.contains(word), "{word}");
        }
        for tag in ["section", "article", "figure", "table", "svg", "details", "div", "main"] {
            let opened = page.matches(&format!("<{tag}>")).count() + page.matches(&format!("<{tag} ")).count();
            assert_eq!(opened, page.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }

    #[test]
    fn an_empty_diagnosis_has_a_page_too() {
        let mut empty = diagnosis();
        empty.verdict = Verdict::NothingMissing;
        (empty.findings, empty.joints, empty.validation) = (vec![], vec![], vec![]);
        (empty.rejected, empty.assumptions, empty.notes, empty.overview) = (vec![], vec![], vec![], vec![]);
        empty.next_experiment = None;
        empty.gain_heldout = f64::NAN;
        let page = html(&empty, &ReportContext::default());
        assert!(page.contains("Nothing is missing") && !page.contains("NaN"), "{page}");
    }
}
