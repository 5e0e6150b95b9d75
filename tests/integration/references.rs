//! What the documents and the comments point at exists: sources in `docs/references.md`, files, headings.
//!
//! A source is named by its key, letters and a year (`roveda2022`), and every key is a row of the table. A path is found in the checkout as it
//! stands or below some folder of it; paths with a placeholder (`NAME`, `NN_name`) are nobody's.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Folders whose files are not ours to read.
const NOT_SOURCES: &[&str] = &["target", "campaigns"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the checkout is there")
}

/// Files below a folder, relative to the root, without hidden ones and what builds leave.
fn files(folder: &Path, root: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("sources can be read") {
        let path = entry.expect("sources can be read").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') || NOT_SOURCES.contains(&name.as_str()) {
            continue;
        }
        if path.is_dir() {
            files(&path, root, found);
        } else {
            found.push(path.strip_prefix(root).expect("a file of this folder").to_owned());
        }
    }
}

/// Documents whole, of programmes the comments: (file, line number, text).
fn prose() -> Vec<(PathBuf, usize, String)> {
    let root = root();
    let mut found = Vec::new();
    files(&root, &root, &mut found);
    let mut lines = Vec::new();
    for file in found {
        let extension = file.extension().unwrap_or_default().to_string_lossy().into_owned();
        if extension != "md" && extension != "rs" {
            continue;
        }
        let text = std::fs::read_to_string(root.join(&file)).expect("sources can be read");
        for (number, line) in text.lines().enumerate() {
            let line = if extension == "rs" { line.split_once("//").map(|(_, comment)| comment) } else { Some(line) };
            if let Some(line) = line {
                lines.push((file.clone(), number + 1, line.to_owned()));
            }
        }
    }
    lines
}

/// Letters, then a year of the last century or this one, then perhaps a letter.
fn is_key(word: &str) -> bool {
    let letters = word.chars().take_while(char::is_ascii_lowercase).count();
    let (year, rest) = word[letters..].split_at_checked(4).unwrap_or_default();
    letters >= 3
        && (year.starts_with("19") || year.starts_with("20"))
        && year.bytes().all(|digit| digit.is_ascii_digit())
        && (rest.is_empty() || (rest.len() == 1 && rest.bytes().all(|letter| letter.is_ascii_lowercase())))
}

fn keys_of(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_alphanumeric() && letter != '_').filter(|word| is_key(word))
}

/// Keys that have a row, in the order of the tables.
fn rows() -> Vec<String> {
    let table = std::fs::read_to_string(root().join("docs/references.md")).expect("the table of sources is there");
    let key = |line: &str| line.strip_prefix("| `")?.split_once('`').map(|(key, _)| key.to_owned());
    table.lines().filter_map(key).filter(|key| is_key(key)).collect()
}

#[test]
fn a_key_has_a_row_and_a_row_is_cited() {
    let rows: BTreeSet<String> = rows().into_iter().collect();
    assert!(rows.len() > 50, "the tables are read: {rows:?}");
    let mut cited = BTreeSet::new();
    let mut unknown = Vec::new();
    for (file, number, line) in prose() {
        if file.ends_with("docs/references.md") || file.ends_with("integration/references.rs") {
            continue;
        }
        for key in keys_of(&line) {
            if !rows.contains(key) {
                unknown.push(format!("{}:{number}: {key}", file.display()));
            }
            cited.insert(key.to_owned());
        }
    }
    assert!(unknown.is_empty(), "no row in docs/references.md:\n{}", unknown.join("\n"));
    let idle: Vec<&String> = rows.difference(&cited).collect();
    assert!(idle.is_empty(), "nobody cites {idle:?}");
}

#[test]
fn table_and_bibliography_hold_the_same_sources() {
    let bibliography = std::fs::read_to_string(root().join("docs/references.bib")).expect("the bibliography is there");
    let entries = bibliography.lines().filter(|line| line.starts_with('@'));
    let keys: Vec<&str> = entries.filter_map(|line| line.split_once('{')?.1.strip_suffix(',')).collect();
    assert_eq!(keys, rows());
}

/// A heading as the address that links to it use.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = kept.chars().filter(|letter| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_'));
    kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

fn has_heading(document: &Path, wanted: &str) -> bool {
    let text = std::fs::read_to_string(document).expect("sources can be read");
    text.lines().filter(|line| line.starts_with('#')).any(|line| anchor(line) == wanted)
}

#[test]
fn links_of_documents_lead_to_files_and_headings() {
    let mut broken = Vec::new();
    let (mut links, root) = (0, root());
    for (file, number, line) in prose().into_iter().filter(|(file, ..)| file.extension().is_some_and(|it| it == "md")) {
        for (place, _) in line.match_indices("](") {
            let target = line[place + 2..].split(')').next().unwrap_or_default();
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (path, heading) = target.split_once('#').unwrap_or((target, ""));
            let here = root.join(&file);
            let there = if path.is_empty() { here } else { here.parent().expect("a file lies in a folder").join(path) };
            if !there.exists() || (!heading.is_empty() && !has_heading(&there, heading)) {
                broken.push(format!("{}:{number}: {target}", file.display()));
            }
            links += 1;
        }
    }
    assert!(links > 50, "links are found: {links}");
    assert!(broken.is_empty(), "links to nothing:\n{}", broken.join("\n"));
}

/// A path that claims to be of this checkout: a document or a programme, or anything in a folder of the root.
fn claims_to_exist(word: &str, folders: &BTreeSet<String>) -> bool {
    let ours = [".md", ".rs", ".bib"].iter().any(|extension| word.ends_with(extension) && word.len() > extension.len());
    let first = word.split('/').next().unwrap_or_default();
    let in_folder = word.contains('/') && folders.contains(first) && word.contains('.');
    let placeholder = word.split(['/', '.']).any(|part| part.contains("NAME") || part.starts_with("NN"));
    (ours || in_folder) && !word.starts_with('.') && !placeholder
}

#[test]
fn paths_in_documents_and_comments_exist() {
    let root = root();
    let mut found = Vec::new();
    files(&root, &root, &mut found);
    let paths: Vec<String> = found.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    let folders: BTreeSet<String> =
        paths.iter().filter_map(|path| path.split_once('/').map(|(folder, _)| folder.to_owned())).collect();
    let exists = |word: &str| {
        let below = format!("/{word}");
        root.join(word).exists() || paths.iter().any(|path| path.ends_with(&below))
    };
    let (mut dangling, mut seen) = (Vec::new(), 0);
    for (file, number, line) in prose() {
        if file.ends_with("CHANGELOG.md") || file.ends_with("integration/references.rs") {
            continue;
        }
        let letters = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '/' | '.' | '-');
        for word in
            line.split(|letter| !letters(letter)).map(|word| word.trim_start_matches("../").trim_end_matches('.'))
        {
            if !line.contains(&format!("//{word}")) && claims_to_exist(word, &folders) {
                seen += 1;
                if !exists(word) {
                    dangling.push(format!("{}:{number}: {word}", file.display()));
                }
            }
        }
    }
    assert!(seen > 200, "paths are found: {seen}");
    assert!(dangling.is_empty(), "files that are not there:\n{}", dangling.join("\n"));
}
