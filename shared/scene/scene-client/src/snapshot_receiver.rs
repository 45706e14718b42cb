//! Receiver of snapshots: matches frames, scenes and clouds of objects.

use crate::scene_table::SceneSurface;
use crate::scene_topics::SceneTopics;
use crate::snapshot::{Snapshot, SnapshotObject};
use crate::visibility::is_seen;
use channel::topic::CameraCloud;
use channel::{Domain, Error, SharedMessage};
use geometry::RigidTransform;
use message::{FrameHeader, SceneObject, TrackState, frame_flag};
use point_cloud::Point;
use service::monotonic_ns;
use std::collections::{BTreeMap, VecDeque};

/// Number of frames that are held: one less than a subscriber may borrow.
const N_HELD_MAX: usize = 5;
/// Number of frames by which a scene is behind, from which on perception takes the newest frame
/// next and leaves out those between.
const LAG_FAR: u64 = 4;
/// Age of the points of an object up to which they stand for the present ones, frames. Points of
/// many objects come in a burst, of which some may be lost.
const CLOUD_AGE_MAX: u64 = 30;

/// Newest points of a track.
struct TrackCloud {
    session: u64,
    sequence: u64,
    points: Vec<Point>,
}

/// Newest scene, without what the plan does not need.
struct SceneOfFrame {
    session: u64,
    sequence: u64,
    /// Capture time in lockstep, nanoseconds of the source's clock.
    lockstep_ns: Option<u64>,
    surfaces: Vec<SceneSurface>,
    objects: Vec<SceneObject>,
}

/// Join of frames, scenes and the clouds of objects.
pub struct SnapshotReceiver {
    topics: SceneTopics,
    held: VecDeque<SharedMessage<CameraCloud>>,
    newest_clouds: BTreeMap<u64, TrackCloud>,
    scene: Option<SceneOfFrame>,
    has_frame: bool,
}

impl SnapshotReceiver {
    /// Receiver in a domain.
    ///
    /// # Errors
    /// When a topic has no room for another subscriber, or shared memory fails.
    pub fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            topics: SceneTopics::join(domain)?,
            held: VecDeque::new(),
            newest_clouds: BTreeMap::new(),
            scene: None,
            has_frame: false,
        })
    }

    /// True if any frame has come so far.
    pub fn has_frame(&self) -> bool {
        self.has_frame
    }

    /// Receives all messages that are queued; true if there is a new scene.
    ///
    /// # Errors
    /// When shared memory fails.
    pub fn receive(&mut self) -> Result<bool, Error> {
        self.topics.take_frames(|frame| {
            self.has_frame = true;
            // Frames of another run of the source have no scene any more.
            let session = frame.header().session;
            self.held.retain(|held| held.header().session == session);
            if self.held.len() == N_HELD_MAX {
                self.held.pop_back();
            }
            self.held.push_back(frame);
        })?;
        self.topics.take_clouds(|cloud| {
            let header = cloud.header();
            self.newest_clouds.insert(
                header.track_id,
                TrackCloud {
                    session: header.session,
                    sequence: header.sequence,
                    points: message::points(cloud.items()).to_vec(),
                },
            );
        })?;
        let Some(scene) = self.topics.newest_scene()? else {
            return Ok(false);
        };
        let header = scene.header();
        let is_lockstep = header.frame_flags & frame_flag::LOCKSTEP != 0;
        let objects = scene.items().iter().copied();
        let objects: Vec<SceneObject> = objects.filter(is_valid).collect();
        release(&mut self.held, header.session, header.sequence);
        let is_known = |track: &u64| objects.iter().any(|object| object.track_id == *track);
        self.newest_clouds.retain(|track, _| is_known(track));
        self.scene = Some(SceneOfFrame {
            session: header.session,
            sequence: header.sequence,
            lockstep_ns: is_lockstep.then_some(header.stamps.capture_ns),
            surfaces: SceneSurface::all_of(header),
            objects,
        });
        Ok(true)
    }

    /// Objects of the newest scene; `None` before the first one.
    pub fn objects(&self) -> Option<&[SceneObject]> {
        self.scene.as_ref().map(|scene| scene.objects.as_slice())
    }

    /// Capture time of the newest scene of a source in lockstep, nanoseconds of its clock; `None` for
    /// another source.
    pub fn lockstep_ns(&self) -> Option<u64> {
        self.scene.as_ref()?.lockstep_ns
    }

    /// Pose of the camera in the frame of the newest scene; `None` when it is unknown.
    pub fn world_from_camera(&self) -> Option<RigidTransform> {
        let scene = self.scene.as_ref()?;
        let (header, _) = self.topics.header(scene.session, scene.sequence)?;
        pose_of(header)
    }

    /// True if the newest scene shows objects, and the points of all of them have come.
    pub fn is_complete(&self) -> bool {
        let Some(scene) = &self.scene else {
            return false;
        };
        let mut seen = scene
            .objects
            .iter()
            .filter(|object| is_seen(object))
            .peekable();
        seen.peek().is_some() && seen.all(|object| self.cloud_of(object, scene).is_some())
    }

    /// Snapshot of the newest scene; `None` when its frame is not held any more. Objects whose
    /// points have not come have none.
    pub fn snapshot(&self) -> Option<Snapshot> {
        let scene = self.scene.as_ref()?;
        let is_its = |frame: &&SharedMessage<CameraCloud>| {
            let header = frame.header();
            (header.session, header.sequence) == (scene.session, scene.sequence)
        };
        let frame = self.held.iter().find(is_its)?;
        let header = frame.header();
        let checked = header.checked(frame.items().len(), monotonic_ns()).ok()?;
        let object = |object: &SceneObject| SnapshotObject {
            track: object.track_id,
            label: object.label().map(str::to_owned),
            categories: object
                .categories()
                .map(|(name, _, probability)| (name.to_owned(), probability.into()))
                .collect(),
            state: TrackState::from_code(object.state).unwrap_or(TrackState::Missing),
            middle_in_world: object.pose.position_m.into(),
            points: self.points_of(object, scene, checked.world_from_camera),
        };
        Some(Snapshot {
            points: message::points(frame.items()).to_vec(),
            camera: checked.camera,
            world_from_camera: checked.world_from_camera,
            up_in_camera: checked.up_in_camera,
            surfaces: scene.surfaces.clone(),
            objects: scene.objects.iter().map(object).collect(),
            session: header.session,
            sequence: header.sequence,
            capture_ns: header.capture_stamp_ns,
            source_name: header.source_name.as_str().unwrap_or_default().to_owned(),
        })
    }

    /// Points of a seen object in the present camera frame, of this frame or of one shortly before.
    fn points_of(
        &self,
        object: &SceneObject,
        scene: &SceneOfFrame,
        world_from_camera: Option<RigidTransform>,
    ) -> Vec<[f32; 3]> {
        let Some(cloud) = self.cloud_of(object, scene).filter(|_| is_seen(object)) else {
            return Vec::new();
        };
        let Some((header, _)) = self.topics.header(cloud.session, cloud.sequence) else {
            return Vec::new();
        };
        let now_from_then = match (world_from_camera, pose_of(header)) {
            (Some(now), Some(then)) => now.inverse() * then,
            (None, None) => RigidTransform::identity(),
            _ => return Vec::new(),
        };
        let points = cloud.points.iter().filter(|point| point.is_finite());
        points
            .map(|point| (now_from_then * point.position()).cast::<f32>().into())
            .collect()
    }

    /// Points of an object of this frame or of one shortly before.
    fn cloud_of(&self, object: &SceneObject, scene: &SceneOfFrame) -> Option<&TrackCloud> {
        let cloud = self.newest_clouds.get(&object.track_id)?;
        let age = scene.sequence.abs_diff(cloud.sequence);
        (cloud.session == scene.session && age <= CLOUD_AGE_MAX).then_some(cloud)
    }
}

/// Pose of the camera in a frame; `None` when it is unknown.
fn pose_of(header: &FrameHeader) -> Option<RigidTransform> {
    let is_known = header.has(frame_flag::HAS_WORLD_POSE);
    header.world_from_camera.checked().filter(|_| is_known)
}

/// Releases the frames of which no scene will come any more, now that the scene of a frame has.
fn release(held: &mut VecDeque<SharedMessage<CameraCloud>>, session: u64, sequence: u64) {
    let newest = held.back().map_or(0, |frame| frame.header().sequence);
    let is_far = newest.saturating_sub(sequence) >= LAG_FAR;
    held.retain(|frame| {
        let header = frame.header();
        let is_later = header.sequence > sequence && (!is_far || header.sequence == newest);
        header.session != session || header.sequence == sequence || is_later
    });
}

/// True for an object with a known state and a place.
fn is_valid(object: &SceneObject) -> bool {
    let has_place = object.pose.position_m.iter().all(|c| c.is_finite());
    has_place && TrackState::from_code(object.state).is_some()
}
