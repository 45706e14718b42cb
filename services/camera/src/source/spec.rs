//! Parser of the `--source` option.

use super::unknown_source::SOURCES;
use crate::synthetic::CROWD_MAX;
use std::path::PathBuf;
use std::str::FromStr;

/// Source as named on the command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum SourceSpec {
    /// Synthetic table scene; the value is the number of its arrangement.
    Synthetic(u32),
    /// Crowd: synthetic table with this number of small blocks.
    Crowd(u32),
    /// The synthetic table with a number of small blocks that come and go.
    Parade(u32),
    /// Kinect v1 at the USB port.
    Kinect,
    /// A recording played by fakenect.
    Fakenect(PathBuf),
    /// Recording of `tabula record`.
    Recording(PathBuf),
    /// Folder of PCD scenes, an RGB-D sequence, or colour and depth images.
    Folder(PathBuf),
}

impl FromStr for SourceSpec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.split_once(':')) {
            ("", _) => Err(format!("the source is empty; the sources are {SOURCES}")),
            ("synthetic", _) => Ok(Self::Synthetic(0)),
            ("kinect", _) => Ok(Self::Kinect),
            ("simulation", _) | (_, Some(("simulation", _))) => Err(
                "the simulation is played by tabula-simulator; start both with \
                 `tabula run --source simulation`"
                    .into(),
            ),
            (_, Some(("synthetic", number))) => match number.parse() {
                Ok(arrangement) => Ok(Self::Synthetic(arrangement)),
                Err(_) => Err(format!(
                    "synthetic:{number} needs a number, for example synthetic:1"
                )),
            },
            (kind @ ("crowd" | "parade"), _) => {
                Err(format!("{kind} needs a number of blocks: {kind}:200"))
            }
            (_, Some(("crowd", number))) => n_blocks("crowd", number).map(Self::Crowd),
            (_, Some(("parade", number))) => n_blocks("parade", number).map(Self::Parade),
            (_, Some(("fakenect", ""))) | ("fakenect", _) => {
                Err("fakenect needs the folder of a recording: fakenect:FOLDER".into())
            }
            (_, Some(("fakenect", folder))) => Ok(Self::Fakenect(folder.into())),
            _ if recording::is_recording_name(text) => Ok(Self::Recording(text.into())),
            _ => Ok(Self::Folder(text.into())),
        }
    }
}

fn n_blocks(kind: &str, number: &str) -> Result<u32, String> {
    match number.parse() {
        Ok(n @ 1..=CROWD_MAX) => Ok(n),
        _ => Err(format!(
            "{kind}:{number} needs a number of blocks from 1 to {CROWD_MAX}"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_source_has_its_word() {
        let parse = str::parse::<SourceSpec>;
        assert_eq!(parse("synthetic"), Ok(SourceSpec::Synthetic(0)));
        assert_eq!(parse("synthetic:3"), Ok(SourceSpec::Synthetic(3)));
        assert_eq!(parse("crowd:200"), Ok(SourceSpec::Crowd(200)));
        assert_eq!(parse("parade:12"), Ok(SourceSpec::Parade(12)));
        assert_eq!(parse("kinect"), Ok(SourceSpec::Kinect));
        assert_eq!(
            parse("fakenect:a/b"),
            Ok(SourceSpec::Fakenect("a/b".into()))
        );
        let recording = |path: &str| Ok(SourceSpec::Recording(path.into()));
        assert_eq!(parse("a/b.mcap"), recording("a/b.mcap"));
        assert_eq!(parse("b.mcap.active"), recording("b.mcap.active"));
        assert_eq!(parse("mcap"), Ok(SourceSpec::Folder("mcap".into())));
        assert_eq!(parse("./kinect"), Ok(SourceSpec::Folder("./kinect".into())));
        for wrong in [
            "",
            "simulation",
            "simulation:bin",
            "synthetic:",
            "synthetic:-1",
            "crowd",
            "crowd:0",
            "crowd:257",
            "parade",
            "parade:0",
            "fakenect",
            "fakenect:",
        ] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
