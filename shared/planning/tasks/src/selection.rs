//! Choice of the next object of a task, with the reasons for which others are left.

use crate::step::{CarryStep, StepState, set_aside};
use crate::table_object::TableObject;
use geometry::ConvexPolygon;
use nalgebra::Point2;
use scene_document::CategoryAnswer;

/// Goal of a task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TaskGoal {
    /// Carry every object to the place of its category.
    ClearTable,
    /// Carry one object of a category to a place.
    FetchCategory {
        /// Category of the object.
        category: String,
        /// Name of the goal place.
        place: String,
    },
    /// Carry one tracked object to a place.
    FetchTrack {
        /// Track-id of the object.
        track: u64,
        /// Name of the goal place.
        place: String,
    },
}

/// Policy for an object without a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnnamedPolicy {
    /// Ask a person for its name, and leave it without an answer.
    Ask,
    /// Leave it where it stands.
    Leave,
    /// Carry it to the place for unknown objects.
    UnknownPlace,
}

/// Rules of a task that a person sets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskRules {
    /// Categories of objects that stay where they are.
    pub standard_items: Vec<String>,
    /// Policy for objects without a name.
    pub unnamed: UnnamedPolicy,
    /// True if an object that is only probably of a category counts as one without a name.
    pub doubts_are_unnamed: bool,
    /// True if no person has named an object in the time given for it, so that nobody is asked again.
    pub is_answer_overdue: bool,
}

/// Place of the configuration.
#[derive(Debug, Clone)]
pub struct NamedPlace {
    /// Name of the place.
    pub name: String,
    /// Categories whose objects belong there.
    pub categories: Vec<String>,
    /// Outline seen from above, world, metres.
    pub outline: ConvexPolygon,
}

/// Name of the place for objects without a category.
pub const UNKNOWN_PLACE: &str = "unknown";

/// Name of the place of a category among named places with their categories; that of unknown objects
/// for none.
pub fn place_of_category<'a>(
    places: impl IntoIterator<Item = (&'a str, &'a [String])>,
    category: Option<&str>,
) -> Option<&'a str> {
    let mut places = places.into_iter();
    let found = places.find(|(name, categories)| match category {
        Some(category) => categories.iter().any(|one| one == category),
        None => *name == UNKNOWN_PLACE,
    });
    found.map(|(name, _)| name)
}

/// Reason for which an object is left where it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LeftReason {
    /// It is a standard item.
    StandardItem,
    /// It stands at its place.
    AtItsPlace,
    /// It is not what the task is about.
    NotWanted,
    /// All attempts have failed; the last reason.
    SetAside(String),
    /// No place has its category.
    NoPlace,
    /// It has no name, and the rules leave such ones.
    Unnamed,
    /// A person is asked for its name.
    NameNeeded,
    /// Something else lies on it that cannot be taken away.
    Carries(u64),
    /// It is not seen at the moment.
    NotSeen,
}

/// Object that is left, with the reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftObject {
    /// Track-id.
    pub track: u64,
    /// Its label.
    pub label: Option<String>,
    /// Reason.
    pub reason: LeftReason,
}

/// Object that comes next, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NextObject {
    /// Track-id.
    pub track: u64,
    /// Its label; `None` where it counts as unnamed.
    pub label: Option<String>,
    /// Name of the goal place.
    pub place: String,
}

/// Choice of the next object.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Selection {
    /// Object that comes next, and after it the others in their order.
    pub next: Vec<NextObject>,
    /// Objects that are left.
    pub left: Vec<LeftObject>,
}

impl Selection {
    /// True if nothing is left that the task is about: what stays is to stay, or unknown.
    pub fn is_goal_reached(&self, goal: &TaskGoal, steps: &[CarryStep]) -> bool {
        let is_failure = |object: &LeftObject| match &object.reason {
            LeftReason::SetAside(_) | LeftReason::Carries(_) | LeftReason::NotSeen => true,
            LeftReason::StandardItem
            | LeftReason::AtItsPlace
            | LeftReason::NotWanted
            | LeftReason::NoPlace
            | LeftReason::Unnamed
            | LeftReason::NameNeeded => false,
        };
        match goal {
            TaskGoal::ClearTable => self.next.is_empty() && !self.left.iter().any(is_failure),
            TaskGoal::FetchCategory { .. } | TaskGoal::FetchTrack { .. } => {
                steps.iter().any(|step| step.state == StepState::Succeeded)
            }
        }
    }

    /// Track-ids of the objects that need a name.
    pub fn need_names(&self) -> impl Iterator<Item = u64> {
        let left = self.left.iter();
        left.filter(|object| object.reason == LeftReason::NameNeeded)
            .map(|object| object.track)
    }
}

/// Scene and plan of a task from which the next object is chosen.
#[derive(Debug, Clone, Copy)]
pub struct TaskView<'a> {
    /// Objects of the newest scene.
    pub objects: &'a [TableObject],
    /// Places of the configuration.
    pub places: &'a [NamedPlace],
    /// Steps of the task until now.
    pub steps: &'a [CarryStep],
    /// Base of the arm seen from above, world, metres.
    pub arm_base: Point2<f64>,
}

/// Chooses the next object of a task: the nearest to the arm's base first (Kasaei et al. 2018,
/// "Execution Manager"), but what lies on or in another thing before that.
pub fn select(goal: &TaskGoal, rules: &TaskRules, view: &TaskView<'_>) -> Selection {
    let mut selection = Selection::default();
    let mut wanted: Vec<(&TableObject, NextObject)> = Vec::new();
    for object in view.objects {
        match place_of(object, goal, rules, view) {
            Ok((label, place)) => wanted.push((
                object,
                NextObject {
                    track: object.track,
                    label,
                    place,
                },
            )),
            Err(reason) => selection.leave(object, reason),
        }
    }
    let distance_m = |object: &TableObject| (object.middle() - view.arm_base).norm();
    wanted.sort_by(|(a, _), (b, _)| {
        let nearer = distance_m(a).total_cmp(&distance_m(b));
        nearer.then(a.track.cmp(&b.track))
    });
    order(wanted, view, &mut selection);
    selection
}

/// Moves the wanted objects into the selection, each after those that lie on it.
fn order(
    mut wanted: Vec<(&TableObject, NextObject)>,
    view: &TaskView<'_>,
    selection: &mut Selection,
) {
    wanted.retain(|(object, _)| {
        let others = view.objects.iter();
        let blocked = others
            .filter(|other| object.carries(other))
            .find(|other| selection.left.iter().any(|left| left.track == other.track));
        if let Some(other) = blocked {
            let reason = LeftReason::Carries(other.track);
            selection.leave(object, reason);
        }
        blocked.is_none()
    });
    while !wanted.is_empty() {
        let is_free = |(object, _): &(&TableObject, NextObject)| {
            !wanted.iter().any(|(other, _)| object.carries(other))
        };
        // Without one, in a circle, the nearest comes first.
        let place = wanted.iter().position(is_free).unwrap_or(0);
        let (_, next) = wanted.remove(place);
        selection.next.push(next);
    }
}

impl Selection {
    fn leave(&mut self, object: &TableObject, reason: LeftReason) {
        self.left.push(LeftObject {
            track: object.track,
            label: object.label.clone(),
            reason,
        });
    }
}

/// Label by which an object is carried, and its goal place.
fn place_of(
    object: &TableObject,
    goal: &TaskGoal,
    rules: &TaskRules,
    view: &TaskView<'_>,
) -> Result<(Option<String>, String), LeftReason> {
    let label = name_of(object, rules);
    if let Some(reason) = set_aside(view.steps, object.track) {
        return Err(LeftReason::SetAside(reason.to_owned()));
    }
    let place = match goal {
        TaskGoal::ClearTable => cleared_to(object, label, rules, view)?,
        TaskGoal::FetchCategory { category, place } => {
            let is_wanted = object.label.as_ref() == Some(category);
            is_wanted
                .then(|| place.clone())
                .ok_or(LeftReason::NotWanted)?
        }
        TaskGoal::FetchTrack { track, place } => {
            let is_wanted = object.track == *track;
            is_wanted
                .then(|| place.clone())
                .ok_or(LeftReason::NotWanted)?
        }
    };
    let is_done = |step: &CarryStep| step.state == StepState::Succeeded;
    if *goal != TaskGoal::ClearTable && view.steps.iter().any(is_done) {
        return Err(LeftReason::NotWanted);
    }
    let at_place = view.places.iter().find(|one| one.name == place);
    if at_place.is_some_and(|one| one.outline.contains(&object.middle())) {
        return Err(LeftReason::AtItsPlace);
    }
    if !object.is_seen {
        return Err(LeftReason::NotSeen);
    }
    Ok((label.map(str::to_owned), place))
}

/// Name of an object, as far as the rules take it for one.
fn name_of<'a>(object: &'a TableObject, rules: &TaskRules) -> Option<&'a str> {
    let is_named = match object.answer {
        CategoryAnswer::Is => true,
        CategoryAnswer::Probably => !rules.doubts_are_unnamed,
        CategoryAnswer::Unknown => false,
    };
    object.label.as_deref().filter(|_| is_named)
}

/// Place of the category of an object that is cleared away.
fn cleared_to(
    object: &TableObject,
    label: Option<&str>,
    rules: &TaskRules,
    view: &TaskView<'_>,
) -> Result<String, LeftReason> {
    let places = view.places.iter();
    let places = places.map(|place| (place.name.as_str(), place.categories.as_slice()));
    let own = place_of_category(places, label);
    let own = own.map(str::to_owned).ok_or(LeftReason::NoPlace);
    let Some(label) = label else {
        return match rules.unnamed {
            UnnamedPolicy::Ask if is_in_a_place(object, view) => Err(LeftReason::AtItsPlace),
            UnnamedPolicy::Ask if !rules.is_answer_overdue => Err(LeftReason::NameNeeded),
            UnnamedPolicy::Ask | UnnamedPolicy::Leave => Err(LeftReason::Unnamed),
            UnnamedPolicy::UnknownPlace => own,
        };
    };
    if rules.standard_items.iter().any(|item| item == label) {
        return Err(LeftReason::StandardItem);
    }
    own
}

/// True if an object stands in any place.
fn is_in_a_place(object: &TableObject, view: &TaskView<'_>) -> bool {
    let mut places = view.places.iter();
    places.any(|place| place.outline.contains(&object.middle()))
}

#[cfg(test)]
mod tests;
