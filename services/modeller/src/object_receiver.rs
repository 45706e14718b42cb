//! Receiver of the views of one object: its points with the camera and the pose of their frame.

use crate::handling::{Handling, TrackedPose};
use crate::obstacle::Obstacle;
use channel::{Domain, Error};
use geometry::PinholeCamera;
use message::{CategoryAnswer, SceneObject};
use nalgebra::{Isometry3, Point3, UnitVector3, Vector3};
use point_cloud::Point;
use scene_client::{SceneTopics, is_seen, is_seen_whole, table_in_world};
use service::monotonic_ns;
use std::time::{Duration, Instant};

/// Time without a scene, or without a view of the object, after which a person is told.
const ABSENCE: Duration = Duration::from_secs(3);

/// View of an object.
#[derive(Debug)]
pub(crate) struct ReceivedView {
    /// Points in the frame of the camera.
    pub(crate) points: Vec<Point>,
    pub(crate) camera: PinholeCamera,
    pub(crate) world_from_camera: Option<Isometry3<f64>>,
    /// Up direction in the frame of the camera, for a camera without a pose.
    pub(crate) up_in_camera: Option<UnitVector3<f64>>,
    /// Number of the placement of the object: it was handled between two placements.
    pub(crate) placement: u32,
    /// Direction from the object to the camera in the world; `None` when the pose is not known.
    pub(crate) direction: Option<UnitVector3<f64>>,
    /// Capture time, nanoseconds of the camera's clock.
    pub(crate) captured_ns: u64,
    /// Offset from that clock to the time since 1970, nanoseconds.
    pub(crate) wall_clock_offset_ns: i64,
}

/// Tracked object as a choice for a model.
#[derive(Debug, Clone)]
pub(crate) struct TrackedObject {
    pub(crate) track: u64,
    pub(crate) label: Option<String>,
    /// Answer about the category: certain, probable or unknown.
    pub(crate) answer: CategoryAnswer,
    /// Probability of the best category, which is the label, 0 to 1; `None` when it is not known.
    pub(crate) probability: Option<f32>,
    /// Sides of its upright box, metres.
    pub(crate) size_m: [f32; 3],
    pub(crate) is_seen: bool,
}

/// Receiver of the views of an object.
pub(crate) struct ObjectReceiver {
    topics: SceneTopics,
    handling: Handling,
    /// Normal of the table in the world, which is the camera's frame while its pose is not known.
    table_normal: Option<UnitVector3<f64>>,
    /// `true` while the object reaches beyond the image: what is missing of it there would count
    /// as a difference to the model.
    is_cut: bool,
    last_scene: Instant,
    last_view: Instant,
}

impl ObjectReceiver {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            topics: SceneTopics::join(domain)?,
            handling: Handling::default(),
            table_normal: None,
            is_cut: false,
            last_scene: Instant::now(),
            last_view: Instant::now(),
        })
    }

    /// Newest view of a track since the last call; `None` when there is no new one, while the
    /// object is handled, and while the image cuts it. All calls are for the same track.
    pub(crate) fn newest_view(&mut self, track: u64) -> Result<Option<ReceivedView>, Error> {
        self.topics.take_frames(drop)?;
        self.note_scenes(track)?;
        let mut newest = None;
        self.topics.take_clouds(|cloud| {
            if cloud.header().track_id == track {
                newest = Some(cloud);
            }
        })?;
        let newest = newest.filter(|_| !self.is_cut);
        let Some((cloud, placement)) = newest.zip(self.handling.placement()) else {
            return Ok(None);
        };
        self.last_view = Instant::now();
        let (session, sequence) = (cloud.header().session, cloud.header().sequence);
        let frame = self.topics.header(session, sequence);
        Ok(frame.and_then(|(header, n_points)| {
            let checked = header.checked(*n_points, monotonic_ns()).ok()?;
            let points = message::points(cloud.items()).to_vec();
            let pose = checked.world_from_camera;
            Some(ReceivedView {
                camera: checked.camera,
                world_from_camera: pose,
                up_in_camera: checked.up_in_camera.or(self.table_normal),
                placement,
                direction: pose.and_then(|pose| direction_to_camera(&points, &pose)),
                points,
                captured_ns: header.capture_stamp_ns,
                wall_clock_offset_ns: header.wall_clock_offset_ns,
            })
        }))
    }

    /// Reason why no views of the track come now; `None` while they come.
    pub(crate) fn obstacle(&self) -> Option<Obstacle> {
        if self.last_scene.elapsed() > ABSENCE {
            Some(Obstacle::NoScenes)
        } else if self.handling.placement().is_none() {
            Some(Obstacle::InHand)
        } else if self.is_cut {
            Some(Obstacle::CutByImage)
        } else {
            (self.last_view.elapsed() > ABSENCE).then_some(Obstacle::NotSeen)
        }
    }

    /// Follows the placements of a track, and its place in the image, by the new scenes.
    fn note_scenes(&mut self, track: u64) -> Result<(), Error> {
        self.topics.take_scenes(|scene| {
            self.last_scene = Instant::now();
            if let Some(table) = table_in_world(scene.header()) {
                self.table_normal = Some(table.normal);
            }
            let object = scene.items().iter().find(|o| o.track_id == track);
            if let Some(object) = object {
                let pose = TrackedPose::of(object, scene.header());
                self.handling.note(pose);
                self.is_cut = is_seen(object) && !is_seen_whole(object);
            }
        })
    }

    /// Objects of the newest scene, nearest to the middle of the image first; `None` without a new
    /// scene.
    pub(crate) fn objects(&mut self) -> Result<Option<Vec<TrackedObject>>, Error> {
        self.topics.take_frames(drop)?;
        let Some(scene) = self.topics.newest_scene()? else {
            return Ok(None);
        };
        let camera_from_world = scene
            .header()
            .world_from_camera
            .checked()
            .map(|pose| pose.inverse());
        let off_axis = |object: &SceneObject| {
            let centre = Point3::from(object.pose.position_m);
            camera_from_world.map_or(f64::INFINITY, |pose| {
                let centre = pose * centre;
                centre.coords.xy().norm().atan2(centre.z)
            })
        };
        let mut objects: Vec<&SceneObject> = scene.items().iter().collect();
        objects.sort_by(|a, b| off_axis(a).total_cmp(&off_axis(b)));
        let tracked = |object: &&SceneObject| TrackedObject {
            track: object.track_id,
            label: object.label().map(str::to_owned),
            answer: object.answer(),
            probability: Some(object.probability).filter(|probability| probability.is_finite()),
            size_m: object.size_m,
            is_seen: is_seen_whole(object),
        };
        Ok(Some(objects.iter().map(tracked).collect()))
    }
}

/// Direction from the middle of points to the camera, in the world; `None` without points.
fn direction_to_camera(
    points: &[Point],
    world_from_camera: &Isometry3<f64>,
) -> Option<UnitVector3<f64>> {
    let sum: Vector3<f64> = points.iter().map(|p| p.position().coords).sum();
    UnitVector3::try_new(world_from_camera.rotation * -sum, f64::MIN_POSITIVE)
}
