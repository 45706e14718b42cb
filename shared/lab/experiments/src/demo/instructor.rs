//! Scripted person: knows where the objects were put, and teaches their names one by one.

use super::demo_table::{DemoObject, DemoTable};
use control_protocol::{
    Labelling, LearningReport, MutationId, RandomIdError, TypedRequest, request,
};
use message::{SceneObject, TrackState};
use scene_document::CategoryAnswer;
use std::collections::BTreeMap;

/// Name of the person.
pub(super) const AUTHOR: &str = "instructor";
/// Distance from where an object was put within which a track is that object, metres.
const NEAR_M: f64 = 0.05;

/// Name that the person is about to tell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ObjectLesson {
    pub(super) track: u64,
    pub(super) category: String,
    /// True if the robot has another name for the object.
    pub(super) is_correction: bool,
}

impl ObjectLesson {
    /// Request that teaches the name.
    ///
    /// # Errors
    /// When the operating system gives no random numbers.
    pub(super) fn request(&self) -> Result<TypedRequest<LearningReport>, RandomIdError> {
        let labelling = Labelling {
            id: MutationId::random()?,
            author: AUTHOR.to_owned(),
            track_id: self.track,
            category: self.category.clone(),
            is_new: false,
        };
        Ok(if self.is_correction {
            request::correct(labelling)
        } else {
            request::teach(labelling)
        })
    }
}

/// Scripted person with what it has taught.
#[derive(Debug, Default)]
pub(super) struct Instructor {
    /// Category of each track that the person has named.
    named: BTreeMap<u64, String>,
}

impl Instructor {
    /// Next name that the robot does not say by itself, of an object that the person knows.
    pub(super) fn next_lesson(
        &self,
        table: &DemoTable,
        objects: &[SceneObject],
    ) -> Option<ObjectLesson> {
        let seen: Vec<&SceneObject> = objects.iter().filter(|one| is_tracked(one)).collect();
        seen.iter().find_map(|object| {
            let category = self.category_of(object, table, &seen)?;
            let is_named =
                object.label() == Some(category) && object.answer() == CategoryAnswer::Is;
            (!is_named).then(|| ObjectLesson {
                track: object.track_id,
                category: category.to_owned(),
                is_correction: object.label().is_some_and(|label| label != category),
            })
        })
    }

    /// Category of a seen object: that which the person has named before, that of the object that was put
    /// there, or, of the only object without a name, that which is missing.
    fn category_of<'s>(
        &'s self,
        object: &SceneObject,
        table: &'s DemoTable,
        seen: &[&SceneObject],
    ) -> Option<&'s str> {
        let before = self.named.get(&object.track_id).map(String::as_str);
        let put = || object_at(table, object).map(|put| put.category.as_str());
        before.or_else(put).or_else(|| {
            let mut unnamed = seen.iter().filter(|one| one.label().is_none());
            let is_only = unnamed.next()?.track_id == object.track_id && unnamed.next().is_none();
            let is_missing = |category: &str| !seen.iter().any(|one| one.label() == Some(category));
            let categories = table.objects.iter().map(|one| one.category.as_str());
            let mut missing = categories.filter(|category| is_missing(category));
            let first = missing.next()?;
            (is_only && missing.next().is_none()).then_some(first)
        })
    }

    /// Remembers a lesson that was given.
    pub(super) fn remember(&mut self, lesson: &ObjectLesson) {
        self.named.insert(lesson.track, lesson.category.clone());
    }
}

/// Number of objects of the table that stand where they were put, and are tracked.
pub(super) fn n_seen(table: &DemoTable, objects: &[SceneObject]) -> usize {
    let tracked = objects.iter().filter(|object| is_tracked(object));
    tracked
        .filter_map(|object| object_at(table, object))
        .count()
}

/// True for an object that is seen.
pub(super) fn is_tracked(object: &SceneObject) -> bool {
    TrackState::from_code(object.state) == Some(TrackState::Tracked)
}

/// Object that was put where a track is.
fn object_at<'t>(table: &'t DemoTable, object: &SceneObject) -> Option<&'t DemoObject> {
    let [x, y, _] = object.pose.position_m;
    let distance_m = |put: &DemoObject| (put.position_m[0] - x).hypot(put.position_m[1] - y);
    let nearest = table
        .objects
        .iter()
        .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))?;
    (distance_m(nearest) <= NEAR_M).then_some(nearest)
}
