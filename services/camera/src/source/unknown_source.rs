//! Sentence about a source that is neither a known word nor a file or folder, with the sources that
//! there are.

use service::probable_name;
use std::path::Path;

/// Words of the sources. The simulation is played by another program.
const WORDS: [&str; 6] = [
    "simulation",
    "kinect",
    "fakenect",
    "synthetic",
    "crowd",
    "parade",
];

/// Sources with their arguments, for a sentence.
pub(super) const SOURCES: &str = "simulation[:SCENE], kinect, fakenect:FOLDER, synthetic[:N], crowd:N, parade:N, a recording \
     FILE.mcap, and a folder of PCD scenes, of an RGB-D sequence, or of colour and depth images of \
     any camera";

/// Sentence about the name of a source that does not exist.
pub(super) fn sentence(name: &Path) -> String {
    let text = name.display();
    let word = name.to_str().and_then(word);
    let probable = word.and_then(|word| probable_name(word, WORDS.into_iter()));
    let what = match word {
        Some(_) => format!("there is no source `{text}`, nor a folder of this name"),
        None => format!("there is no folder {text}"),
    };
    let meant = probable.map_or_else(String::new, |word| format!("; {word} may be meant"));
    format!("{what}{meant}; the sources are {SOURCES}")
}

/// Word of a source in front of its argument; `None` for a path.
fn word(name: &str) -> Option<&str> {
    let word = name.split(':').next()?;
    (!word.is_empty() && !word.contains(['/', '.'])).then_some(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_source_is_told_with_the_sources_and_the_word_that_is_probably_meant() {
        for (name, beginning) in [
            (
                "kinct",
                "there is no source `kinct`, nor a folder of this name; kinect may be meant; ",
            ),
            (
                "simulator:pile",
                "there is no source `simulator:pile`, nor a folder of this name; simulation \
                 may be meant; ",
            ),
            (
                "kinect:1",
                "there is no source `kinect:1`, nor a folder of this name; kinect may be meant; ",
            ),
            (
                "realsense",
                "there is no source `realsense`, nor a folder of this name; the sources are ",
            ),
            ("/nowhere", "there is no folder /nowhere; the sources are "),
            ("a/kinect", "there is no folder a/kinect; the sources are "),
        ] {
            let sentence = sentence(Path::new(name));
            assert!(sentence.starts_with(beginning), "{sentence}");
            for word in WORDS {
                assert!(sentence.contains(word), "{word} is not in {sentence}");
            }
        }
    }
}
