//! Scene of a query: simulated objects, their tracks, and their true colours.

use super::query_file::SceneChange;
use crate::evaluate::isolated_scene::isolated_scene;
use crate::evaluate::tracking::simulated_sequence::track;
use crate::evaluate::tracking::tracking_pipeline::TrackingPipeline;
use evaluation::scene_picture;
use geometry::PinholeCamera;
use nalgebra::Vector3;
use point_cloud::{ColorTerm, Point, Rgba};
use random::Random;
use referring_expression::{Lesson, Presence, QueryWorld, Viewpoint, WorldObject};
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary, ObjectModel, SimulatedKinect, World};

/// Number of frames after which the scene is asked about.
const N_FRAMES: u64 = 12;
/// Duration of a frame, nanoseconds.
const FRAME_NS: u64 = 33_333_333;
/// Number of objects of a scene, at least and at most.
const N_OBJECTS: [usize; 2] = [6, 9];
/// Share of objects that repeat a category of the scene. Chosen: so that words beside the name
/// are needed.
const REPEATED_SHARE: f64 = 0.45;
/// Greatest distance of a track from its object, metres.
const TRACK_DISTANCE_MAX_M: f64 = 0.06;
/// Categories of the scenes, whose English names are everyday words.
const CATEGORIES: [&str; 24] = [
    "mug",
    "bowl",
    "bottle",
    "book",
    "banana",
    "apple",
    "cereal-box",
    "tin-can",
    "toy-car",
    "candle",
    "tennis-ball",
    "kettle",
    "teapot",
    "vase",
    "jar",
    "sponge",
    "lemon",
    "orange",
    "stapler",
    "hammer",
    "milk-carton",
    "toy-duck",
    "pot",
    "plate",
];
/// The present in the scenes, nanoseconds since 1970: 2026-05-20 15:00 UTC.
const NOW_NS: i64 = 1_779_289_200_000_000_000;
/// Number of nanoseconds of a day.
const DAY_NS: i64 = 86_400_000_000_000;

/// Time since objects that are gone were last seen, nanoseconds.
const GONE_NS: i64 = 600_000_000_000;

/// Object of a scene: what is true about it.
#[derive(Debug, Clone)]
pub(super) struct TrueObject {
    /// Object number in the scene, from 1.
    pub(super) id: u16,
    /// Category, or the name that is taught in its place.
    pub(super) category: String,
    /// True if the object was taken away after it was seen.
    pub(super) is_gone: bool,
    /// Shares of the colour terms on its surface, in the order of [`ColorTerm::ALL`].
    pub(super) color_shares: [f64; ColorTerm::ALL.len()],
    /// Centre of its bounding box, world frame.
    pub(super) centre_in_world_m: Vector3<f64>,
    /// Sides of its bounding box, metres.
    pub(super) size_m: Vector3<f64>,
    /// Track of the object; `None` when it is not tracked.
    pub(super) track_id: Option<u64>,
}

impl TrueObject {
    /// Share of a colour term on the surface, 0 to 1.
    pub(super) fn share(&self, term: ColorTerm) -> f64 {
        self.color_shares[term as usize]
    }

    /// Category as people say it.
    pub(super) fn spoken(&self) -> String {
        self.category.replace('-', " ")
    }
}

/// Simulated scene with its tracks, as a query sees it.
pub(super) struct QueryScene {
    pub(super) objects: Vec<TrueObject>,
    /// Number of the object that was taught yesterday; all others were taught today.
    pub(super) taught_yesterday: u16,
    pub(super) viewpoint: Viewpoint,
    /// Colour image, PNG.
    pub(super) picture: Vec<u8>,
    tracks: Vec<WorldObject>,
    lessons: Vec<Lesson>,
    names: Vec<String>,
}

impl QueryScene {
    /// Simulates a scene, tracks its objects, and teaches each track the category of its object.
    ///
    /// # Errors
    /// When the objects find no place.
    pub(super) fn simulate(seed: u64, number: u64) -> Result<Self, Failure> {
        let world = world(seed, number)?;
        let camera = PinholeCamera::KINECT_V1;
        let mut kinect = SimulatedKinect::new(&world, camera).map_err(Failure::general)?;
        let mut points = vec![Point::default(); camera.n_pixels()];
        let mut tracker = TrackingPipeline::new().map_err(Failure::general)?;
        for frame in 0..N_FRAMES {
            kinect
                .look(&world, frame, &mut points)
                .map_err(Failure::general)?;
            let capture_ns = (frame + 1) * FRAME_NS;
            track(&mut tracker, &world, capture_ns, &points, true)?;
        }
        let mut objects: Vec<TrueObject> = world.objects().iter().map(true_object).collect();
        let tracks = tracks(&tracker, &mut objects);
        let pose = world.world_from_camera();
        let viewpoint = Viewpoint::of_camera(pose.translation.vector, &pose.rotation);
        let rgb: Vec<u8> = points.iter().flat_map(|p| p.color.rgb()).collect();
        let size = (camera.width as usize, camera.height as usize);
        let known: Vec<&TrueObject> = objects.iter().filter(|o| o.track_id.is_some()).collect();
        let lesson = |(order, object): (usize, &&TrueObject)| Lesson {
            track_id: object.track_id,
            category: object.category.clone(),
            author: "anna".to_owned(),
            wall_ns: if order == 0 {
                NOW_NS - DAY_NS
            } else {
                NOW_NS - order as i64 * 60_000_000_000
            },
        };
        Ok(Self {
            taught_yesterday: known.first().map_or(0, |object| object.id),
            lessons: known.iter().enumerate().map(lesson).collect(),
            names: CATEGORIES.iter().map(|&name| name.to_owned()).collect(),
            viewpoint: viewpoint.ok_or_else(|| Failure::general("the camera has no pose"))?,
            picture: scene_picture::encode(&rgb, size.0, size.1).map_err(Failure::general)?,
            tracks,
            objects,
        })
    }

    /// Teaches other names, and takes objects away after they were seen. As in the daemon, the
    /// colours of objects that are gone are not known.
    ///
    /// # Errors
    /// When the scene has no object of a number.
    pub(super) fn apply(&mut self, change: &SceneChange) -> Result<(), Failure> {
        let numbers = change.names_by_object.keys().chain(&change.gone);
        for id in numbers {
            if !self.objects.iter().any(|object| object.id == *id) {
                return Err(Failure::usage(format!(
                    "the scene has no object {id}; give one of 1 to {}",
                    self.objects.len()
                )));
            }
        }
        for object in &mut self.objects {
            let by_category = change.names_by_category.get(&object.category);
            if let Some(name) = change.names_by_object.get(&object.id).or(by_category) {
                object.category.clone_from(name);
            }
            object.is_gone = change.gone.contains(&object.id);
        }
        let names = change.names_by_category.values();
        self.names
            .extend(names.chain(change.names_by_object.values()).cloned());
        let objects = &self.objects;
        let of_track = |track_id: Option<u64>| {
            let mut objects = objects.iter();
            objects.find(|object| track_id.is_some() && object.track_id == track_id)
        };
        for track in &mut self.tracks {
            if let Some(object) = of_track(Some(track.track_id)) {
                track.names = vec![(object.category.clone(), 1.0)];
                if object.is_gone {
                    track.presence = Presence::Gone;
                    track.color_shares = [0.0; ColorTerm::ALL.len()];
                    track.last_seen_ns = NOW_NS - GONE_NS;
                }
            }
        }
        for lesson in &mut self.lessons {
            if let Some(object) = of_track(lesson.track_id) {
                lesson.category.clone_from(&object.category);
            }
        }
        Ok(())
    }

    /// World of a query.
    pub(super) fn world(&self) -> QueryWorld<'_> {
        QueryWorld {
            objects: &self.tracks,
            viewpoint: Some(self.viewpoint),
            lessons: &self.lessons,
            taught_names: &self.names,
            now_ns: NOW_NS,
            utc_offset_s: 0,
            speaker: Some("anna"),
        }
    }

    /// Shares of the colour terms of a track, as perception sees them.
    pub(super) fn seen_colors(&self, track_id: u64) -> Option<[f32; ColorTerm::ALL.len()]> {
        let mut tracks = self.tracks.iter();
        let track = tracks.find(|track| track.track_id == track_id);
        track.map(|track| track.color_shares)
    }

    /// Object of a track.
    pub(super) fn object_of(&self, track_id: u64) -> Option<&TrueObject> {
        let mut objects = self.objects.iter();
        objects.find(|object| object.track_id == Some(track_id))
    }
}

/// World with isolated objects, some of one category.
fn world(seed: u64, number: u64) -> Result<World, Failure> {
    let mut random = Random::substream(seed, number);
    let n_objects = N_OBJECTS[0] + random.below(N_OBJECTS[1] - N_OBJECTS[0] + 1);
    let mut choices: Vec<ModelChoice> = Vec::new();
    let mut categories: Vec<&str> = Vec::new();
    while choices.len() < n_objects {
        let is_repeated = !categories.is_empty() && random.unit() < REPEATED_SHARE;
        let category = if is_repeated {
            categories[random.below(categories.len())]
        } else {
            CATEGORIES[random.below(CATEGORIES.len())]
        };
        categories.push(category);
        choices.push(ModelChoice::Generated {
            category: category.to_owned(),
            instance: random.below(1000) as u64,
        });
    }
    let mut library = ModelLibrary::generated();
    let scene = isolated_scene(&choices, (seed, number), &mut library)?;
    World::new(scene, library).map_err(Failure::general)
}

fn true_object(object: &simulated_world::SimulatedObject) -> TrueObject {
    TrueObject {
        id: object.id,
        category: object.model.category.clone(),
        is_gone: false,
        color_shares: surface_colors(&object.model),
        centre_in_world_m: object.world_from_object.translation.vector,
        size_m: object.model.half_sides_m * 2.0,
        track_id: None,
    }
}

/// Shares of the colour terms on the surface of a model, by area. A surface whose term depends on
/// the strength of the light is left out, because people do not agree on it.
fn surface_colors(model: &ObjectModel) -> [f64; ColorTerm::ALL.len()] {
    let (mut areas, mut sum) = ([0.0; ColorTerm::ALL.len()], 0.0);
    for triangle in &model.mesh.triangles {
        let [a, b, c] = triangle
            .vertices
            .map(|index| &model.mesh.vertices[index as usize]);
        let normal = (b.position - a.position).cross(&(c.position - a.position));
        let area = f64::from(normal.norm());
        sum += area;
        if let Some(term) = clear_term(a.color) {
            areas[term as usize] += area;
        }
    }
    areas.map(|area| area / sum.max(f64::MIN_POSITIVE))
}

/// Term that a colour keeps under a quarter less and a fifth more light; `None` for one between two terms.
fn clear_term(rgb: [u8; 3]) -> Option<ColorTerm> {
    let lit = |factor: f32| {
        let [red, green, blue] = rgb.map(|channel| (f32::from(channel) * factor) as u8);
        ColorTerm::of(Rgba::opaque(red, green, blue))
    };
    let term = lit(1.0);
    [0.75, 1.2]
        .into_iter()
        .all(|factor| lit(factor) == term)
        .then_some(term)
}

/// Tracks of the scene as the objects of a query; each is assigned to the nearest object and
/// taught its category.
fn tracks(tracker: &TrackingPipeline, objects: &mut [TrueObject]) -> Vec<WorldObject> {
    let mut tracks = Vec::new();
    for track in tracker.tracks() {
        let body = track.box_in_world();
        let centre = body.frame_from_box.translation.vector;
        let distance = |object: &TrueObject| (object.centre_in_world_m - centre).norm();
        let nearest = objects
            .iter_mut()
            .filter(|object| object.track_id.is_none() && distance(object) < TRACK_DISTANCE_MAX_M)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let name = nearest.map(|object| {
            object.track_id = Some(track.id);
            object.category.clone()
        });
        tracks.push(WorldObject {
            track_id: track.id,
            is_labelled: name.is_some(),
            names: name.into_iter().map(|name| (name, 1.0)).collect(),
            color_shares: track.measured.color_shares.values(),
            centre_in_world_m: centre.into(),
            orientation_xyzw: body.frame_from_box.rotation.coords.into(),
            size_m: body.sides_m().into(),
            presence: Presence::InView,
            first_seen_ns: NOW_NS - DAY_NS,
            last_seen_ns: NOW_NS,
        });
    }
    tracks
}
