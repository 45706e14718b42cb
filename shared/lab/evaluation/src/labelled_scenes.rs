//! Scenes with ground-truth labels: labelled PCD files and simulated sequences with instance
//! masks.

mod error;
mod scene_name;

pub use error::Error;

use crate::segmentation_score::FIRST_OBJECT_LABEL;
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use dataset::scene_folder::SceneFolder;
use dataset::{RecordingKind, detect_recording_kind, pcd};
use file_access::folder_names;
use nalgebra::{Unit, Vector3};
use point_cloud::Point;
use scene_name::{ends_odd, mosd_kind};
use std::collections::BTreeSet;
use std::path::Path;

/// Label of points with depth that belong to no object, in simulated scenes.
const OTHER_LABEL: u16 = 1;

/// First mask value that is no object but the person or the arm.
const FIRST_BODY_ID: u16 = u16::MAX - 1;

/// Labelled scene in memory.
#[derive(Debug, Clone)]
pub struct LabelledScene {
    /// Points in row-major order, camera frame, metres.
    pub points: Vec<Point>,
    /// Label of each point: 0 invalid, 1 to 9 no object, from 10 on one label per object.
    pub labels: Vec<u16>,
    /// `true` when the disjoint parts of an object have labels of their own, with the same tens.
    pub has_part_labels: bool,
    /// Number of columns; the number of points for an unorganised cloud.
    pub width: usize,
    /// Number of rows; 1 for an unorganised cloud.
    pub height: usize,
    /// Up direction in the camera frame, if pose and gravity are recorded.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
}

impl LabelledScene {
    /// Label of each point, with one label for all parts of an object.
    #[must_use]
    pub fn whole_object_labels(&self) -> Vec<u16> {
        let whole = |&label: &u16| match label {
            FIRST_OBJECT_LABEL.. if self.has_part_labels => label - label % FIRST_OBJECT_LABEL,
            _ => label,
        };
        self.labels.iter().map(whole).collect()
    }
}

/// Listing of a scene before it is read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneEntry {
    /// Unique name: the file stem, prefixed by the folder's name for frames and for several
    /// folders.
    pub name: String,
    /// Group of the scene: its mOSD kind, otherwise the folder's name.
    pub group: String,
    /// Half of the data set (odd or even), from the number at the end of the name.
    pub is_odd: bool,
    recording: usize,
    index: usize,
}

#[derive(Debug)]
enum LabelledRecording {
    Scenes(SceneFolder),
    Sequence(Box<RgbdSequence>),
}

/// Labelled scenes of a folder in natural order, read on demand.
#[derive(Debug, Default)]
pub struct LabelledScenes {
    recordings: Vec<LabelledRecording>,
    entries: Vec<SceneEntry>,
    unusable: Vec<(String, Error)>,
}

impl LabelledScenes {
    /// Lists the scenes of a folder of PCD files, of a sequence, or of a folder of such folders.
    ///
    /// # Errors
    /// If there are no scenes, or two scenes have the same name.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let mut scenes = Self::default();
        match detect_recording_kind(folder) {
            Err(dataset::Error::Unknown(unknown)) => {
                for name in folder_names(folder).map_err(dataset::Error::from)? {
                    if let Err(error) = scenes.add(&folder.join(&name), &name, true) {
                        scenes.unusable.push((name, error));
                    }
                }
                if scenes.entries.is_empty() {
                    let first = scenes.unusable.into_iter().next();
                    let (_, error) = first.ok_or(dataset::Error::Unknown(unknown))?;
                    return Err(error);
                }
            }
            Err(error) => return Err(error.into()),
            Ok(_) => {
                let canonical = folder.canonicalize();
                let canonical = canonical.as_deref().unwrap_or(folder);
                let name = canonical.file_name().map(|name| name.to_string_lossy());
                scenes.add(folder, &name.unwrap_or_default(), false)?;
            }
        }
        let mut names = BTreeSet::new();
        match scenes
            .entries
            .iter()
            .find(|entry| !names.insert(&entry.name))
        {
            Some(entry) => Err(Error::SameName(entry.name.clone())),
            None => Ok(scenes),
        }
    }

    /// Scenes of the folder; at least one.
    pub fn entries(&self) -> &[SceneEntry] {
        &self.entries
    }

    /// Folders that cannot be used, with the reason.
    pub fn unusable(&self) -> &[(String, Error)] {
        &self.unusable
    }

    fn add(&mut self, folder: &Path, group: &str, is_one_of_many: bool) -> Result<(), Error> {
        let recording = match detect_recording_kind(folder)? {
            RecordingKind::PcdScenes => LabelledRecording::Scenes(SceneFolder::open(folder)?),
            RecordingKind::RgbdSequence => {
                LabelledRecording::Sequence(Box::new(RgbdSequence::open(folder)?))
            }
            kind @ (RecordingKind::Fakenect | RecordingKind::RegisteredImages) => {
                let path = folder.to_owned();
                return Err(Error::NoTruth { path, kind });
            }
        };
        let n_scenes = match &recording {
            LabelledRecording::Scenes(scenes) => scenes.len(),
            LabelledRecording::Sequence(sequence) => sequence.n_frames(),
        };
        for index in 0..n_scenes {
            let stem = match &recording {
                LabelledRecording::Scenes(scenes) => scenes.name(index).unwrap_or_default(),
                LabelledRecording::Sequence(sequence) => sequence.name(index).unwrap_or_default(),
            };
            let stem = stem.strip_suffix(".pcd").unwrap_or(stem);
            let kind = match recording {
                LabelledRecording::Scenes(_) => mosd_kind(stem),
                LabelledRecording::Sequence(_) => None,
            };
            let has_folder = is_one_of_many || matches!(recording, LabelledRecording::Sequence(_));
            self.entries.push(SceneEntry {
                name: if has_folder {
                    format!("{group}-{stem}")
                } else {
                    stem.to_owned()
                },
                group: kind.unwrap_or(group).to_owned(),
                is_odd: ends_odd(stem).unwrap_or(index % 2 == 1),
                recording: self.recordings.len(),
                index,
            });
        }
        self.recordings.push(recording);
        Ok(())
    }

    /// Reads a scene.
    ///
    /// # Errors
    /// If it cannot be read or has no ground truth.
    pub fn read(&self, entry: &SceneEntry) -> Result<LabelledScene, Error> {
        match &self.recordings[entry.recording] {
            LabelledRecording::Scenes(scenes) => read_pcd(scenes, entry.index),
            LabelledRecording::Sequence(sequence) => read_frame(sequence, entry.index),
        }
    }
}

fn read_pcd(scenes: &SceneFolder, index: usize) -> Result<LabelledScene, Error> {
    let mut bytes = Vec::new();
    scenes.read_bytes(index, &mut bytes)?;
    let cloud = pcd::read(&bytes)?;
    let labels = cloud.labels.ok_or(Error::NoLabels)?;
    let narrow = |label: u32| u16::try_from(label).map_err(|_| Error::Label(label));
    Ok(LabelledScene {
        points: cloud.points,
        labels: labels.into_iter().map(narrow).collect::<Result<_, _>>()?,
        has_part_labels: true,
        width: cloud.width,
        height: cloud.height,
        up_in_camera: None,
    })
}

fn read_frame(sequence: &RgbdSequence, index: usize) -> Result<LabelledScene, Error> {
    let camera = sequence.camera();
    let mut points = vec![Point::default(); camera.n_pixels()];
    let (mut scratch, mut mask) = (Scratch::default(), Vec::new());
    if !sequence.read_mask(index, &mut scratch, &mut mask)? {
        return Err(Error::NoMask);
    }
    let pose = sequence.fill(index, &mut scratch, &mut points)?;
    let labels = points.iter().zip(&mask);
    let labels = labels.map(|(point, &id)| label_of_id(id, point.is_finite()));
    let up_in_camera = pose
        .zip(sequence.gravity_in_world())
        .map(|(world_from_camera, down)| {
            Unit::new_normalize(world_from_camera.rotation.inverse() * -down.into_inner())
        });
    Ok(LabelledScene {
        labels: labels.collect::<Result<_, _>>()?,
        points,
        has_part_labels: false,
        width: camera.width as usize,
        height: camera.height as usize,
        up_in_camera,
    })
}

/// Label of a mask pixel: ten times the object number.
fn label_of_id(id: u16, has_depth: bool) -> Result<u16, Error> {
    if !has_depth {
        return Ok(0);
    }
    if id == 0 || id >= FIRST_BODY_ID {
        return Ok(OTHER_LABEL);
    }
    let label = id.checked_mul(FIRST_OBJECT_LABEL);
    label.ok_or(Error::Label(u32::from(id) * u32::from(FIRST_OBJECT_LABEL)))
}

#[cfg(test)]
mod tests;
