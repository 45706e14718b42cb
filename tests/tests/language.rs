//! Language rules: headlines name their concept, and a type name has one meaning.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Openings of a sentence that paraphrases a concept instead of naming it.
const RIDDLE_OPENINGS: [&str; 10] = [
    "What", "How", "Which", "Where", "Whether", "Who", "Whose", "Whom", "When", "Why",
];

/// Type names that every crate may have.
const COMMON_TYPES: [&str; 3] = ["Error", "Config", "RawConfig"];

/// Most crates that may define a type of one name.
const CRATES_PER_TYPE_MAX: usize = 2;

/// Words before the name of a type that is defined.
const TYPE_KEYWORDS: [&str; 4] = ["struct", "enum", "trait", "union"];

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Rust sources below a folder, build output aside.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap();
        if path.is_dir() && name != "target" && name != "peers" {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Every Rust source of the workspace with its text.
pub(crate) fn workspace() -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for folder in ["shared", "services", "tests"] {
        sources(&root().join(folder), &mut found);
    }
    found.sort();
    assert!(found.len() > 700, "the sources are not where they were");
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        (path, text)
    };
    found.into_iter().map(read).collect()
}

/// First lines of doc comments, with their line numbers.
fn headlines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let marker = |line: &str| {
        let line = line.trim_start();
        ["//!", "///"]
            .into_iter()
            .find(|marker| line.starts_with(marker))
    };
    let mut previous = None;
    text.lines().enumerate().filter_map(move |(number, line)| {
        let kind = marker(line);
        let is_first = kind.is_some() && kind != previous;
        previous = kind;
        let headline = line.trim_start().get(3..)?.trim_start();
        is_first.then_some((number + 1, headline))
    })
}

fn is_riddle(headline: &str) -> bool {
    let first = headline.split(|c: char| !c.is_alphabetic()).next();
    first.is_some_and(|word| RIDDLE_OPENINGS.contains(&word))
}

/// The crate of a source file: the folder above its `src`, `tests`, `benches` or `examples`.
fn crate_of(path: &Path) -> PathBuf {
    let is_crate = |folder: &&Path| folder.join("Cargo.toml").is_file();
    path.ancestors().skip(1).find(is_crate).unwrap().to_owned()
}

/// Names of the types that a line defines at the start of an item.
fn defined_type(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace().peekable();
    while words
        .peek()
        .is_some_and(|word| word.starts_with("pub") || *word == "unsafe")
    {
        words.next();
    }
    let keyword = words.next()?;
    let name = words.next()?;
    let end = name.find(|c: char| !c.is_alphanumeric() && c != '_');
    let is_type = TYPE_KEYWORDS.contains(&keyword) && name.starts_with(char::is_uppercase);
    is_type.then(|| &name[..end.unwrap_or(name.len())])
}

#[test]
fn language_headlines_name_their_concept() {
    let mut riddles = Vec::new();
    for (path, text) in workspace() {
        for (line, headline) in headlines(&text).filter(|(_, headline)| is_riddle(headline)) {
            riddles.push(format!("{}:{line}: {headline}", path.display()));
        }
    }
    assert!(
        riddles.is_empty(),
        "{} headlines paraphrase a concept; name it by the word that a reader searches for:\n{}",
        riddles.len(),
        riddles.join("\n")
    );
}

#[test]
fn language_every_module_has_a_headline() {
    let has_headline = |text: &str| {
        let first = text.lines().find(|line| !line.trim().is_empty());
        first.is_some_and(|line| line.starts_with("//! ") || line.starts_with("#!"))
    };
    let is_test = |path: &Path| path.ends_with("tests.rs");
    let without: Vec<_> = workspace()
        .into_iter()
        .filter(|(path, text)| !is_test(path) && !has_headline(text))
        .map(|(path, _)| path)
        .collect();
    assert!(without.is_empty(), "no headline: {without:#?}");
}

#[test]
fn language_a_type_name_has_one_meaning() {
    let mut crates: BTreeMap<String, BTreeSet<PathBuf>> = BTreeMap::new();
    for (path, text) in workspace() {
        for name in text.lines().filter_map(defined_type) {
            crates
                .entry(name.to_owned())
                .or_default()
                .insert(crate_of(&path));
        }
    }
    crates.retain(|name, crates| {
        crates.len() > CRATES_PER_TYPE_MAX && !COMMON_TYPES.contains(&name.as_str())
    });
    assert!(
        crates.is_empty(),
        "in more than {CRATES_PER_TYPE_MAX} crates: {crates:#?}"
    );
}

#[test]
fn language_rules_see_what_they_look_for() {
    let text =
        "//! What it is.\n\n/// Gate.\n/// How wide.\nstruct Gate;\n    /// When.\n    x: u8,\n";
    let found: Vec<_> = headlines(text).collect();
    assert_eq!(found, [(1, "What it is."), (3, "Gate."), (6, "When.")]);
    assert!(is_riddle("What it is.") && is_riddle("Who?") && !is_riddle("Whatever"));
    assert_eq!(defined_type("pub(crate) struct Gate<T> {"), Some("Gate"));
    assert_eq!(defined_type("pub enum Ternary {"), Some("Ternary"));
    assert_eq!(defined_type("let structure = 1;"), None);
}
