//! Play of one picture through the frame pipeline, and what changes although nothing does.

use super::picture::StillPicture;
use crate::evaluate::perturbation::add_noise;
use crate::evaluate::tracking::tracking_pipeline::TrackingPipeline;
use detection::Table;
use evaluation::hypothesis_image::HypothesisImages;
use evaluation::labelled_scenes::LabelledScene;
use evaluation::scene_picture;
use evaluation::segmentation_score::{FIRST_OBJECT_LABEL, Overlaps};
use learning::{CategoryIndex, CategoryName, ViewId};
use pipeline::{FramePose, SequentialFrame, Track};
use point_cloud::{OrganizedCloud, Point};
use random::Random;
use serde::Serialize;
use service::Failure;
use std::collections::BTreeMap;

/// Number of frames after which nothing may change any more.
const N_FRAMES_SETTLED: usize = 20;

/// Number of objects that are taught before a picture is played.
const N_TAUGHT: usize = 3;

/// Time between two frames, nanoseconds.
const FRAME_NS: u64 = 33_333_333;

/// Result of a play: changes of the tracks, of their labels and of the table.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct PlayResult {
    /// Number of the first frame with a track, from 1; `None` without a track.
    pub(super) first_tracks: Option<usize>,
    /// Number of tracks after the last frame.
    pub(super) n_tracks: usize,
    /// Number of track-ids of all frames.
    pub(super) n_track_ids: usize,
    /// Number of tracks that began or ended after the frame in which all must have settled.
    pub(super) n_late_changes: usize,
    /// Number of labels that changed after that frame.
    pub(super) n_late_labels: usize,
    /// Greatest angle between two tables of successive frames, degrees.
    pub(super) table_turn_deg: f64,
    /// Greatest difference in height between two tables of successive frames, in the middle of the
    /// table, mm.
    pub(super) table_step_mm: f64,
}

impl PlayResult {
    /// True if tracks begin in time and neither they nor their labels change later.
    pub(super) fn is_still(&self) -> bool {
        let begins = self
            .first_tracks
            .is_none_or(|frame| frame <= N_FRAMES_SETTLED / 2);
        begins && self.n_late_changes == 0 && self.n_late_labels == 0
    }
}

/// Plays a picture, with its three largest objects taught before, and draws the last frame.
/// `noise_seed` seeds the Kinect noise that is drawn anew for each frame; `None` for the same bytes.
pub(super) fn play(
    picture: &StillPicture,
    n_frames: usize,
    noise_seed: Option<u64>,
) -> Result<(PlayResult, Vec<u8>), Failure> {
    let mut player = Player::new(picture, noise_seed, pipeline::category_index())?;
    for frame in 0..N_FRAMES_SETTLED {
        player.step(frame)?;
    }
    let taught = player.largest_objects()?;
    let mut player = Player::new(picture, noise_seed, taught)?;
    for frame in 0..n_frames {
        player.step(frame)?;
    }
    let drawn = player.draw()?;
    Ok((player.result, drawn))
}

struct Player<'a> {
    picture: &'a StillPicture,
    noise: Option<Random>,
    points: Vec<Point>,
    tracker: TrackingPipeline,
    /// Label of each live track.
    labels: BTreeMap<u64, Option<CategoryName>>,
    table: Option<Table>,
    result: PlayResult,
}

impl<'a> Player<'a> {
    fn new(
        picture: &'a StillPicture,
        noise_seed: Option<u64>,
        taught: CategoryIndex,
    ) -> Result<Self, Failure> {
        let mut tracker = TrackingPipeline::new().map_err(Failure::general)?;
        tracker.set_categories(taught);
        Ok(Self {
            picture,
            noise: noise_seed.map(Random::from_seed),
            points: picture.points.clone(),
            tracker,
            labels: BTreeMap::new(),
            table: None,
            result: PlayResult::default(),
        })
    }

    fn step(&mut self, frame: usize) -> Result<(), Failure> {
        if let Some(random) = &mut self.noise {
            add_noise(&self.picture.points, random, &mut self.points);
        }
        let StillPicture {
            width,
            height,
            camera,
            world_from_camera,
            up_in_camera,
            ..
        } = *self.picture;
        let cloud = OrganizedCloud::new(&self.points, width, height);
        let seen = SequentialFrame {
            pose: FramePose {
                capture_ns: (1 + frame as u64) * FRAME_NS,
                world_from_camera,
                up_in_camera,
                camera,
            },
            cloud: cloud.map_err(Failure::general)?,
            people: None,
            robot: None,
        };
        self.tracker.step(&seen).map_err(Failure::general)?;
        self.compare_tracks(frame);
        self.compare_table();
        Ok(())
    }

    fn compare_tracks(&mut self, frame: usize) {
        let result = &mut self.result;
        let tracks = self.tracker.tracks();
        let label_of = |track: &Track| (track.id, track.recognition().label.clone());
        let labels: BTreeMap<u64, Option<CategoryName>> = tracks.iter().map(label_of).collect();
        let is_new = |id: &&u64| !self.labels.contains_key(id);
        let n_begun = labels.keys().filter(is_new).count();
        let n_ended = self
            .labels
            .keys()
            .filter(|id| !labels.contains_key(id))
            .count();
        let is_other = |(id, label): &(&u64, &Option<CategoryName>)| {
            self.labels.get(id).is_some_and(|before| before != *label)
        };
        let n_other = labels.iter().filter(is_other).count();
        result.n_track_ids += n_begun;
        result.n_tracks = labels.len();
        if result.first_tracks.is_none() && !labels.is_empty() {
            result.first_tracks = Some(frame + 1);
        }
        if frame >= N_FRAMES_SETTLED {
            result.n_late_changes += n_begun + n_ended;
            result.n_late_labels += n_other;
        }
        self.labels = labels;
    }

    fn compare_table(&mut self) {
        let table = self.tracker.state().detection().table();
        if let (Some(table), Some(before)) = (table, &self.table) {
            let result = &mut self.result;
            let turn_deg = table.plane.normal.angle(&before.plane.normal).to_degrees();
            result.table_turn_deg = result.table_turn_deg.max(turn_deg);
            let step_mm = 1e3 * before.plane.height_m(&table.middle_in_camera()).abs();
            result.table_step_mm = result.table_step_mm.max(step_mm);
        }
        if let Some(table) = table {
            self.table = Some(table.clone());
        }
    }

    /// PNG picture of the last frame: colour, what the tracks see, and surfaces and candidates.
    fn draw(&self) -> Result<Vec<u8>, Failure> {
        let detection = self.tracker.state().detection();
        let mut labels = vec![0; self.points.len()];
        for (label, sighting) in (1..).zip(&self.tracker.update().sightings) {
            for &point in detection.points_of(&detection.candidates[sighting.candidate]) {
                labels[point as usize] = label * FIRST_OBJECT_LABEL;
            }
        }
        let scene = LabelledScene {
            points: self.points.clone(),
            labels,
            has_part_labels: false,
            width: self.picture.width,
            height: self.picture.height,
            up_in_camera: self.picture.up_in_camera,
        };
        let mut found = HypothesisImages::of(detection, scene.points.len()).ok_or_else(|| {
            Failure::general("detection finds more objects than 16 bits can number")
        })?;
        // Striped is what no track sees.
        let of_tracks = scene.labels.iter().zip(&found.before_psi);
        let of_tracks = of_tracks.map(|(&label, &number)| if label > 0 { number } else { 0 });
        found.after_psi = of_tracks.collect();
        let overlaps = Overlaps::count(&found.before_psi, &scene.labels);
        let surfaces = &detection.surfaces;
        scene_picture::draw(&scene, surfaces, &found, &overlaps).map_err(Failure::general)
    }

    /// Categories of the largest objects, each taught as itself.
    fn largest_objects(&self) -> Result<CategoryIndex, Failure> {
        let mut tracks: Vec<&Track> = self.tracker.tracks().iter().collect();
        tracks.sort_by_key(|track| std::cmp::Reverse(track.measured.n_points));
        let mut taught = pipeline::category_index();
        for track in tracks.into_iter().take(N_TAUGHT) {
            let name = CategoryName::new(&format!("object {}", track.id));
            let id = ViewId {
                track_id: track.id,
                view_id: 0,
            };
            if let Some(descriptor) = self.tracker.state().descriptor(track.id) {
                let taught = taught.insert(id, &name.map_err(Failure::general)?, descriptor);
                taught.map_err(Failure::general)?;
            }
        }
        Ok(taught)
    }
}
