//! The report of a study.

use tribo_figure::escape::{escape, escape_sentence};
use tribo_figure::number::{probability, significant};
use tribo_figure::page::{self, figures, section, table};
use tribo_figure::{Figure, Layer, Scale};

use super::summary::quantile;
use super::{Campaigns, Study, StudySummary};
use tribo_model::file_name;

/// One HTML file: the comparison, and how the campaigns of every case went. Equal studies have equal pages.
pub fn study_page(study: &Study, summary: &StudySummary) -> String {
    let campaigns: usize = summary.rows.iter().map(|row| row.campaigns).sum();
    let title = format!(
        "{campaigns} campaigns: {} strategies, {} seeds, {} poses",
        study.strategies.len(),
        study.seeds,
        study.poses.len()
    );
    let settings = &study.settings;
    let facts = [
        format!("robot: {}", settings.robot.as_deref().unwrap_or("that of the truth")),
        format!("reference costs: mean of {} runs", study.oracle_runs),
        format!("tribo {}", env!("CARGO_PKG_VERSION")),
    ];
    let head = format!(
        "<header>\n<h1>{}</h1>\n<p class=\"meta\">{}</p>\n</header>\n",
        escape_sentence(&title),
        escape(&facts.join(" · "))
    );
    page::page(&title, &[head, comparison(summary), courses(study, summary)].concat())
}

fn comparison(summary: &StudySummary) -> String {
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| significant(value, 3));
    let rows = summary.rows.iter().map(|row| {
        let [q1, median, q3, worst] = row.best.map(number);
        let [second, second_worst] = row.second.map(number);
        [
            row.case.clone(),
            row.estimator.clone(),
            row.strategy.clone(),
            row.trials.to_string(),
            row.campaigns.to_string(),
            number(row.uncompensated),
            format!("{second} ({second_worst})"),
            format!("{median} ({q1} – {q3})"),
            worst,
            format!("{} of {}", row.within_1_1, row.campaigns),
            significant(row.aborted, 2),
            number(row.over_first),
            row.p.map_or("–".to_owned(), probability),
        ]
    });
    let header = [
        "truth",
        "estimator",
        "strategy",
        "trials",
        "campaigns",
        "no compensation",
        "2nd trial (worst)",
        "best (quartiles)",
        "worst",
        "within 1.1",
        "aborted trials",
        "over first",
        "p",
    ];
    let hint = "<p class=\"hint\">J over that of the true friction, medians over campaigns. Best: the parameters of the trial that is believed \
                best, run again on the noise of the true friction's runs. Over first: that J over the one of the first strategy in the same campaign \
                (same robot, motion and noise), median; p: two-sided signed-rank test of those pairs, Bonferroni.</p>\n";
    section("Comparison", &format!("{hint}{}", table(&header, &[0, 1, 2], rows)))
}

/// The best J so far over trials, one figure per case and estimator.
fn courses(study: &Study, summary: &StudySummary) -> String {
    let mut drawn = Vec::new();
    for (case, of_case) in study.cases.iter().enumerate() {
        for (estimator, name) in study.estimators.iter().enumerate() {
            let longest = study.strategies.iter().map(|budget| budget.trials).max().unwrap_or(1);
            let title = format!("{}, {}: best so far, median and quartiles", of_case.name(), name.as_str());
            let x = Scale::whole("trial").holding(0.0).holding(longest as f64 - 1.0);
            let mut figure = Figure::new(title, x, Scale::of("J / J with the true friction").or_logarithmic());
            let rows = summary.campaigns.iter().filter(|row| row.place[..2] == [case, estimator]);
            for (ink, row) in rows.enumerate() {
                let name = file_name(&study.strategies[row.place[2]].strategy);
                let [low, median, high] = [0.25, 0.5, 0.75].map(|p| course(row, p));
                let x: Vec<f64> = (0..median.len()).map(|trial| trial as f64).collect();
                figure.layers.push(Layer::band("", ink, x.clone(), low, high));
                figure.layers.push(Layer::line(&name, ink, x, median));
            }
            drawn.push(figure);
        }
    }
    section("Course of the campaigns", &figures(&drawn))
}

/// The quantile over campaigns of the best so far, trial by trial; a gap where it is not finite.
fn course(row: &Campaigns, p: f64) -> Vec<f64> {
    let trials = row.best.iter().map(Vec::len).min().unwrap_or(0);
    let at = |trial: usize| quantile(&row.best.iter().map(|best| best[trial]).collect::<Vec<_>>(), p);
    (0..trials).map(|trial| at(trial).unwrap_or(f64::NAN)).collect()
}
