//! Tests of the WordNet reader with a small folder in its format, and with damaged files.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::*;

/// Synset of the small WordNet: words, lexicographer file, and words of the hypernyms.
const SYNSETS: [(&str, u8, &[&str]); 12] = [
    ("entity", 3, &[]),
    ("container", 6, &["entity"]),
    ("vessel", 6, &["container"]),
    ("mug quantity", 23, &[]),
    ("mug", 6, &["vessel"]),
    ("beaker goblet", 6, &["vessel"]),
    ("beer_mug stein", 6, &["mug"]),
    ("fruit", 20, &["entity"]),
    ("apple", 13, &["fruit"]),
    ("plum", 13, &["fruit"]),
    ("tin_can can", 6, &["container"]),
    ("knife", 6, &["entity"]),
];

const LICENCE: &str = "  1 This software and database is being provided to you\n";

/// Writes a folder in the format of wndb(5WN).
fn write_folder(folder: &Path) {
    let mut offsets: Vec<usize> = vec![LICENCE.len()];
    let mut data = LICENCE.to_owned();
    // All lines have the same length whatever the offsets are, so that one pass finds them.
    let line = |index: usize, offsets: &[usize]| {
        let (words, file, above) = SYNSETS[index];
        let words: Vec<_> = words.split(' ').collect();
        let mut line = format!("{:08} {file:02} n {:02x}", offsets[index], words.len());
        for word in &words {
            write!(line, " {word} 0").unwrap();
        }
        write!(line, " {:03}", above.len()).unwrap();
        for name in above {
            let holds = |(words, ..): &(&str, u8, &[&str])| words.split(' ').next() == Some(name);
            let target = SYNSETS.iter().rposition(holds).unwrap();
            let target = offsets.get(target).copied().unwrap_or(0);
            write!(line, " @ {target:08} n 0000").unwrap();
        }
        line + " | gloss\n"
    };
    for index in 0..SYNSETS.len() {
        let text = line(index, &offsets);
        offsets.push(offsets[index] + text.len());
    }
    for index in 0..SYNSETS.len() {
        data.push_str(&line(index, &offsets));
    }
    let mut entries: Vec<(String, Vec<usize>)> = Vec::new();
    for (index, (words, ..)) in SYNSETS.iter().enumerate() {
        for word in words.split(' ') {
            match entries.iter_mut().find(|(entry, _)| entry == word) {
                Some((_, senses)) => senses.push(offsets[index]),
                None => entries.push((word.to_owned(), vec![offsets[index]])),
            }
        }
    }
    entries.sort();
    let mut index = LICENCE.to_owned();
    for (word, senses) in entries {
        let n = senses.len();
        let senses: Vec<_> = senses.iter().map(|sense| format!("{sense:08}")).collect();
        writeln!(index, "{word} n {n} 2 @ ~ {n} 0 {}  ", senses.join(" ")).unwrap();
    }
    fs::write(folder.join("data.noun"), data).unwrap();
    fs::write(folder.join("index.noun"), index).unwrap();
    fs::write(
        folder.join("noun.exc"),
        "geese goose\nknives knife\nmice mouse\n",
    )
    .unwrap();
}

fn small() -> (TempDir, WordNet) {
    let folder = TempDir::new().unwrap();
    write_folder(folder.path());
    let wordnet = WordNet::open(folder.path()).unwrap();
    (folder, wordnet)
}

#[test]
fn wordnet_knows_synonyms_and_hypernyms() {
    let (_folder, wordnet) = small();
    let broader = |n_levels| Some(Kinship::Broader { n_levels });
    assert_eq!(wordnet.kinship("goblet", "beaker"), Some(Kinship::Synonym));
    assert_eq!(wordnet.kinship("vessel", "mug"), broader(1));
    assert_eq!(wordnet.kinship("container", "mug"), broader(2));
    assert_eq!(wordnet.kinship("fruit", "apple"), broader(1));
    assert_eq!(
        wordnet.kinship("stein", "mug"),
        Some(Kinship::Narrower { n_levels: 1 })
    );
    assert_eq!(wordnet.kinship("plum", "apple"), Some(Kinship::Sister));
    assert_eq!(wordnet.kinship("plum", "mug"), None);
}

#[test]
fn wordnet_finds_plurals_and_compounds() {
    let (_folder, wordnet) = small();
    assert!(wordnet.is_noun("knives") && wordnet.is_noun("mugs"));
    assert!(wordnet.is_noun("tin can") && wordnet.is_noun("tin-cans"));
    assert!(!wordnet.is_noun("flurble") && !wordnet.is_noun(""));
    // The head noun of a compound that WordNet does not know.
    assert_eq!(
        wordnet.kinship("container", "soda-can"),
        Some(Kinship::Broader { n_levels: 1 })
    );
}

#[test]
fn wordnet_prefers_senses_of_physical_objects() {
    let (_folder, wordnet) = small();
    // The quantity is the first sense of mug in the index.
    assert_eq!(wordnet.kinship("quantity", "mug"), None);
    assert!(wordnet.kinship("vessel", "mug").is_some());
}

#[test]
fn wordnet_finds_every_line_of_its_index() {
    let (_folder, wordnet) = small();
    for (words, ..) in SYNSETS {
        for word in words.split(' ') {
            assert!(wordnet.index.find(word).is_some(), "{word}");
        }
    }
    for word in ["", "a", "zzz", "mu", "mugg", "  1", "tin can"] {
        assert!(wordnet.index.find(word).is_none(), "{word}");
    }
}

#[test]
fn wordnet_damage_is_no_match() {
    let (folder, _) = small();
    for name in ["data.noun", "index.noun", "noun.exc"] {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        for step in 0..whole.len() {
            let mut bytes = whole.clone();
            if step % 2 == 0 {
                bytes.truncate(LICENCE.len() + step);
            } else {
                bytes[step] ^= 0x5a;
            }
            fs::write(&path, bytes).unwrap();
            if let Ok(wordnet) = WordNet::open(folder.path()) {
                wordnet.kinship("container", "mug");
                wordnet.kinship("knives", "beer_mug");
            }
        }
        fs::write(&path, whole).unwrap();
    }
}

#[test]
fn wordnet_missing_or_foreign_files_are_errors() {
    let folder = TempDir::new().unwrap();
    let missing = WordNet::open(folder.path()).unwrap_err();
    assert!(matches!(missing, Error::UnreadableFile { .. }));
    write_folder(folder.path());
    fs::write(folder.path().join("data.noun"), "").unwrap();
    let foreign = WordNet::open(folder.path()).unwrap_err();
    assert!(matches!(foreign, Error::ForeignFile { .. }));
    assert!(foreign.to_string().contains("reinstall"));
}

#[test]
#[ignore = "needs wordnet-base"]
fn wordnet_of_debian_relates_household_objects() {
    let wordnet = WordNet::open(Path::new("/usr/share/wordnet")).unwrap();
    for (word, name) in [
        ("fruit", "apple"),
        ("fruits", "banana"),
        ("container", "mug"),
        ("vessel", "mug"),
        ("tool", "hammer"),
        ("cutlery", "fork"),
        ("beverage", "coffee"),
        ("container", "cereal-box"),
        ("vegetable", "potato"),
        ("tableware", "plate"),
        ("containers", "tin-can"),
    ] {
        let kinship = wordnet.kinship(word, name);
        assert!(
            matches!(kinship, Some(Kinship::Broader { .. })),
            "{word} {name} {kinship:?}"
        );
    }
    assert_eq!(
        wordnet.kinship("flashlight", "torch"),
        Some(Kinship::Synonym)
    );
    assert_eq!(
        wordnet.kinship("cellphone", "cell-phone"),
        Some(Kinship::Synonym)
    );
    assert_eq!(wordnet.kinship("fruit", "hammer"), None);
    assert!(matches!(
        wordnet.kinship("stein", "mug"),
        Some(Kinship::Narrower { .. })
    ));
}
