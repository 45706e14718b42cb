//! Scores of one build: an evaluation of `tabula-lab` and the figures read from it.

use crate::arguments::{SweepArguments, SweepScore};
use serde_json::Value;
use service::Failure;
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

/// Values of the measured figures, in the order of [`Measurement::names`].
pub(super) type Scores = Vec<f64>;

/// Evaluation of one build: command and JSON pointers of its scores.
pub(super) struct Measurement {
    words: Vec<OsString>,
    figures: &'static [(&'static str, &'static str)],
}

impl Measurement {
    /// Evaluation that the command-line arguments select.
    ///
    /// # Errors
    /// When it needs a data set and none is named.
    pub(super) fn new(arguments: &SweepArguments) -> Result<Self, Failure> {
        let (kind, options, figures): (&str, &[&str], &'static [(&str, &str)]) =
            match arguments.score {
                SweepScore::Detection => (
                    "detection",
                    &["--repeats", "1"],
                    &[
                        ("WOv", "/overall/wov"),
                        ("F50", "/overall/f50"),
                        ("WOv after rule", "/after_psi/wov"),
                        ("F50 after rule", "/after_psi/f50"),
                    ],
                ),
                SweepScore::Tracking => (
                    "tracking",
                    &["--seeds", "1"],
                    &[("MOTA", "/mota"), ("IDF1", "/idf1")],
                ),
                SweepScore::Recognition => (
                    "cross-validation",
                    &["--folds", "5"],
                    &[("accuracy", "/accuracy_micro"), ("macro F1", "/f1_macro")],
                ),
            };
        let mut words: Vec<OsString> = vec!["--json".into(), "evaluate".into(), kind.into()];
        match &arguments.dataset {
            // Absolute, since each run has another current folder.
            Some(dataset) => words.push(
                std::path::absolute(dataset)
                    .map_err(Failure::general)?
                    .into(),
            ),
            None if arguments.score == SweepScore::Tracking => {}
            None => {
                let sentence = format!("a sweep of {kind} needs a data set: name it by --dataset");
                return Err(Failure::usage(sentence));
            }
        }
        words.extend(options.iter().map(OsString::from));
        Ok(Self { words, figures })
    }

    /// Names of the evaluation's scores.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.figures.iter().map(|(name, _)| *name)
    }

    /// Runs the evaluation with a build of `tabula-lab`.
    ///
    /// # Errors
    /// When it fails, or a figure is missing.
    pub(super) fn scores(&self, program: &Path, out: &Path) -> Result<Scores, Failure> {
        let out = std::path::absolute(out).map_err(Failure::general)?;
        let run = Command::new(program)
            .args(&self.words)
            .arg("--out")
            .arg(out)
            .output()
            .map_err(|error| {
                Failure::general(format!("{} could not run: {error}", program.display()))
            })?;
        let document: Value = serde_json::from_slice(&run.stdout).map_err(|_| {
            let errors = String::from_utf8_lossy(&run.stderr);
            let last = errors.lines().last().unwrap_or("it printed nothing");
            Failure::general(format!("the evaluation failed: {last}"))
        })?;
        let read = |path: &str| document.pointer(path).and_then(Value::as_f64);
        self.figures
            .iter()
            .map(|(name, path)| {
                read(path).ok_or_else(|| Failure::general(format!("the evaluation gave no {name}")))
            })
            .collect()
    }
}
