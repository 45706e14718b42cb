//! Still pictures: the frames of recordings of any kind, without their neighbours in time.

use crate::frame_detector::up_in_camera;
use dataset::registered_images::RegisteredImages;
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use dataset::scene_folder::SceneFolder;
use dataset::{RecordingKind, detect_recording_kind, pcd};
use file_access::folder_names;
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::UnitVector3;
use point_cloud::Point;
use service::Failure;
use std::path::Path;

/// One picture in memory.
pub(super) struct StillPicture {
    pub(super) name: String,
    /// Points in row-major order, camera frame, metres.
    pub(super) points: Vec<Point>,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) camera: Option<PinholeCamera>,
    pub(super) world_from_camera: RigidTransform,
    pub(super) up_in_camera: Option<UnitVector3<f64>>,
}

enum Recording {
    Scenes(SceneFolder),
    Sequence(Box<RgbdSequence>),
    Images(Box<RegisteredImages>),
}

/// Pictures of a folder, read on demand.
pub(super) struct StillPictures {
    recordings: Vec<(String, Recording)>,
    /// Recording and number of each picture.
    pictures: Vec<(usize, usize)>,
}

impl StillPictures {
    /// Lists each `every`-th picture of a recording, or of the recordings in a folder.
    pub(super) fn open(folder: &Path, every: usize) -> Result<Self, Failure> {
        let mut recordings = Vec::new();
        match detect_recording_kind(folder) {
            Err(dataset::Error::Unknown(_)) => {
                for name in folder_names(folder).map_err(Failure::usage)? {
                    let inner = folder.join(&name);
                    let kind = detect_recording_kind(&inner);
                    let recording = kind.and_then(|kind| Recording::open(&inner, kind));
                    recordings.push((name, recording.map_err(Failure::usage)?));
                }
            }
            kind => {
                let recording = kind.and_then(|kind| Recording::open(folder, kind));
                recordings.push((String::new(), recording.map_err(Failure::usage)?));
            }
        }
        let pictures = recordings
            .iter()
            .enumerate()
            .flat_map(|(number, (_, one))| {
                let pictures = (0..one.len()).step_by(every);
                pictures.map(move |picture| (number, picture))
            });
        Ok(Self {
            pictures: pictures.collect(),
            recordings,
        })
    }

    /// Number of pictures.
    pub(super) fn len(&self) -> usize {
        self.pictures.len()
    }

    /// Reads a picture.
    pub(super) fn read(&self, number: usize) -> Result<StillPicture, Failure> {
        let (recording, picture) = self.pictures[number];
        let (folder, recording) = &self.recordings[recording];
        let mut read = recording.read(picture)?;
        if !folder.is_empty() {
            read.name = format!("{folder}/{}", read.name);
        }
        Ok(read)
    }
}

impl Recording {
    fn open(folder: &Path, kind: RecordingKind) -> Result<Self, dataset::Error> {
        match kind {
            RecordingKind::PcdScenes => SceneFolder::open(folder).map(Self::Scenes),
            RecordingKind::RgbdSequence => {
                RgbdSequence::open(folder).map(|one| Self::Sequence(Box::new(one)))
            }
            RecordingKind::RegisteredImages => {
                RegisteredImages::open(folder).map(|one| Self::Images(Box::new(one)))
            }
            RecordingKind::Fakenect => Err(dataset::Error::Unknown(folder.to_owned())),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Scenes(scenes) => scenes.len(),
            Self::Sequence(sequence) => sequence.n_frames(),
            Self::Images(images) => images.n_frames(),
        }
    }

    fn read(&self, index: usize) -> Result<StillPicture, Failure> {
        match self {
            Self::Scenes(scenes) => {
                let mut bytes = Vec::new();
                scenes
                    .read_bytes(index, &mut bytes)
                    .map_err(Failure::general)?;
                let cloud = pcd::read(&bytes).map_err(Failure::general)?;
                Ok(StillPicture {
                    name: scenes.name(index).unwrap_or_default().to_owned(),
                    points: cloud.points,
                    width: cloud.width,
                    height: cloud.height,
                    camera: None,
                    world_from_camera: RigidTransform::identity(),
                    up_in_camera: None,
                })
            }
            Self::Sequence(sequence) => {
                let name = sequence.name(index).unwrap_or_default();
                let mut picture = empty_picture(name, sequence.camera());
                let mut scratch = Scratch::default();
                let pose = sequence.fill(index, &mut scratch, &mut picture.points);
                let pose = pose.map_err(Failure::general)?;
                let up = sequence.gravity_in_world().map(|down| -down);
                picture.up_in_camera = pose.zip(up).map(|(pose, up)| up_in_camera(&pose, &up));
                picture.world_from_camera = pose.unwrap_or_default();
                Ok(picture)
            }
            Self::Images(images) => {
                let name = images.name(index).unwrap_or_default();
                let mut picture = empty_picture(name, images.camera());
                let filled = images.fill(index, &mut Scratch::default(), &mut picture.points);
                filled.map_err(Failure::general)?;
                Ok(picture)
            }
        }
    }
}

fn empty_picture(name: &str, camera: &PinholeCamera) -> StillPicture {
    StillPicture {
        name: name.to_owned(),
        points: vec![Point::default(); camera.n_pixels()],
        width: camera.width as usize,
        height: camera.height as usize,
        camera: Some(*camera),
        world_from_camera: RigidTransform::identity(),
        up_in_camera: None,
    }
}
