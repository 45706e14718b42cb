//! Simulated orbits: views of one object along a path around it.

use crate::arguments::ModelArguments;
use crate::simulate::turntable::{SegmentedView, Turntable, TurntableRoom};
use dataset::washington::CAMERA;
use geometry::PinholeCamera;
use nalgebra::{Isometry3, Point3};
use point_cloud::Point;
use random::Random;
use serde::Serialize;
use service::Failure;
use simulated_world::{CameraMount, Lighting, ModelChoice, ModelLibrary};
use std::f64::consts::TAU;

/// Elevation of the turntable's camera, degrees, and its distance, metres.
const ELEVATION_DEG: f64 = 35.0;
const DISTANCE_M: f64 = 0.85;

/// Range of a free orbit's elevation, degrees, and of its distance, metres.
const ELEVATIONS_DEG: [f64; 2] = [20.0, 65.0];
const DISTANCES_M: [f64; 2] = [0.65, 1.05];

/// Greatest distance of the point that a free camera looks at from the object, metres.
const LOOK_OFF_M: f64 = 0.05;

/// Number of views of an object that is turned by hand: every 30°.
const N_TURNED_VIEWS: usize = 12;

/// Time between two views, nanoseconds.
const VIEW_STEP_NS: u64 = 500_000_000;

coded_enum::coded_enum! {
    /// Path of the camera around the object.
    #[derive(PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub(super) enum Path {
        /// Circle at one height, as if the object were turned.
        Turntable, "turntable";
        /// Hand-guided: the height, the distance and the point that the camera looks at change, and
        /// it leads once and a sixth around.
        Free, "free orbit";
        /// Camera that stands still before an object that a person turns by unknown angles.
        Turned, "turned";
        /// The same, by a known angle.
        TurnedBy, "turned, known";
        /// That of a recorded sequence.
        Recorded, "recorded";
    }
}

impl Path {
    /// Paths of a simulated camera.
    pub(super) const ORBITS: [Self; 2] = [Self::Turntable, Self::Free];
    /// Paths of a turned object, whose views are those of the turntable.
    pub(super) const TURNED: [Self; 2] = [Self::Turned, Self::TurnedBy];
}

/// Segmented view with the true pose of its camera.
#[derive(Debug, Clone)]
pub(super) struct OrbitView {
    /// Points of the object in the frame of the camera.
    pub(super) points: Vec<Point>,
    pub(super) world_from_camera: Isometry3<f64>,
    pub(super) captured_ns: u64,
}

/// Views of one object along a path.
#[derive(Debug)]
pub(super) struct Orbit {
    pub(super) path: Path,
    pub(super) camera: PinholeCamera,
    pub(super) views: Vec<OrbitView>,
    /// Poses of all cameras, also where detection did not find the object.
    pub(super) cameras: Vec<Isometry3<f64>>,
    pub(super) world_from_object: Isometry3<f64>,
    /// Number of views of the path from one of these views to the next.
    pub(super) view_step: usize,
    /// Turn of the object from one view to the next that is known, radians; `None` when none is.
    pub(super) turn_rad: Option<f64>,
}

impl Orbit {
    /// Views of a turntable as those of a camera that stands still, before which the object is
    /// turned by hand.
    pub(super) fn turned_by_hand(&self, path: Path) -> Self {
        let n_cameras = self.cameras.len().max(1);
        let step = n_cameras.div_ceil(N_TURNED_VIEWS);
        let is_kept = |view: &&OrbitView| view.index().is_multiple_of(step);
        let kept = self.views.iter().filter(is_kept).cloned();
        Self {
            path,
            camera: self.camera,
            views: kept.collect(),
            cameras: self.cameras.iter().step_by(step).copied().collect(),
            world_from_object: self.world_from_object,
            view_step: step,
            // The camera's counter-clockwise step is the object's clockwise turn.
            turn_rad: (path == Path::TurnedBy).then(|| -TAU * step as f64 / n_cameras as f64),
        }
    }

    /// Pose of the camera of a view that the robot knows, but for its noise, and the number of the
    /// placement of the object.
    pub(super) fn known_pose(&self, view: &OrbitView) -> (Isometry3<f64>, u32) {
        match self.path {
            Path::Turned | Path::TurnedBy => {
                let placement = view.index() / self.view_step;
                (self.views[0].world_from_camera, placement as u32)
            }
            Path::Turntable | Path::Free | Path::Recorded => (view.world_from_camera, 0),
        }
    }
}

impl OrbitView {
    /// Number of the view on its path.
    fn index(&self) -> usize {
        (self.captured_ns / VIEW_STEP_NS) as usize
    }
}

/// Orbits of an object along all paths, and the turntable with its model; notes on the model are
/// dropped.
pub(super) fn simulate(
    model: &ModelChoice,
    library: &ModelLibrary,
    object: usize,
    arguments: &ModelArguments,
) -> Result<(Turntable, Vec<Orbit>), Failure> {
    let room = TurntableRoom {
        lighting: Some(Lighting::default()),
        ..TurntableRoom::default()
    };
    let seed = (arguments.seed, object as u64);
    let mut turntable =
        Turntable::new(model, library.clone(), CAMERA, room, seed).map_err(Failure::general)?;
    let mut orbits = Vec::new();
    for path in Path::ORBITS {
        let mut random = Random::substream(arguments.seed, object as u64);
        let phases: [f64; 4] = std::array::from_fn(|_| random.between(0.0, TAU));
        orbits.push(orbit(&mut turntable, path, arguments.views, &phases)?);
    }
    Ok((turntable, orbits))
}

fn orbit(
    turntable: &mut Turntable,
    path: Path,
    n_views: u32,
    phases: &[f64; 4],
) -> Result<Orbit, Failure> {
    let centre = turntable.centre();
    let world_from_object = turntable
        .object()
        .map_or_else(Isometry3::identity, |object| object.world_from_object);
    let mut orbit = Orbit {
        path,
        camera: CAMERA,
        views: Vec::new(),
        cameras: Vec::new(),
        world_from_object,
        view_step: 1,
        turn_rad: None,
    };
    for index in 0..n_views {
        let mount = mount(path, f64::from(index) / f64::from(n_views), &centre, phases);
        orbit.cameras.push(mount.world_from_camera(0.0));
        let frame = u64::from(index) + 1_000_000 * (path as u64 + 1);
        if let Some(view) = turntable
            .view_from(mount, frame)
            .map_err(Failure::general)?
        {
            orbit.views.push(orbit_view(&view, u64::from(index)));
        }
    }
    Ok(orbit)
}

/// Mount of the camera at a part of the path, 0 to 1.
fn mount(path: Path, part: f64, centre: &Point3<f64>, phases: &[f64; 4]) -> CameraMount {
    match path {
        Path::Turntable | Path::Turned | Path::TurnedBy => CameraMount {
            look_at_m: centre.coords.into(),
            distance_m: DISTANCE_M,
            elevation_deg: ELEVATION_DEG,
            azimuth_deg: 360.0 * part,
            orbit_deg_s: 0.0,
        },
        Path::Free | Path::Recorded => {
            let wave = |turns: f64, phase: f64| (TAU * turns * part + phase).sin();
            let between =
                |[low, high]: [f64; 2], wave: f64| low + 0.5 * (high - low) * (1.0 + wave);
            let off = [0, 1, 2].map(|axis| LOOK_OFF_M * wave(3.0, phases[axis]));
            CameraMount {
                look_at_m: std::array::from_fn(|axis| centre[axis] + off[axis]),
                distance_m: between(DISTANCES_M, wave(2.0, phases[3])),
                elevation_deg: between(ELEVATIONS_DEG, wave(1.5, phases[0])),
                azimuth_deg: 420.0 * part,
                orbit_deg_s: 0.0,
            }
        }
    }
}

fn orbit_view(view: &SegmentedView<'_>, index: u64) -> OrbitView {
    let point = |&index: &u32| view.cloud[index as usize];
    OrbitView {
        points: view.point_indices.iter().map(point).collect(),
        world_from_camera: view.world_from_camera,
        captured_ns: index * VIEW_STEP_NS,
    }
}
