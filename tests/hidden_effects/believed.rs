//! Logs of an arm that differs from its model are believed: a model that is wrong is what a diagnosis is for.

use tribo_diagnose::recognise::recognise as by_the_arm;
use tribo_experiments::hidden_effects::{CaseFilter, HiddenCase, World};
use tribo_logs::recognise::{Use, recognise};

/// What is held against the logs of some cases, whatever is hidden in them.
fn refusals(seeds: std::ops::Range<u64>, world: World) -> Vec<String> {
    let filter = CaseFilter::named("all", None).expect("all kinds");
    let of_case = |seed: u64| {
        let case = HiddenCase::draw(seed, filter.kind_of(seed), world).expect("a case that can be simulated");
        let remarks = case.logs.iter().flat_map(|log| recognise(log).into_iter().chain(by_the_arm(log, &case.nominal)));
        let told = |remark: &tribo_logs::recognise::Remark| format!("seed {seed}: {remark} ({})", case.description);
        remarks.filter(|remark| remark.refuses(Use::Diagnosis)).map(|remark| told(&remark)).collect::<Vec<String>>()
    };
    seeds.flat_map(of_case).collect()
}

#[test]
fn no_log_of_an_identified_arm_is_refused() {
    let refused = refusals(900_400..900_440, World::Identified);
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn no_log_of_an_arm_that_is_wrong_everywhere_is_refused() {
    let refused = refusals(900_440..900_480, World::WrongEverywhere);
    assert!(refused.is_empty(), "{refused:#?}");
}
