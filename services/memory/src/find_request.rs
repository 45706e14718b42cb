//! Queries in words: "the red mug left of the box" over the live objects, the lessons, and the
//! objects that are gone.

use crate::working_memory::{WorkingMemory, now_ns};
use control_protocol::{
    FindQuery, FindReport, FoundObjectReport, Refusal, RefusalKind, WordUseReport,
};
use geometry::RigidTransform;
use message::{TrackState, WirePose};
use nalgebra::{UnitQuaternion, Vector3};
use parking_lot::Mutex;
use referring_expression::{
    Answer, ColorTerm, Lesson, Lexicon, Match, Presence, QueryWorld, Viewpoint, WordNet,
    WorldObject, find,
};
use scene_document::{CategoryAnswer, CategoryDocument, ObjectDocument, SceneDocument};
use std::cmp::Reverse;
use std::path::Path;
use std::sync::Arc;
use working_memory::{EventKind, LessonKind, ObjectRecord, WorldModel};

/// Folder of the Debian package `wordnet-base`.
const WORDNET: &str = "/usr/share/wordnet";

/// Greatest number of lessons that a query knows, newest first. Chosen.
const N_LESSONS_MAX: usize = 2000;

/// Greatest number of gone objects that a query knows: those with a label before those without,
/// and the ones that were seen last first. Chosen.
const N_GONE_MAX: usize = 2000;

/// State of an object that is not on the table any more.
const GONE: &str = "gone";

/// WordNet, which is opened at the first query that finds it installed.
#[derive(Default)]
pub(crate) struct Synonyms(Mutex<Option<Arc<WordNet>>>);

impl Synonyms {
    fn get(&self) -> Option<Arc<WordNet>> {
        let mut opened = self.0.lock();
        if opened.is_none() && Path::new(WORDNET).is_dir() {
            match WordNet::open(Path::new(WORDNET)) {
                Ok(wordnet) => *opened = Some(Arc::new(wordnet)),
                Err(error) => tracing::warn!("synonyms are off: {error}"),
            }
        }
        opened.clone()
    }
}

/// Everything that a query is about.
pub(crate) struct KnownWorld {
    scene: SceneDocument,
    /// Objects of the scene, then those that are gone.
    objects: Vec<WorldObject>,
    /// Rotation of the world that points its up direction along z.
    upright: UnitQuaternion<f64>,
    viewpoint: Option<Viewpoint>,
    lessons: Vec<Lesson>,
    taught_names: Vec<String>,
}

impl KnownWorld {
    /// World of the newest scene, the categories and the working memory.
    pub(crate) fn new(
        scene: SceneDocument,
        categories: Vec<CategoryDocument>,
        memory: &WorkingMemory,
    ) -> Self {
        let upright = upright_from_world(&scene);
        let (lessons, gone) = memory.with(|model| {
            let lessons = lessons(model);
            let gone = gone(model, &upright, &lessons);
            (lessons, gone)
        });
        let now_ns = now_ns() as i64;
        let live = |object: &ObjectDocument| live_object(object, &upright, &lessons, now_ns);
        let mut objects: Vec<WorldObject> = scene.objects.iter().map(live).collect();
        let is_live = |object: &WorldObject| {
            let mut live = scene.objects.iter();
            live.any(|one| one.track_id == object.track_id)
        };
        objects.extend(gone.into_iter().filter(|object| !is_live(object)));
        Self {
            objects,
            viewpoint: viewpoint(&scene, &upright),
            upright,
            taught_names: categories.into_iter().map(|one| one.category).collect(),
            scene,
            lessons,
        }
    }

    /// Answer to a query; objects that are gone are looked at when no live one fits.
    ///
    /// # Errors
    /// A refusal of a query without words, or one that is too long.
    pub(crate) fn answer(
        &self,
        query: &FindQuery,
        synonyms: &Synonyms,
    ) -> Result<FindReport, Refusal> {
        let wordnet = synonyms.get();
        let lexicon = wordnet.as_deref().map(|wordnet| wordnet as &dyn Lexicon);
        let world = QueryWorld {
            objects: &self.objects,
            viewpoint: self.viewpoint,
            lessons: &self.lessons,
            taught_names: &self.taught_names,
            now_ns: now_ns() as i64,
            utc_offset_s: query.utc_offset_s,
            speaker: query.speaker.as_deref(),
        };
        let answer = find(&query.words, &world, lexicon)
            .map_err(|error| Refusal::new(RefusalKind::Invalid, error.to_string()))?;
        Ok(self.report(query, answer))
    }

    fn report(&self, query: &FindQuery, answer: Answer) -> FindReport {
        let mut remarks = answer.remarks;
        if self.scene.is_stale {
            remarks.push(self.scene.note.clone());
        }
        let word_use = |used: referring_expression::WordUse| WordUseReport {
            words: used.words,
            meaning: used.meaning,
        };
        FindReport {
            query: query.words.clone(),
            sentence: answer.sentence,
            matches: answer
                .matches
                .into_iter()
                .map(|found| self.found(found))
                .collect(),
            wants_one: answer.wants_one,
            understood: answer.understood.into_iter().map(word_use).collect(),
            not_understood: answer.not_understood,
            remarks,
            scene_age_s: self.scene.scene_age_s,
            is_stale: self.scene.is_stale,
        }
    }

    fn found(&self, found: Match) -> FoundObjectReport {
        let track_id = found.track_id;
        let mut live = self.scene.objects.iter();
        let live = live.find(|object| object.track_id == track_id);
        let mut objects = self.objects.iter();
        let gone = objects.find(|object| object.track_id == track_id && object.is_gone());
        let gone_label = gone.and_then(WorldObject::best_name).map(str::to_owned);
        FoundObjectReport {
            track_id,
            score: found.score,
            doubts: found.doubts,
            answer: live.map_or_else(
                || CategoryAnswer::of(gone_label.is_some(), None),
                |object| object.answer,
            ),
            label: live.map_or(gone_label, |object| object.label.clone()),
            state: live.map_or(GONE, |object| &object.state).to_owned(),
            position_m: match (live, gone) {
                (Some(object), _) => Some(object.position_m),
                (None, gone) => gone.map(|object| {
                    let centre = Vector3::from(object.centre_in_world_m);
                    (self.upright.inverse() * centre).into()
                }),
            },
        }
    }
}

/// Newest lessons of the working memory.
fn lessons(model: &WorldModel) -> Vec<Lesson> {
    let lesson = |event: &working_memory::Event| match &event.kind {
        EventKind::Lesson(taught) if taught.kind != LessonKind::Forgot => Some(Lesson {
            track_id: taught.track_id,
            category: taught.category.clone(),
            author: taught.author.clone(),
            wall_ns: event.wall_ns as i64,
        }),
        _ => None,
    };
    let newest_first = model.events_since(0).rev();
    newest_first
        .filter_map(lesson)
        .take(N_LESSONS_MAX)
        .collect()
}

/// Objects of the working memory that are gone, in a world whose z axis points up. Their colours
/// are not kept.
fn gone(model: &WorldModel, upright: &UnitQuaternion<f64>, lessons: &[Lesson]) -> Vec<WorldObject> {
    let object = |record: &ObjectRecord| {
        let place = upright_pose(
            upright,
            record.place.position_m,
            record.place.orientation_xyzw,
        );
        let label = record.label.as_ref();
        WorldObject {
            track_id: record.track_id,
            names: label.map(|name| (name.clone(), 1.0)).into_iter().collect(),
            is_labelled: label.is_some_and(|label| is_taught(lessons, record.track_id, label)),
            color_shares: [0.0; ColorTerm::ALL.len()],
            centre_in_world_m: place.translation.vector.into(),
            orientation_xyzw: place.rotation.coords.into(),
            size_m: record.place.size_m,
            presence: Presence::Gone,
            first_seen_ns: record.first_seen_ns as i64,
            last_seen_ns: record.last_seen_ns as i64,
        }
    };
    let mut records: Vec<&ObjectRecord> = model.past_objects().collect();
    records.sort_by_key(|record| Reverse((record.label.is_some(), record.last_seen_ns)));
    records.into_iter().take(N_GONE_MAX).map(object).collect()
}

/// True if the newest lesson about a track gave it the label.
fn is_taught(lessons: &[Lesson], track_id: u64, label: &str) -> bool {
    let of_track = |lesson: &&Lesson| lesson.track_id == Some(track_id);
    let newest = lessons.iter().find(of_track);
    newest.is_some_and(|lesson| lesson.category == label)
}

/// Pose in a world whose z axis points up.
fn upright_pose(
    upright: &UnitQuaternion<f64>,
    position_m: [f64; 3],
    [x, y, z, w]: [f64; 4],
) -> RigidTransform {
    let rotation = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
    RigidTransform::from_parts(
        (upright * Vector3::from(position_m)).into(),
        upright * rotation,
    )
}

/// Rotation of the world that points its up direction along z; the identity without one.
fn upright_from_world(scene: &SceneDocument) -> UnitQuaternion<f64> {
    let up = scene.up.map_or_else(Vector3::z, Vector3::from);
    UnitQuaternion::rotation_between(&up, &Vector3::z()).unwrap_or_else(|| {
        // Up is straight down: any half turn about a horizontal axis.
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    })
}

/// Viewpoint of the camera; `None` without its pose.
fn viewpoint(scene: &SceneDocument, upright: &UnitQuaternion<f64>) -> Option<Viewpoint> {
    let camera = scene.camera.as_ref()?;
    scene.up?;
    let world_from_camera = WirePose {
        position_m: camera.position_m,
        orientation_xyzw: camera.orientation_xyzw,
    }
    .checked()?;
    let position = upright * world_from_camera.translation.vector;
    Viewpoint::of_camera(position, &(upright * world_from_camera.rotation))
}

/// Object of the scene for a query, in a world whose z axis points up.
fn live_object(
    object: &ObjectDocument,
    upright: &UnitQuaternion<f64>,
    lessons: &[Lesson],
    now_ns: i64,
) -> WorldObject {
    let turned = upright_pose(upright, object.position_m, object.orientation_xyzw);
    let ago = |seconds: f64| now_ns.saturating_sub((seconds * 1e9) as i64);
    let is_taught = |label: &String| is_taught(lessons, object.track_id, label);
    WorldObject {
        track_id: object.track_id,
        names: names(object),
        is_labelled: object.label.as_ref().is_some_and(is_taught),
        color_shares: color_shares(object),
        centre_in_world_m: turned.translation.vector.into(),
        orientation_xyzw: turned.rotation.coords.into(),
        size_m: object.size_m,
        presence: if object.state == TrackState::Tracked.word() {
            Presence::InView
        } else {
            Presence::OutOfView
        },
        first_seen_ns: ago(object.age_s),
        last_seen_ns: ago(object.unseen_s),
    }
}

/// Categories with their probabilities, the label first.
fn names(object: &ObjectDocument) -> Vec<(String, f64)> {
    let probable = object.categories.iter();
    let probable = probable.map(|near| (near.label.clone(), near.probability));
    let label = object.label.clone();
    let label = label.map(|label| (label, object.probability.unwrap_or(1.0)));
    let mut names: Vec<(String, f64)> = label.into_iter().collect();
    names.extend(probable.filter(|(name, _)| Some(name) != object.label.as_ref()));
    names
}

fn color_shares(object: &ObjectDocument) -> [f32; ColorTerm::ALL.len()] {
    ColorTerm::ALL.map(|term| {
        let mut shares = object.colors.iter();
        let named = shares.find(|share| share.color == term.word());
        named.map_or(0.0, |named| named.share as f32)
    })
}

#[cfg(test)]
mod tests;
