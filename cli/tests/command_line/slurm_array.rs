//! Story: a study as a job array of a real Slurm, on a cluster of one node that lives as long as the test.
//!
//! The line of `docs/strategies.md`, `sbatch --array`, leaves what one process leaves, byte for byte. Needs Debian's slurm-wlm and munge and
//! root, which `.ci/run` sees to; elsewhere it says SKIPPED.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;
use std::process::Command;

use crate::common::{run, scratch, skipped, slurm_can_start};

const STUDY: &str = "schema: tribo.study/1
seeds: 2
cases:
- {truth: coulomb_viscous, friction: coulomb_viscous}
strategies:
- {strategy: grey_box, trials: 2}
- {strategy: zero, trials: 1}
oracle_runs: 1
settings: {sub_steps: 1}
";

/// The line of `docs/strategies.md` that sends a study to Slurm.
fn line_of_the_document() -> String {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/strategies.md")).unwrap();
    readme.lines().find(|line| line.starts_with("sbatch --array")).expect("the document shows the line").to_owned()
}

#[test]
fn a_job_array_of_slurm_leaves_what_one_process_leaves() {
    if let Err(why) = slurm_can_start() {
        return skipped(&format!("the study on Slurm: {why}"));
    }
    let at = scratch();
    std::fs::write(at.path().join("study.yaml"), STUDY).unwrap();
    run(at.path(), "study study.yaml --out at_once -q").ok();

    let line = line_of_the_document();
    let command = line.split('#').next().unwrap().trim();
    assert!(command.contains("--array=1-4") && command.contains("tribo study study.yaml"), "{line}");
    let waiting = command.replacen("sbatch", "sbatch --wait --output=task_%a.txt", 1);
    // The shell of the tasks finds the binary under the name that the document calls it by.
    let bin = at.path().join("bin");
    std::fs::create_dir(&bin).unwrap();
    std::fs::copy(env!("CARGO_BIN_EXE_tribo"), bin.join("tribo")).unwrap();
    let cluster = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/slurm/cluster.sh");
    let output = Command::new(cluster)
        .arg(at.path().join("cluster"))
        .args(["sh", "-c", &waiting])
        .env("PATH", format!("{}:{}", bin.display(), std::env::var("PATH").unwrap()))
        .current_dir(at.path())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    for task in 1..=4 {
        let text = std::fs::read_to_string(at.path().join(format!("task_{task}.txt"))).unwrap();
        assert!(text.contains(&format!("slice {task}/4")), "task {task}: {text}");
    }
    for name in ["results.json", "report.html", "study.yaml"] {
        let read = |directory: &str| std::fs::read(at.path().join(directory).join(name)).unwrap();
        assert!(read("study") == read("at_once"), "{name} differs");
    }
    assert_eq!(std::fs::read_dir(at.path().join("study/cells")).unwrap().count(), 6);
}
