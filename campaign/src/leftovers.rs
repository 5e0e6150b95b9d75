//! What a kill in the middle of an atomic write leaves behind.
//!
//! `tribo_files::write_atomic` writes to `.NAME.RANDOM.tmp` beside its target and renames. A process killed in between
//! leaves that file; nobody reads it, and whoever holds the campaign next removes it.

use std::path::Path;

use tribo_model::FileError;

/// Removes the temporary files of a campaign's own files. The caller holds the campaign, so nobody is writing them.
pub(crate) fn sweep(campaign: &Path) {
    for directory in [campaign.to_owned(), campaign.join("trials")] {
        let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
        for entry in entries.filter(|entry| entry.file_name().to_str().is_some_and(is_leftover)) {
            // One that cannot be removed harms nobody.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Name of the first entry of a directory that does not belong there; none where there is no directory.
pub(crate) fn first_stranger(
    directory: &Path,
    belongs: impl Fn(&str, &Path) -> bool,
) -> Result<Option<String>, FileError> {
    let entries = match std::fs::read_dir(directory) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        entries => entries.map_err(FileError::io(directory))?,
    };
    for entry in entries {
        let entry = entry.map_err(FileError::io(directory))?;
        let name = entry.file_name();
        if !name.to_str().is_some_and(|name| belongs(name, &entry.path())) {
            return Ok(Some(name.to_string_lossy().into_owned()));
        }
    }
    Ok(None)
}

/// `.campaign.yaml.RANDOM.tmp`, and likewise of `references.yaml`, `tuned.yaml`, `report.html` and `NNNN.parquet`.
pub(crate) fn is_leftover(name: &str) -> bool {
    let target =
        name.strip_prefix('.').and_then(|name| name.strip_suffix(".tmp")).and_then(|name| name.rsplit_once('.'));
    target.is_some_and(|(target, _)| {
        let number = target.strip_suffix(".parquet").is_some_and(|number| number.parse::<usize>().is_ok());
        number
            || matches!(target, "campaign.yaml" | "references.yaml" | "early_stop.yaml" | "tuned.yaml" | "report.html")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_own_temporary_files_go() {
        let dir = tempfile::tempdir().unwrap();
        let trials = dir.path().join("trials");
        std::fs::create_dir(&trials).unwrap();
        let ours = [dir.path().join(".tuned.yaml.a1B2c3.tmp"), trials.join(".0007.parquet.xYz123.tmp")];
        let others = [dir.path().join(".notes.tmp"), dir.path().join("tuned.yaml"), trials.join("0007.parquet")];
        for path in ours.iter().chain(&others) {
            std::fs::write(path, "x").unwrap();
        }
        sweep(dir.path());
        assert!(ours.iter().all(|path| !path.exists()) && others.iter().all(|path| path.exists()));
    }
}
