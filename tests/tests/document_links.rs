//! Links of the documents: files and headings exist, and the package installs what its README
//! links to.

use crate::language::root;
use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

/// Markdown documents of the repository, relative to its root.
fn documents() -> Vec<PathBuf> {
    let mut git = Command::new("git");
    git.current_dir(root())
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .arg("*.md");
    let listed = String::from_utf8(git.output().unwrap().stdout).unwrap();
    let documents: Vec<PathBuf> = listed.lines().map(PathBuf::from).collect();
    assert!(documents.len() > 60, "{documents:?}");
    documents
}

/// Lines of a document outside of code blocks.
fn prose(document: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(document)).unwrap();
    let mut is_code = false;
    let mut lines = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            lines.push(line.to_owned());
        }
    }
    lines
}

/// Targets of the links in a line, without those in code.
fn targets(line: &str) -> Vec<String> {
    let outside_code: String = line.split('`').step_by(2).collect();
    let links = outside_code.split("](").skip(1);
    links
        .filter_map(|link| Some(link.split_once(')')?.0.to_owned()))
        .filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
        .collect()
}

/// Anchors of a document's headings, as GitHub makes them.
fn anchors(document: &Path) -> HashSet<String> {
    let mut anchors = HashSet::new();
    for line in prose(document) {
        let Some((_, heading)) = line.split_once("# ").filter(|_| line.starts_with('#')) else {
            continue;
        };
        let kept = |letter: &char| letter.is_alphanumeric() || " -_".contains(*letter);
        let words: String = heading.to_lowercase().chars().filter(kept).collect();
        let anchor = words.replace(' ', "-");
        let mut repeated = (1..).map(|n| format!("{anchor}-{n}"));
        let mut free = anchor.clone();
        while anchors.contains(&free) {
            free = repeated.next().unwrap();
        }
        anchors.insert(free);
    }
    anchors
}

/// Path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                normal.pop();
            }
            Component::CurDir => {}
            other => normal.push(other),
        }
    }
    normal
}

/// Linked files of a document, relative to the root, with the anchor.
fn links(document: &Path) -> Vec<(PathBuf, Option<String>)> {
    let folder = document.parent().unwrap();
    let found = prose(document);
    found
        .iter()
        .flat_map(|line| targets(line))
        .map(|target| {
            let (file, anchor) = match target.split_once('#') {
                Some((file, anchor)) => (file, Some(anchor.to_owned())),
                None => (target.as_str(), None),
            };
            let linked = if file.is_empty() {
                document.to_owned()
            } else {
                normal(&folder.join(file))
            };
            (linked, anchor)
        })
        .collect()
}

#[test]
fn links_of_the_documents_lead_somewhere() {
    let mut broken = Vec::new();
    for document in documents() {
        for (linked, anchor) in links(&document) {
            let is_there = root().join(&linked).exists();
            let is_document = linked.extension().is_some_and(|kind| kind == "md");
            let has_anchor = anchor.as_ref().is_none_or(|anchor| {
                !is_there || !is_document || anchors(&linked).contains(anchor)
            });
            if !is_there || !has_anchor {
                broken.push(format!("{}: {linked:?} {anchor:?}", document.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// True if an asset `../../PATTERN` of the package that is installed below the folder of the
/// documentation at its own relative path covers a file.
fn installs(manifest: &str, file: &Path) -> bool {
    let folder = file.parent().unwrap().display().to_string();
    let folder = if folder.is_empty() {
        folder
    } else {
        folder + "/"
    };
    let name = file.file_name().unwrap().to_str().unwrap();
    ["", "*", "*.md", "*.svg"].iter().any(|pattern| {
        let is_covered = name.ends_with(pattern.trim_start_matches('*'));
        let pattern = if pattern.is_empty() { name } else { pattern };
        let asset = format!("[\"../../{folder}{pattern}\", \"usr/share/doc/tabula/{folder}\"");
        is_covered && manifest.contains(&asset)
    })
}

#[test]
fn links_of_the_packaged_readme_and_guides_lead_to_packaged_files() {
    let manifest = std::fs::read_to_string(root().join("services/tabula/Cargo.toml")).unwrap();
    let guides = documents();
    let guides = guides.iter().filter(|path| path.starts_with("docs/guides"));
    let readme = PathBuf::from("README.md");
    let mut missing = Vec::new();
    for document in guides.chain([&readme]) {
        assert!(installs(&manifest, document), "{}", document.display());
        for (linked, _) in links(document) {
            let is_folder = root().join(&linked).is_dir();
            let file = if is_folder {
                linked.join("x.md")
            } else {
                linked
            };
            if !installs(&manifest, &file) {
                missing.push(format!("{}: {}", document.display(), file.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// Files of the glossary, relative to the root: below `shared` but for programs, and in place of
/// `…` below the folder that the section names.
fn glossary_files() -> Vec<PathBuf> {
    let glossary = std::fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let mut section = String::new();
    let mut files = Vec::new();
    for line in glossary.lines() {
        if let Some(folder) = line.strip_prefix("`…` is `") {
            folder.trim_end_matches("`.").clone_into(&mut section);
        }
        let cells = line
            .strip_suffix("` |")
            .and_then(|row| row.rsplit_once("| `"));
        let Some((_, file)) = cells else { continue };
        let file = file.replace('…', &section);
        files.push(if file.starts_with("services/") {
            PathBuf::from(file)
        } else {
            Path::new("shared").join(file)
        });
    }
    files
}

#[test]
fn files_of_the_glossary_exist() {
    let files = glossary_files();
    assert!(files.len() > 100, "{}", files.len());
    let missing: Vec<_> = files
        .iter()
        .filter(|file| !root().join(file).is_file())
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}
