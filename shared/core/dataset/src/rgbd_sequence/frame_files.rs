//! Frames of a sequence folder, by file names.

use crate::Error;
use file_access::file_names;
use std::path::Path;

pub(super) const DEPTH_SUFFIX: &str = ".depth.png";
pub(super) const COLOR_PNG_SUFFIX: &str = ".color.png";
pub(super) const COLOR_JPG_SUFFIX: &str = ".color.jpg";
pub(super) const POSE_SUFFIX: &str = ".pose.txt";
pub(super) const MASK_SUFFIX: &str = ".mask.png";
pub(super) const TRUTH_SUFFIX: &str = ".truth.json";

/// Files of one frame: depth image, colour image and optional files.
#[derive(Debug)]
pub(super) struct FrameFiles {
    /// Common stem of the file names.
    pub(super) stem: String,
    pub(super) color_suffix: &'static str,
    pub(super) has_pose: bool,
    pub(super) has_mask: bool,
    pub(super) has_truth: bool,
}

/// True if a file name is that of a depth image of a sequence.
pub(crate) fn is_depth_name(name: &str) -> bool {
    stem(name, DEPTH_SUFFIX).is_some()
}

/// True if a file name is that of a pose of a sequence.
pub(crate) fn is_pose_name(name: &str) -> bool {
    stem(name, POSE_SUFFIX).is_some()
}

/// True if a file name is that of a frame of a sequence.
pub(super) fn is_frame_name(name: &str) -> bool {
    [
        DEPTH_SUFFIX,
        COLOR_PNG_SUFFIX,
        COLOR_JPG_SUFFIX,
        POSE_SUFFIX,
        MASK_SUFFIX,
        TRUTH_SUFFIX,
    ]
    .iter()
    .any(|suffix| stem(name, suffix).is_some())
}

/// Frames in natural order, at least one.
pub(super) fn list_frames(folder: &Path) -> Result<Vec<FrameFiles>, Error> {
    let names = FileNames(file_names(folder, is_frame_name)?);
    let mut frames = Vec::new();
    for name in &names.0 {
        if let Some(stem) = stem(name, DEPTH_SUFFIX) {
            let color_suffix = names.color_suffix(stem).ok_or_else(|| Error::Unpaired {
                path: folder.join(name),
                missing: "that ends in .color.png or .color.jpg".to_owned(),
            })?;
            frames.push(FrameFiles {
                stem: stem.to_owned(),
                color_suffix,
                has_pose: names.has(stem, POSE_SUFFIX),
                has_mask: names.has(stem, MASK_SUFFIX),
                has_truth: names.has(stem, TRUTH_SUFFIX),
            });
        }
    }
    if frames.is_empty() {
        return Err(Error::NoFrames(folder.to_owned()));
    }
    names.check_colors(folder, &frames)?;
    Ok(frames)
}

/// Stem of a file name: `frame-000123` of `frame-000123.depth.png`.
fn stem<'a>(name: &'a str, suffix: &str) -> Option<&'a str> {
    let stem = name.strip_suffix(suffix)?;
    let digits = stem.strip_prefix("frame-")?;
    let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then_some(stem)
}

/// File names of a folder in natural order.
struct FileNames(Vec<String>);

impl FileNames {
    fn has(&self, stem: &str, suffix: &str) -> bool {
        let wanted = format!("{stem}{suffix}");
        self.0
            .binary_search_by(|name| file_access::natural_order(name, &wanted))
            .is_ok()
    }

    /// Suffix of a frame's colour image; lossless PNG is preferred.
    fn color_suffix(&self, stem: &str) -> Option<&'static str> {
        [COLOR_PNG_SUFFIX, COLOR_JPG_SUFFIX]
            .into_iter()
            .find(|suffix| self.has(stem, suffix))
    }

    /// Checks that every colour image has its depth image. A PNG after the last frame is allowed:
    /// an interrupted writer leaves it.
    fn check_colors(&self, folder: &Path, frames: &[FrameFiles]) -> Result<(), Error> {
        let is_behind = |stem: &str| {
            let last = frames.last().map_or("", |frame| &frame.stem);
            file_access::natural_order(stem, last).is_gt()
        };
        for name in &self.0 {
            let png = stem(name, COLOR_PNG_SUFFIX).filter(|stem| !is_behind(stem));
            let color = png.or(stem(name, COLOR_JPG_SUFFIX));
            if color.is_some_and(|stem| !self.has(stem, DEPTH_SUFFIX)) {
                return Err(Error::Unpaired {
                    path: folder.join(name),
                    missing: format!("that ends in {DEPTH_SUFFIX}"),
                });
            }
        }
        Ok(())
    }
}
