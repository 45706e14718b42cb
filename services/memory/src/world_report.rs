//! Conversion between the working memory's types and the control protocol.

use control_protocol::{FactFilter, MAX_PAGE_FACTS, Refusal, RefusalKind, WorldRegion};
use message::{SceneTime, TrackState};
use scene_document::{
    CategoryAnswer, FactDocument, FactsDocument, PlaceDocument, RobotDocument, WorldDocument,
    WorldObjectDocument, WorldSurfaceDocument,
};
use working_memory::{
    BoxPose, Fact, FactPage, FactQuery, ObjectRecord, Property, Region, Robot, Subject,
    SurfaceRecord, Value, Window, WorldModel,
};

/// Freshness of the newest scene at the time of a report; all `None` before the first scene.
pub(crate) struct SceneFreshness {
    age_s: Option<f64>,
    capture_stamp_ns: Option<u64>,
    is_stale: bool,
}

impl SceneFreshness {
    /// Freshness at a time of the monotonic clock, nanoseconds.
    pub(crate) fn of(scene: Option<SceneTime>, now_ns: u64) -> Self {
        Self {
            age_s: scene.map(|scene| scene.age_s(now_ns)),
            capture_stamp_ns: scene.map(|scene| scene.capture_ns),
            is_stale: scene.is_none_or(|scene| scene.is_stale(now_ns)),
        }
    }
}

/// Report of the current objects, of the surfaces and of the robot.
pub(crate) fn world(model: &WorldModel, scene: &SceneFreshness, now_ns: u64) -> WorldDocument {
    let objects = model.objects().map(|one| object(model, one));
    let surfaces = model.surfaces().map(|one| surface(model, one));
    WorldDocument {
        now_ns,
        scene_age_s: scene.age_s,
        capture_stamp_ns: scene.capture_stamp_ns,
        is_stale: scene.is_stale,
        objects: if scene.is_stale {
            objects.map(stale).collect()
        } else {
            objects.collect()
        },
        surfaces: if scene.is_stale {
            surfaces.map(stale_surface).collect()
        } else {
            surfaces.collect()
        },
        robot: model.robot().map(robot),
        newest_event: model.newest_event(),
    }
}

/// Object whose state is not known since it was seen last.
fn stale(object: WorldObjectDocument) -> WorldObjectDocument {
    WorldObjectDocument {
        state: TrackState::STALE_WORD.to_owned(),
        state_since_ns: object.last_seen_ns,
        ..object
    }
}

/// Surface whose state is not known since it was seen last.
fn stale_surface(surface: WorldSurfaceDocument) -> WorldSurfaceDocument {
    WorldSurfaceDocument {
        state: TrackState::STALE_WORD.to_owned(),
        ..surface
    }
}

/// Answer of a label that is certain or probable; unknown without a label.
pub(crate) fn answer(label: Option<&String>, is_probable: bool) -> CategoryAnswer {
    match (label, is_probable) {
        (None, _) => CategoryAnswer::Unknown,
        (Some(_), true) => CategoryAnswer::Probably,
        (Some(_), false) => CategoryAnswer::Is,
    }
}

fn object(model: &WorldModel, object: &ObjectRecord) -> WorldObjectDocument {
    let since_ns = |property| model.since_ns(Subject::Object(object.track_id), property);
    WorldObjectDocument {
        track_id: object.track_id,
        state: object.state.clone(),
        state_since_ns: since_ns(Property::State).unwrap_or(object.first_seen_ns),
        label: object.label.clone(),
        answer: answer(object.label.as_ref(), object.is_probable),
        label_since_ns: since_ns(Property::Label),
        place: place(&object.place),
        place_since_ns: since_ns(Property::Place).unwrap_or(object.first_seen_ns),
        first_seen_ns: object.first_seen_ns,
        last_seen_ns: object.last_seen_ns,
    }
}

fn surface(model: &WorldModel, surface: &SurfaceRecord) -> WorldSurfaceDocument {
    let [x, y, z, offset_m] = surface.plane;
    let corners = surface.corners_m.iter();
    let carried = model
        .objects()
        .filter(|object| object.surface == Some(surface.number));
    WorldSurfaceDocument {
        surface_id: surface.number,
        kind: surface.kind.clone(),
        state: surface.state().to_owned(),
        normal: [x, y, z],
        offset_m,
        outline_m: corners.map(|corner| corner.map(f64::from)).collect(),
        track_ids: carried.map(|object| object.track_id).collect(),
        first_seen_ns: surface.first_seen_ns,
        last_seen_ns: surface.last_seen_ns,
    }
}

fn place(place: &BoxPose) -> PlaceDocument {
    PlaceDocument {
        position_m: place.position_m,
        orientation_xyzw: place.orientation_xyzw,
        size_m: place.size_m,
    }
}

fn robot(robot: &Robot) -> RobotDocument {
    RobotDocument {
        activity: robot.activity.clone(),
        is_holding: robot.is_holding,
        note: robot.note.clone(),
        opening_m: robot.opening_m,
        joint_angles_rad: robot.joint_angles_rad.clone(),
        position_m: robot.position_m,
        orientation_xyzw: robot.orientation_xyzw,
        last_heard_ns: robot.last_heard_ns,
        is_heard: robot.is_heard,
    }
}

/// Fact query from a wire filter.
pub(crate) fn query(filter: FactFilter) -> Result<FactQuery, Refusal> {
    let invalid = |rule: &str| Refusal::new(RefusalKind::Invalid, rule);
    let window = Window {
        from_ns: filter.since_ns.unwrap_or(0),
        to_ns: filter.until_ns.unwrap_or(u64::MAX),
    };
    if window.from_ns > window.to_ns {
        return Err(invalid(
            "the end of the time asked for lies before its beginning",
        ));
    }
    let region = filter.region.map(region).transpose().map_err(invalid)?;
    Ok(FactQuery {
        subject: filter.track_id.map(Subject::Object),
        label: filter.label,
        region,
        window: Some(window),
        before: filter.before,
        n_most: (filter.limit as usize).clamp(1, MAX_PAGE_FACTS),
    })
}

fn region(region: WorldRegion) -> Result<Region, &'static str> {
    let are_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    match region {
        WorldRegion::Ball { centre_m, radius_m } => {
            if !are_finite(&centre_m) || !radius_m.is_finite() || radius_m < 0.0 {
                return Err("a ball has a finite centre and a radius of 0 m or more");
            }
            Ok(Region::Ball { centre_m, radius_m })
        }
        WorldRegion::Box { min_m, max_m } => {
            if !are_finite(&min_m) || !are_finite(&max_m) {
                return Err("the corners of a box are finite");
            }
            Ok(Region::Box { min_m, max_m })
        }
    }
}

/// Page of facts as a wire report.
pub(crate) fn facts(page: &FactPage) -> FactsDocument {
    FactsDocument {
        facts: page.facts.iter().map(fact).collect(),
        next: page.next,
    }
}

fn fact(fact: &Fact) -> FactDocument {
    let (mut track_id, mut task_id, mut surface_id) = (None, None, None);
    let subject = match fact.subject {
        Subject::Object(track) => {
            track_id = Some(track);
            "object"
        }
        Subject::Robot => "robot",
        Subject::Task(task) => {
            task_id = Some(task);
            "task"
        }
        Subject::Surface(surface) => {
            surface_id = Some(surface);
            "surface"
        }
    };
    let word = |is_holding| if is_holding { "yes" } else { "no" };
    let (property, value) = match &fact.value {
        Value::State(state) => ("state", Some(state.clone())),
        Value::Label(label) | Value::ProbableLabel(label) => ("label", Some(label.clone())),
        Value::Place(_) => ("place", None),
        Value::Activity(activity) => ("activity", Some(activity.clone())),
        Value::Holding(is_holding) => ("holding", Some(word(*is_holding).to_owned())),
    };
    let place = match &fact.value {
        Value::Place(known) => Some(place(known)),
        _ => None,
    };
    let answer = match &fact.value {
        Value::Label(_) => Some(CategoryAnswer::Is),
        Value::ProbableLabel(_) => Some(CategoryAnswer::Probably),
        _ => None,
    };
    FactDocument {
        fact: fact.number,
        subject: subject.to_owned(),
        track_id,
        task_id,
        surface_id,
        property: property.to_owned(),
        value,
        answer,
        place,
        start_ns: fact.start_ns,
        end_ns: fact.end_ns,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn freshness_tells_the_age_of_the_newest_scene() {
        let scene = SceneTime {
            capture_ns: 1_000_000_000,
            received_ns: 1_000_000_000,
            stale_after_ns: 1_000_000_000,
            is_lockstep: false,
        };
        let at = |now_ns| SceneFreshness::of(Some(scene), now_ns);
        assert!(!at(2_000_000_000).is_stale);
        let old = at(4_500_000_000);
        assert_eq!((old.is_stale, old.age_s), (true, Some(3.5)));
        assert_eq!(old.capture_stamp_ns, Some(1_000_000_000));
        let none = SceneFreshness::of(None, 7);
        assert_eq!((none.is_stale, none.age_s), (true, None));
    }

    #[test]
    fn state_of_a_stale_object_is_unknown_since_it_was_seen_last() {
        let object = WorldObjectDocument {
            track_id: 7,
            state: "tracked".into(),
            state_since_ns: 3,
            label: None,
            answer: CategoryAnswer::Unknown,
            label_since_ns: None,
            place: PlaceDocument {
                position_m: [0.0; 3],
                orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
                size_m: [0.1; 3],
            },
            place_since_ns: 3,
            first_seen_ns: 3,
            last_seen_ns: 9,
        };
        let stale = stale(object);
        assert_eq!((stale.state.as_str(), stale.state_since_ns), ("stale", 9));
        assert_eq!(stale.place_since_ns, 3);
    }

    #[test]
    fn invalid_filters_are_refused() {
        let ball = |centre_m, radius_m| FactFilter {
            region: Some(WorldRegion::Ball { centre_m, radius_m }),
            ..FactFilter::default()
        };
        let backwards = FactFilter {
            since_ns: Some(2),
            until_ns: Some(1),
            ..FactFilter::default()
        };
        let wrong = [ball([f64::NAN; 3], 1.0), ball([0.0; 3], -1.0), backwards];
        for filter in wrong {
            assert_eq!(query(filter).unwrap_err().kind, RefusalKind::Invalid);
        }
        let limited = query(FactFilter {
            limit: u32::MAX,
            ..ball([0.0; 3], 0.0)
        });
        assert_eq!(limited.unwrap().n_most, MAX_PAGE_FACTS);
    }
}
