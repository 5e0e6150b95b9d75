//! Inside a crate files point one way: no file uses another that uses it back, directly or around corners.
//!
//! The evidence are `use` declarations and `crate::` and `super::` paths of `src/`, followed through re-exports to the file that defines
//! the name; unit tests and comments do not count. A re-export alone is no use.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::architecture::rust_files;

/// A module by its path inside the crate; the root is empty.
type Module = Vec<String>;

/// The files of a crate by module, without comments and unit tests.
fn modules(source: &Path) -> BTreeMap<Module, String> {
    let mut files = Vec::new();
    rust_files(source, &mut files);
    let module = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).expect("sources can be read");
        (module_of(path.strip_prefix(source).expect("a file of this folder")), bare(&text))
    };
    files.iter().map(module).collect()
}

fn module_of(file: &Path) -> Module {
    let mut module: Module =
        file.with_extension("").components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    if module.last().is_some_and(|last| last == "mod") || module == ["lib"] || module == ["main"] {
        module.pop();
    }
    module
}

fn bare(text: &str) -> String {
    let tests = text.match_indices("#[cfg(test)]\n").find(|(place, found)| {
        text[place + found.len()..].lines().next().is_some_and(|next| next.contains("mod tests"))
    });
    let code = tests.map_or(text, |(place, _)| &text[..place]);
    code.lines().map(|line| line.split("//").next().unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

/// The paths of one `use` tree: `a::{b, c::d}` is `a::b` and `a::c::d`.
fn leaves(tree: &str, before: &[String], found: &mut Vec<Module>) {
    let (head, body) = match tree.split_once('{') {
        Some((head, body)) => (head, body.trim_end().strip_suffix('}')),
        None => (tree, None),
    };
    let name = |part: &str| part.split(" as ").next().unwrap_or(part).trim().to_owned();
    let path: Module =
        before.iter().cloned().chain(head.split("::").map(name).filter(|part| !part.is_empty())).collect();
    let Some(body) = body else {
        found.push(path);
        return;
    };
    let (mut depth, mut start) = (0, 0);
    for (place, letter) in body.char_indices().chain([(body.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !body[start..place].trim().is_empty() {
                    leaves(body[start..place].trim(), &path, found);
                }
                start = place + 1;
            }
            _ => {}
        }
    }
}

/// Paths that a file names: those it re-exports, and those it uses.
fn paths(text: &str) -> (Vec<Module>, Vec<Module>) {
    let (mut exported, mut used, mut rest) = (Vec::new(), Vec::new(), String::new());
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let trimmed = line.trim();
        let public = trimmed.starts_with("pub");
        let after =
            if public { trimmed.split_once(" use ").map(|(_, tree)| tree) } else { trimmed.strip_prefix("use ") };
        let Some(tree) = after.filter(|_| !public || trimmed.starts_with("pub use") || trimmed.starts_with("pub("))
        else {
            rest.push_str(line);
            rest.push('\n');
            continue;
        };
        let mut tree = tree.to_owned();
        while !tree.contains(';') {
            let Some(more) = lines.next() else { break };
            tree.push_str(more.trim());
        }
        let tree = tree.split(';').next().unwrap_or_default();
        leaves(tree, &[], if public { &mut exported } else { &mut used });
    }
    for start in ["crate::", "super::"] {
        for (place, _) in rest.match_indices(start) {
            let inside = rest[..place].chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':');
            if !inside {
                let path: String =
                    rest[place..].chars().take_while(|c| c.is_alphanumeric() || matches!(c, '_' | ':')).collect();
                used.push(path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect());
            }
        }
    }
    (exported, used)
}

/// A path as seen from the root of the crate; none if it leads outside.
fn absolute(from: &Module, path: &[String], modules: &BTreeMap<Module, String>) -> Option<Module> {
    let joined = |base: &[String], rest: &[String]| Some(base.iter().chain(rest).cloned().collect::<Module>());
    match path.first()?.as_str() {
        "crate" => joined(&[], &path[1..]),
        "self" => joined(from, &path[1..]),
        "super" => {
            let up = path.iter().take_while(|part| *part == "super").count();
            joined(from.get(..from.len().checked_sub(up)?)?, &path[up..])
        }
        first => {
            let child: Module = from.iter().cloned().chain([first.to_owned()]).collect();
            if modules.contains_key(&child) { joined(from, path) } else { None }
        }
    }
}

/// What every file uses of its own crate.
fn uses(modules: &BTreeMap<Module, String>) -> BTreeMap<Module, BTreeSet<Module>> {
    let mut exports: BTreeMap<Module, BTreeMap<String, Module>> = BTreeMap::new();
    let mut used = BTreeMap::new();
    for (module, text) in modules {
        let (exported, uses) = paths(text);
        for path in exported.iter().filter_map(|path| absolute(module, path, modules)) {
            if let Some(name) = path.last() {
                exports.entry(module.clone()).or_default().insert(name.clone(), path.clone());
            }
        }
        let uses: Vec<Module> = uses.iter().filter_map(|path| absolute(module, path, modules)).collect();
        used.insert(module.clone(), uses);
    }
    let defined = |path: &Module| {
        let mut path = path.clone();
        for _ in 0..8 {
            let depth = (0..=path.len()).rev().find(|depth| modules.contains_key(&path[..*depth]))?;
            let (module, rest) = path.split_at(depth);
            let next = rest.first().and_then(|name| exports.get(module)?.get(name));
            let Some(next) = next else { return Some(module.to_vec()) };
            path = next.iter().chain(&rest[1..]).cloned().collect();
        }
        None
    };
    let of = |(module, paths): (Module, Vec<Module>)| {
        let defined: BTreeSet<Module> = paths.iter().filter_map(defined).filter(|other| *other != module).collect();
        (module, defined)
    };
    used.into_iter().map(of).collect()
}

/// The groups of modules that reach each other.
fn circles(uses: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<Vec<String>> {
    let reached = |from: &Module| {
        let (mut seen, mut left) = (BTreeSet::new(), vec![from]);
        while let Some(module) = left.pop() {
            for next in uses.get(module).into_iter().flatten() {
                if seen.insert(next) {
                    left.push(next);
                }
            }
        }
        seen
    };
    let reach: BTreeMap<&Module, BTreeSet<&Module>> = uses.keys().map(|module| (module, reached(module))).collect();
    let circle = |(module, others): (&&Module, &BTreeSet<&Module>)| {
        let back = |other: &&&Module| reach.get(**other).is_some_and(|from| from.contains(*module));
        let circle: Vec<String> = others.iter().filter(back).map(|other| other.join("/")).collect();
        (circle.len() > 1).then_some(circle)
    };
    reach.iter().filter_map(circle).collect()
}

fn crates() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders =
        std::fs::read_dir(root).expect("sources can be read").map(|entry| entry.expect("sources can be read").path());
    let mut crates: Vec<PathBuf> =
        folders.filter(|folder| folder.join("Cargo.toml").is_file() && folder.join("src").is_dir()).collect();
    crates.sort();
    crates
}

#[test]
fn files_point_one_way() {
    let mut found = BTreeSet::new();
    for folder in crates() {
        let name = folder.file_name().expect("sources can be read").to_string_lossy().into_owned();
        let modules = modules(&folder.join("src"));
        found.extend(circles(&uses(&modules)).into_iter().map(|circle| (name.clone(), circle)));
    }
    assert!(found.is_empty(), "files in a circle: {found:#?}");
}

/// Two files that use each other by name through a re-export, and a third that only looks.
#[test]
fn a_circle_is_seen_through_a_re_export() {
    let crate_of = |files: &[(&str, &str)]| -> BTreeMap<Module, String> {
        files.iter().map(|(file, text)| (module_of(Path::new(file)), bare(text))).collect()
    };
    let lib = ("lib.rs", "mod a;\nmod b;\npub use a::A;\npub use b::{\n    B, C,\n};\n");
    let circle = crate_of(&[
        lib,
        ("a.rs", "use crate::{C, X};\n// use crate::nobody;\n"),
        ("b.rs", "fn b() { super::a::A }\n"),
        ("c.rs", "use crate::A;\n"),
    ]);
    assert_eq!(circles(&uses(&circle)), BTreeSet::from([vec!["a".to_owned(), "b".to_owned()]]));
    for tests in ["mod tests { use crate::A; }", "pub(super) mod tests {\n    use crate::A;\n}"] {
        let b = format!("#[cfg(test)]\n{tests}\n");
        let line = crate_of(&[lib, ("a.rs", "use crate::C;\n"), ("b.rs", &b)]);
        assert!(circles(&uses(&line)).is_empty(), "{tests}");
    }
}
