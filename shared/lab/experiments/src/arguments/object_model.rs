//! Arguments of `evaluate model`.

use clap::{Args, ValueHint};
use simulated_world::ModelSource;
use std::path::PathBuf;

/// Arguments of `evaluate model`.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// Folder of models, or `generated`
    #[arg(long, value_name = "DIR", default_value = "generated", value_hint = ValueHint::DirPath)]
    pub(crate) models: ModelSource,
    /// Number of models, spread over the categories
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) objects: u32,
    /// In place of models: recorded RGB-D sequence with camera poses, whose objects are built
    #[arg(long, value_name = "DIR", conflicts_with = "models")]
    pub(crate) sequence: Option<PathBuf>,
    /// Views of each object along each path around it
    #[arg(long, value_name = "N", default_value_t = 36, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub(crate) views: u32,
    /// Noise of the camera poses, millimetres and degrees, such as 10:3; can be given several
    /// times [default: 5, 10, 20 and 30 mm with 1, 3, 5 and 10° each]
    #[arg(long, value_name = "MM:DEG", value_parser = pose_noise)]
    pub(crate) noise: Vec<(f64, f64)>,
    /// Random seed; the same seed gives the same figures, but for the times
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the figures, the page and the pictures [default: none are written]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Folder for the views, the poses and the true surfaces, for other programs to compare with
    /// [default: none are written]
    #[arg(long, value_name = "DIR", conflicts_with = "sequence")]
    pub(crate) export: Option<PathBuf>,
}

/// Noise of a camera pose: millimetres and degrees.
fn pose_noise(text: &str) -> Result<(f64, f64), String> {
    let number = |text: &str, most: f64| {
        let number = text.parse().ok();
        number.filter(|value| (0.0..=most).contains(value))
    };
    text.split_once(':')
        .and_then(|(mm, deg)| Some((number(mm, 1000.0)?, number(deg, 90.0)?)))
        .ok_or_else(|| "give millimetres up to 1000 and degrees up to 90, such as 10:3".to_owned())
}
