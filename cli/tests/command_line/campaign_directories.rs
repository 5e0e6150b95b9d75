//! Story: a directory belongs to one campaign or one study, and what is in it is what the journal says.
//!
//! ```text
//! two begin at once     one does; the other is refused, and no byte is its own
//! settings              what was edited, cut or emptied is refused, its field named
//! logs                  a trial's log is that trial's
//! tuned.yaml, report    follow from the journal: whoever opens a campaign after a kill makes them true again
//! ```

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{copy_directory, finished, journal_lines, run, scratch, snapshot, start, trial_log, wait_until};

/// Races per story; before there was a lock, most of them were lost.
const RACES: usize = 20;

fn refused(at: &Path, call: &str, words: &[&str]) {
    let answer = run(at, call);
    assert_eq!((answer.code, answer.stdout.as_str()), (Some(2), ""), "{call}: {answer:?}");
    for word in words {
        assert!(answer.stderr.contains(word), "{call}: `{word}` is not in {answer:?}");
    }
}

/// Refused, and no byte below `at` changes.
fn refused_untouched(at: &Path, call: &str, words: &[&str]) {
    let before = snapshot(at);
    refused(at, call, words);
    let after = snapshot(at);
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>(), "{call}");
    assert!(before == after, "{call}: something was written");
}

#[test]
fn of_two_campaigns_that_begin_at_once_one_is_refused_and_changes_nothing() {
    let at = scratch();
    let mut lost = 0;
    for race in 0..RACES {
        let seeds = [11, 12];
        let both = seeds.map(|seed| {
            start(at.path(), &format!("tune --trials 1 --strategy zero --seed {seed} --quiet --out race{race}"))
        });
        let codes = both.map(|child| crate::common::Run::from(child.wait_with_output().unwrap()));
        let won: Vec<u64> = (0..2).filter(|&k| codes[k].code == Some(0)).map(|k| seeds[k]).collect();
        let campaign = at.path().join(format!("race{race}"));
        let text = std::fs::read_to_string(campaign.join("campaign.yaml")).unwrap();
        let kept = won.len() == 1 && text.contains(&format!("seed: {}\n", won[0]));
        lost += usize::from(!kept);
        if let Some(loser) = codes.iter().find(|code| code.code != Some(0)) {
            assert_eq!(loser.code, Some(2), "{loser:?}");
        }
    }
    assert_eq!(lost, 0, "of {RACES} races");
}

#[test]
fn of_two_studies_that_begin_at_once_one_is_refused() {
    let at = scratch();
    let study = |seeds: usize| {
        format!(
            "schema: tribo.study/1\nseeds: {seeds}\ncases:\n- {{truth: coulomb_viscous, friction: coulomb_viscous}}\n\
             strategies:\n- {{strategy: zero, trials: 1}}\noracle_runs: 1\nsettings: {{sub_steps: 1}}\n"
        )
    };
    std::fs::write(at.path().join("one.yaml"), study(1)).unwrap();
    std::fs::write(at.path().join("two.yaml"), study(2)).unwrap();
    let mut lost = 0;
    for race in 0..RACES / 2 {
        let names = ["one", "two"];
        let both = names.map(|name| start(at.path(), &format!("study {name}.yaml --quiet --out race{race}")));
        let codes = both.map(|child| crate::common::Run::from(child.wait_with_output().unwrap()));
        let won: Vec<usize> = (0..2).filter(|&k| codes[k].code == Some(0)).collect();
        let text = std::fs::read_to_string(at.path().join(format!("race{race}/study.yaml"))).unwrap();
        let kept = won.len() == 1 && text.contains(&format!("seeds: {}\n", won[0] + 1));
        lost += usize::from(!kept);
    }
    assert_eq!(lost, 0, "of {} races", RACES / 2);
    run(at.path(), "study one.yaml --quiet --out mine").ok();
    refused_untouched(at.path(), "study two.yaml --out mine", &["mine: holds another study (`seeds`"]);
    refused_untouched(at.path(), "tune --trials 1 --out mine", &["mine: is not empty", "holds no campaign"]);
    run(at.path(), "tune --trials 1 --strategy zero --quiet --out c").ok();
    refused_untouched(at.path(), "study one.yaml --out c", &["c: is not empty", "holds no study"]);
}

#[test]
fn a_directory_with_something_in_it_is_left_alone() {
    let at = scratch();
    std::fs::create_dir(at.path().join("thesis")).unwrap();
    std::fs::write(at.path().join("thesis/chapter.tex"), "\\section{}").unwrap();
    for call in ["tune --trials 1 --out thesis", "ask thesis"] {
        refused_untouched(at.path(), call, &["thesis: is not empty (chapter.tex) and holds no campaign"]);
    }
    // A directory that somebody made for the campaign, and one whose campaign was killed in its first moment, are as good as none.
    std::fs::create_dir_all(at.path().join("begun/trials")).unwrap();
    std::fs::write(at.path().join("begun/journal.log"), "").unwrap();
    std::fs::write(at.path().join("begun/.campaign.yaml.Ab12Cd.tmp"), "half").unwrap();
    std::fs::create_dir(at.path().join("empty")).unwrap();
    for name in ["begun", "empty"] {
        run(at.path(), &format!("tune --trials 1 --strategy zero --quiet --out {name}")).ok();
    }
}

/// Without --out each gets a directory of its own.
#[test]
fn campaigns_that_begin_at_once_get_numbers_of_their_own() {
    let at = scratch();
    let all: Vec<_> = (0..4).map(|_| start(at.path(), "tune --trials 1 --strategy zero --quiet")).collect();
    for child in all {
        crate::common::Run::from(child.wait_with_output().unwrap()).ok();
    }
    for number in 1..=4 {
        assert_eq!(finished(&at.path().join(format!("campaigns/000{number}"))), 1);
    }
}

/// Robots that ask for the first time at the same moment begin one campaign, and each gets a trial.
#[test]
fn first_questions_at_once_begin_one_campaign() {
    let at = scratch();
    for race in 0..5 {
        let asking: Vec<_> = (0..3)
            .map(|_| start(at.path(), &format!("ask mine{race} --strategy sobol --trials 9 --json -q")))
            .collect();
        let mut numbers: Vec<u64> = asking
            .into_iter()
            .map(|child| {
                crate::common::Run::from(child.wait_with_output().unwrap()).ok().json()["trial"].as_u64().unwrap()
            })
            .collect();
        numbers.sort_unstable();
        assert_eq!(numbers, [0, 1, 2]);
    }
}

#[test]
fn changed_settings_are_refused_and_their_field_is_named() {
    let at = scratch();
    run(at.path(), "tune --trials 2 --strategy grey_box --seed 8 --quiet --out c").ok();
    let path = at.path().join("c/campaign.yaml");
    let whole = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let version = format!("tribo_version: \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(whole.contains(&version), "{whole}");
    let changes: Vec<(String, &str)> = vec![
        (String::new(), "field `schema` is missing"),
        (whole.replace("seed: 8", "seed: 9"), "field `seed` is 9; allowed: 8"),
        (whole.replace("cost: paper", "cost: robust"), "field `cost` is robust; allowed: paper"),
        (whole.replace("trials: 2", "trials: 3"), "field `trials` is 3; allowed: 2"),
        (whole.replace(&version, "tribo_version: 99.0.0"), "field `tribo_version` is 99.0.0; allowed: at most"),
        (whole.replace("seed: 8", "sead: 8"), "`sead`"),
        (lines[..lines.len() / 2].join("\n"), "field `"),
        (lines[..lines.len() - 1].join("\n"), "field `"),
        (lines[..4].join("\n"), "field `"),
    ];
    for (text, words) in &changes {
        assert!(*text != whole, "{words}: nothing was changed");
        std::fs::write(&path, text).unwrap();
        for call in ["tune --resume --trials 3 --out c", "report c", "export c --format json"] {
            refused_untouched(at.path(), call, &["c/campaign.yaml", words]);
        }
    }
    // Layout and comments are nobody's business.
    std::fs::write(&path, format!("# the arm in the corner\n{whole}\n")).unwrap();
    run(at.path(), "tune --resume --trials 3 --quiet --out c").ok();
    assert_eq!(finished(&at.path().join("c")), 3);

    // Without the journal nobody knows what the logs are of.
    std::fs::remove_file(at.path().join("c/journal.log")).unwrap();
    refused_untouched(at.path(), "tune --resume --out c", &["c: has trials and no journal.log"]);
}

/// A campaign of an earlier version, whose journal knows neither settings nor seals, goes on, and is guarded from then on.
#[test]
fn a_campaign_of_an_earlier_version_goes_on() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy grey_box --seed 8 --quiet --out c").ok();
    let path = at.path().join("c/journal.log");
    let text = std::fs::read_to_string(&path).unwrap();
    let before: String = text
        .lines()
        .filter(|line| !line.contains("log_seal") && !line.contains("\"op_code\":2"))
        .map(|line| format!("{line}\n"))
        .collect();
    assert_eq!(before.lines().count(), text.lines().count() - 3);
    std::fs::write(&path, before).unwrap();
    run(at.path(), "tune --resume --trials 2 --quiet --out c").ok();
    let settings = at.path().join("c/campaign.yaml");
    let text = std::fs::read_to_string(&settings).unwrap();
    std::fs::write(settings, text.replace("seed: 8", "seed: 9")).unwrap();
    refused(at.path(), "tune --resume --trials 3 --out c", &["field `seed` is 9; allowed: 8"]);
}

#[test]
fn a_log_of_another_trial_is_noticed() {
    let at = scratch();
    run(at.path(), "tune --trials 3 --strategy grey_box --seed 8 --quiet --out c").ok();
    let best: serde_json::Value = run(at.path(), "export c --format json").ok().json();
    let best = best["trial"].as_u64().unwrap() as usize;
    let logs: Vec<Vec<u8>> =
        (0..3).map(|number| std::fs::read(trial_log(&at.path().join("c"), number)).unwrap()).collect();
    std::fs::write(trial_log(&at.path().join("c"), 2), &logs[1]).unwrap();
    refused(
        at.path(),
        "tune --resume --trials 4 --stop-below never --quiet --out c",
        &["c/trials/0002.parquet: is not the log that trial 2 left"],
    );
    std::fs::write(trial_log(&at.path().join("c"), 2), &logs[2]).unwrap();
    std::fs::write(trial_log(&at.path().join("c"), best), &logs[(best + 1) % 3]).unwrap();
    refused(at.path(), "report c", &[&format!("c/trials/000{best}.parquet: is not the log that trial {best} left")]);
}

#[test]
fn the_number_of_trials_is_kept_through_a_kill() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy zero --quiet --out c").ok();
    let campaign = at.path().join("c");
    let mut growing = start(at.path(), "tune --resume --trials 5 --quiet --out c --threads 1");
    wait_until("a trial ends", || finished(&campaign) > 1);
    growing.kill().unwrap();
    growing.wait().unwrap();
    assert!(finished(&campaign) < 5, "killed too late to test anything");
    run(at.path(), "tune --resume --quiet --out c").ok();
    assert_eq!(finished(&campaign), 5);
    assert!(std::fs::read_to_string(campaign.join("campaign.yaml")).unwrap().contains("trials: 1\n"), "written once");
    refused(at.path(), "tune --resume --trials 0 --out c", &["field `trials` is 0; allowed: 1 to 10000"]);
}

/// Asks for trial `number`, runs it on the simulated arm and tells it.
fn ask_run_tell(at: &Path, number: usize) {
    run(at, "ask mine --out next.yaml -q --trials 4 --truth coulomb_viscous").ok();
    let simulate =
        format!("simulate mine/campaign.yaml --trial {number} --compensation next.yaml --log trial.parquet -q");
    run(at, &simulate).ok();
    run(at, "tell mine trial.parquet -q").ok();
}

/// A `tell` that was killed behind its last line in the journal left the others as they were.
#[test]
fn what_follows_from_the_journal_is_made_true_again() {
    let at = scratch();
    let mine = at.path().join("mine");
    let file = |name: &str| std::fs::read(mine.join(name)).unwrap();
    ask_run_tell(at.path(), 0);
    run(at.path(), "report mine -q").ok();
    let stale = [file("tuned.yaml"), file("report.html")];
    ask_run_tell(at.path(), 1);
    let fresh = [file("tuned.yaml"), file("report.html")];
    assert!(stale[0] != fresh[0] && stale[1] != fresh[1], "tell left them stale");
    let kill = || {
        std::fs::write(mine.join("tuned.yaml"), &stale[0]).unwrap();
        std::fs::write(mine.join("report.html"), &stale[1]).unwrap();
    };
    kill();
    let exported = run(at.path(), "export mine --format json").ok();
    assert_eq!(exported.json()["trial"], 1, "{exported:?}");
    assert!(exported.stderr.contains("mine/tuned.yaml is not what the journal says"), "{exported:?}");
    for call in ["ask mine --trial 0", "tell mine trial.parquet --trial 0", "report mine -q", "ask mine -q"] {
        kill();
        run(at.path(), call);
        assert!(file("tuned.yaml") == fresh[0], "{call} left tuned.yaml stale");
        assert!(file("report.html") == fresh[1], "{call} left the report stale");
    }
    std::fs::remove_file(mine.join("tuned.yaml")).unwrap();
    run(at.path(), "ask mine --trial 0");
    assert!(file("tuned.yaml") == fresh[0]);
}

/// Real kills, at every moment of a `tell`: whatever the journal says afterwards, the next opening makes tuned.yaml say the same.
#[test]
fn a_killed_tell_is_told_or_not_told() {
    let at = scratch();
    ask_run_tell(at.path(), 0);
    run(at.path(), "ask mine --out next.yaml -q").ok();
    run(at.path(), "simulate mine/campaign.yaml --trial 1 --compensation next.yaml --log trial.parquet -q").ok();
    let whole = std::time::Instant::now();
    copy_directory(&at.path().join("mine"), &at.path().join("whole"));
    run(at.path(), "tell whole trial.parquet -q").ok();
    let whole_s = whole.elapsed().as_secs_f64();
    let ends = |name: &str| std::fs::read(at.path().join(name).join("tuned.yaml")).unwrap();
    let (told, untold) = (ends("whole"), ends("mine"));
    assert!(told != untold);
    let mut were_told = 0;
    for kill in 0..16 {
        let name = format!("killed{kill}");
        copy_directory(&at.path().join("mine"), &at.path().join(&name));
        let mut child = start(at.path(), &format!("tell {name} trial.parquet -q"));
        std::thread::sleep(std::time::Duration::from_secs_f64(whole_s * (0.7 + 0.025 * f64::from(kill))));
        child.kill().unwrap();
        child.wait().unwrap();
        run(at.path(), &format!("ask {name} --trial 0"));
        let ended = finished(&at.path().join(&name)) == 2;
        were_told += usize::from(ended);
        assert!(ends(&name) == if ended { told.clone() } else { untold.clone() }, "kill {kill}, told: {ended}");
    }
    println!("{were_told} of 16 were told before their kill");
}

/// A full campaign, whose journal has every kind of line, is only ever appended to.
#[test]
fn the_journal_is_appended_to() {
    let at = scratch();
    ask_run_tell(at.path(), 0);
    let mut before = std::fs::read(at.path().join("mine/journal.log")).unwrap();
    for call in
        ["ask mine --trials 9", "tell mine --failed e-stop", "tell mine --withdraw 1 --reason slipped", "ask mine"]
    {
        run(at.path(), call).ok();
        let after = std::fs::read(at.path().join("mine/journal.log")).unwrap();
        assert!(after.starts_with(&before) && after.len() > before.len(), "{call}");
        before = after;
    }
    assert!(!journal_lines(&at.path().join("mine")).is_empty());
}
