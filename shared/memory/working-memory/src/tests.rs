//! Model-based test of the world model against a naive reference implementation.

mod golden;
mod steps;

use durable_leveldb::MutationId;
use proptest::prelude::*;

use super::*;

const SECOND: u64 = 1_000_000_000;

pub(crate) const CONFIG: WorldConfig = WorldConfig {
    move_min_m: 0.02,
    turn_min_rad: 0.3,
    keep_ns: 60 * SECOND,
    n_kept_most: 40,
    seen_period_ns: 10 * SECOND,
    write_buffer_bytes: 4 << 20,
};

const STATES: [&str; 2] = ["tracked", "missing"];
const LABELS: [Option<&str>; 3] = [None, Some("mug"), Some("bowl")];

/// Observed object: track, state, label, and place as a number.
type ObservedObject = (u64, usize, usize, u8);

#[derive(Debug, Clone)]
enum WorldStep {
    Scene(Vec<ObservedObject>, bool),
    Robot(bool),
    LoseRobot,
    Start(u128),
    End(u128, u64),
    /// Record of a step: task, number, state and reason.
    Record(u64, u64, usize, usize),
    Wait(i64),
}

pub(crate) fn place(x: u8) -> BoxPose {
    BoxPose {
        position_m: [f64::from(x) / 10.0, 0.0, 0.7],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.1; 3],
    }
}

pub(crate) fn sighting(
    &(track_id, state, label, x): &ObservedObject,
    now_ns: u64,
) -> Sighting<'static> {
    Sighting {
        track_id,
        state: STATES[state],
        label: LABELS[label],
        is_probable: false,
        place: place(x),
        surface: None,
        first_seen_ns: now_ns,
        last_seen_ns: now_ns,
    }
}

fn steps() -> impl Strategy<Value = Vec<WorldStep>> {
    let seen = (1..4_u64, 0..2_usize, 0..3_usize, 0..4_u8);
    let scene = prop::collection::vec(seen, 0..3).prop_map(|mut seen| {
        seen.sort_unstable();
        seen.dedup_by_key(|seen| seen.0);
        seen
    });
    let step = prop_oneof![
        6 => (scene, prop::bool::weighted(0.9)).prop_map(|(seen, whole)| WorldStep::Scene(seen, whole)),
        2 => any::<bool>().prop_map(WorldStep::Robot),
        1 => Just(WorldStep::LoseRobot),
        1 => (0..3_u128).prop_map(WorldStep::Start),
        1 => (10..13_u128, 1..4_u64).prop_map(|(id, task)| WorldStep::End(id, task)),
        3 => (1..4_u64, 0..5_u64, 0..4_usize, 0..2_usize)
            .prop_map(|(task, number, state, reason)| WorldStep::Record(task, number, state, reason)),
        4 => (-3..20_i64).prop_map(|seconds| WorldStep::Wait(seconds * SECOND as i64)),
    ];
    prop::collection::vec(step, 0..60)
}

struct NaiveTask {
    number: u64,
    start_id: u128,
    end: Option<(u128, u64)>,
    steps: Vec<TaskStep>,
}

/// Naive reference: a list of all facts, searched linearly.
#[derive(Default)]
struct NaiveModel {
    facts: Vec<Fact>,
    tasks: Vec<NaiveTask>,
    n_facts: u64,
    n_tasks: u64,
}

impl NaiveModel {
    fn open(&mut self, subject: Subject, property: Property) -> Option<&mut Fact> {
        let is_open = |fact: &&mut Fact| {
            fact.subject == subject && fact.value.property() == property && fact.end_ns.is_none()
        };
        self.facts.iter_mut().find(is_open)
    }

    fn end(&mut self, subject: Subject, property: Property, end_ns: u64) {
        if let Some(fact) = self.open(subject, property) {
            fact.end_ns = Some(end_ns.max(fact.start_ns));
        }
    }

    fn set(&mut self, subject: Subject, value: Value, now_ns: u64) {
        let property = value.property();
        if self
            .open(subject, property)
            .is_some_and(|fact| fact.value == value)
        {
            return;
        }
        self.end(subject, property, now_ns);
        self.n_facts += 1;
        self.facts.push(Fact {
            number: self.n_facts,
            subject,
            value,
            start_ns: now_ns,
            end_ns: None,
        });
    }

    fn scene(&mut self, seen: &[ObservedObject], is_whole: bool, now_ns: u64) {
        for &(track, state, label, x) in seen {
            let subject = Subject::Object(track);
            self.set(subject, Value::State(STATES[state].to_owned()), now_ns);
            match LABELS[label] {
                Some(label) => self.set(subject, Value::Label(label.to_owned()), now_ns),
                None => self.end(subject, Property::Label, now_ns),
            }
            self.set(subject, Value::Place(place(x)), now_ns);
        }
        for track in (1..4).filter(|track| is_whole && seen.iter().all(|seen| seen.0 != *track)) {
            for property in [Property::State, Property::Label, Property::Place] {
                self.end(Subject::Object(track), property, now_ns);
            }
        }
    }

    fn start(&mut self, id: u128, now_ns: u64) -> u64 {
        if let Some(known) = self.tasks.iter().find(|task| task.start_id == id) {
            return known.number;
        }
        self.n_tasks += 1;
        self.tasks.push(NaiveTask {
            number: self.n_tasks,
            start_id: id,
            end: None,
            steps: Vec::new(),
        });
        let running = Value::State("running".to_owned());
        self.set(Subject::Task(self.n_tasks), running, now_ns);
        self.n_tasks
    }

    /// Ends a task; `true` if this request ended it.
    fn end_task(&mut self, id: u128, number: u64, now_ns: u64) -> bool {
        let Some(task) = self.tasks.iter_mut().find(|task| task.number == number) else {
            return false;
        };
        if task.end.is_none() {
            let subject = Subject::Task(number);
            self.end(subject, Property::State, now_ns);
            let is_its = |fact: &&Fact| fact.subject == subject;
            let start_ns = self.facts.iter().find(is_its).unwrap().start_ns;
            let task = self.tasks.iter_mut().find(|task| task.number == number);
            let (task, ended_ns) = (task.unwrap(), now_ns.max(start_ns));
            task.end = Some((id, ended_ns));
            steps::end_naively(&mut task.steps, ended_ns);
            return true;
        }
        task.end.is_some_and(|end| end.0 == id)
    }

    /// Records a step; `true` if it is recorded now.
    fn record(&mut self, task: u64, content: StepContent, now_ns: u64) -> bool {
        let known = self.tasks.iter_mut().find(|known| known.number == task);
        known.is_some_and(|task| {
            let is_running = task.end.is_none();
            steps::record_naively(&mut task.steps, is_running, content, now_ns)
        })
    }

    fn forget(&mut self, now_ns: u64) {
        let is_kept = |task: &NaiveTask| task.end.is_none_or(|end| end.1 + CONFIG.keep_ns > now_ns);
        self.tasks.retain(is_kept);
        loop {
            let over = self.facts.iter().filter(|fact| fact.end_ns.is_some());
            let n_over = over.clone().count();
            let Some(first) = over.min_by_key(|fact| (fact.end_ns, fact.number)) else {
                return;
            };
            let is_old = first.end_ns.unwrap() + CONFIG.keep_ns <= now_ns;
            if !is_old && n_over <= CONFIG.n_kept_most {
                return;
            }
            let number = first.number;
            self.facts.retain(|fact| fact.number != number);
        }
    }

    fn answer(&self, query: &FactQuery) -> Vec<u64> {
        let mut numbers: Vec<u64> = self
            .facts
            .iter()
            .filter(|fact| query.subject.is_none_or(|subject| fact.subject == subject))
            .filter(|fact| query.before.is_none_or(|before| fact.number < before))
            .filter(|fact| self.is_wanted(fact, query))
            .map(|fact| fact.number)
            .collect();
        numbers.reverse();
        numbers
    }

    /// Searches for an instant at which all conditions hold. If there is one, the latest of the
    /// interval starts is one.
    fn is_wanted(&self, fact: &Fact, query: &FactQuery) -> bool {
        let of_subject = |other: &&Fact| other.subject == fact.subject;
        let called: Vec<&Fact> = match &query.label {
            None => vec![fact],
            Some(label) => {
                let so = |fact: &&Fact| fact.value == Value::Label(label.clone());
                self.facts.iter().filter(of_subject).filter(so).collect()
            }
        };
        let there: Vec<&Fact> = match &query.region {
            None => vec![fact],
            Some(region) => {
                let so = |fact: &&Fact| matches!(&fact.value, Value::Place(place) if region.contains(&place.position_m));
                self.facts.iter().filter(of_subject).filter(so).collect()
            }
        };
        let holds = |fact: &Fact, at: u64| {
            let end = fact.end_ns.unwrap_or(u64::MAX).max(fact.start_ns + 1);
            (fact.start_ns..end).contains(&at)
        };
        let (from, to) = query
            .window
            .map_or((0, u64::MAX), |window| (window.from_ns, window.to_ns));
        called.iter().any(|called| {
            there.iter().any(|there| {
                let all = [fact, called, there];
                let at = all
                    .map(|fact| fact.start_ns)
                    .into_iter()
                    .max()
                    .unwrap()
                    .max(from);
                at <= to && all.iter().all(|fact| holds(fact, at))
            })
        })
    }
}

fn robot(is_holding: bool) -> RobotSighting<'static> {
    RobotSighting {
        activity: if is_holding { "closing" } else { "idle" },
        outcome: None,
        command_id: 1,
        note: "",
        is_holding,
        opening_m: 0.1,
        joint_angles_rad: &[0.0; 6],
        position_m: [0.0; 3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
    }
}

/// Applies the steps to model and reference; the wall clock may step back.
fn play(steps: &[WorldStep]) -> (WorldModel, NaiveModel, u64) {
    let mut now_ns = 1000 * SECOND;
    let (mut model, mut slow) = (WorldModel::new(CONFIG), NaiveModel::default());
    let mut last_heard_ns = None;
    for step in steps {
        match step {
            WorldStep::Scene(seen, is_whole) => {
                let sightings = seen.iter().map(|seen| sighting(seen, now_ns));
                model.observe(sightings, *is_whole, now_ns);
                slow.scene(seen, *is_whole, now_ns);
            }
            WorldStep::Robot(is_holding) => {
                let robot = robot(*is_holding);
                model.observe_robot(&robot, now_ns);
                let activity = Value::Activity(robot.activity.to_owned());
                slow.set(Subject::Robot, activity, now_ns);
                slow.set(Subject::Robot, Value::Holding(*is_holding), now_ns);
                last_heard_ns = Some(now_ns);
            }
            WorldStep::LoseRobot => {
                model.lose_robot();
                for property in [Property::Activity, Property::Holding] {
                    slow.end(Subject::Robot, property, last_heard_ns.unwrap_or(0));
                }
            }
            WorldStep::Start(id) => {
                let new = NewTask {
                    id: MutationId(*id),
                    kind: "clear the table".to_owned(),
                    parameters: String::new(),
                    author: String::new(),
                };
                let task = model.start_task(&new, now_ns).unwrap().number;
                assert_eq!(task, slow.start(*id, now_ns));
            }
            WorldStep::End(id, task) => {
                let end = TaskEnd {
                    id: MutationId(*id),
                    task: *task,
                    outcome: Outcome::Failed,
                    reason: String::new(),
                };
                let has_ended = model.end_task(&end, now_ns).is_ok();
                assert_eq!(has_ended, slow.end_task(*id, *task, now_ns));
            }
            WorldStep::Record(task, number, state, reason) => {
                let content = steps::content(*number, *state, *reason);
                let recorded = model.record_step(*task, content.clone(), now_ns).is_ok();
                assert_eq!(recorded, slow.record(*task, content, now_ns));
            }
            WorldStep::Wait(ns) => now_ns = now_ns.saturating_add_signed(*ns),
        }
        while model.expire(now_ns) {}
        slow.forget(now_ns);
        for task in &slow.tasks {
            let known = model.task(task.number).map(|known| &known.steps);
            assert_eq!(known, Some(&task.steps));
        }
    }
    (model, slow, now_ns)
}

fn queries() -> impl Strategy<Value = FactQuery> {
    let subject = prop_oneof![
        3 => Just(None),
        2 => (1..4_u64).prop_map(|track| Some(Subject::Object(track))),
        1 => Just(Some(Subject::Robot)),
    ];
    let label = prop::option::of(prop_oneof![Just("mug".to_owned()), Just("bowl".to_owned())]);
    let ball = (0..4_u8).prop_map(|x| Region::Ball {
        centre_m: place(x).position_m,
        radius_m: 0.11,
    });
    let corners = (0..4_u8).prop_map(|x| Region::Box {
        min_m: place(x).position_m,
        max_m: [1.0; 3],
    });
    let region = prop::option::of(prop_oneof![ball, corners]);
    let window = prop::option::of(
        (980..1400_u64, 0..30_u64).prop_map(|(from, length)| Window {
            from_ns: from * SECOND,
            to_ns: (from + length) * SECOND,
        }),
    );
    (subject, label, region, window, 1..5_usize).prop_map(
        |(subject, label, region, window, n_most)| FactQuery {
            subject,
            label,
            region,
            window,
            before: None,
            n_most,
        },
    )
}

proptest! {
    #[test]
    fn queries_equal_a_linear_search(
        steps in steps(),
        queries in prop::collection::vec(queries(), 1..8),
    ) {
        let (model, slow, _) = play(&steps);
        let all = FactQuery {
            subject: None, label: None, region: None, window: None, before: None, n_most: 1000,
        };
        let mut known = model.facts(&all).facts;
        known.reverse();
        prop_assert_eq!(&known, &slow.facts);
        for mut query in queries {
            let expected = slow.answer(&query);
            let mut pages = Vec::new();
            loop {
                let page = model.facts(&query);
                prop_assert!(page.facts.len() <= query.n_most);
                pages.extend(page.facts.iter().map(|fact| fact.number));
                match page.next {
                    Some(next) => query.before = Some(next),
                    None => break,
                }
            }
            prop_assert_eq!(pages, expected, "{:?}", query);
        }
    }

    /// Invariants under any clock: nothing ends before it began, and each property has at most one
    /// current fact.
    #[test]
    fn each_property_has_one_current_fact(steps in steps()) {
        let (model, slow, _) = play(&steps);
        for fact in &slow.facts {
            prop_assert!(fact.end_ns.is_none_or(|end_ns| end_ns >= fact.start_ns));
            if fact.end_ns.is_none() {
                let since_ns = model.since_ns(fact.subject, fact.value.property());
                prop_assert_eq!(since_ns, Some(fact.start_ns));
            }
        }
        let sequences: Vec<u64> = model.events_since(0).map(|event| event.sequence).collect();
        let last = model.newest_event();
        let first = last + 1 - sequences.len() as u64;
        if steps.iter().all(|step| !matches!(step, WorldStep::Wait(ns) if *ns < 0)) {
            // A stepped clock forgets in the order of its own times.
            prop_assert_eq!(sequences, (first..=last).collect::<Vec<_>>());
        }
    }
}

fn kinds(model: &WorldModel, since: u64) -> Vec<EventKind> {
    model
        .events_since(since)
        .map(|event| event.kind.clone())
        .collect()
}

fn see(model: &mut WorldModel, seen: &[ObservedObject], now_ns: u64) {
    let sightings = seen.iter().map(|seen| sighting(seen, now_ns));
    model.observe(sightings, true, now_ns);
}

#[test]
fn object_life_cycle_makes_events() {
    let mut model = WorldModel::new(CONFIG);
    see(&mut model, &[(7, 0, 0, 1)], SECOND);
    see(&mut model, &[(7, 0, 1, 1)], 3 * SECOND);
    // Carried: one event, when it leaves the place where it rested.
    see(&mut model, &[(7, 0, 1, 2)], 4 * SECOND);
    see(&mut model, &[(7, 0, 1, 3)], 4 * SECOND + 1);
    see(&mut model, &[], 9 * SECOND);
    let mug = || Some("mug".to_owned());
    let expected = [
        EventKind::Appeared {
            track_id: 7,
            label: None,
            is_probable: false,
            position_m: place(1).position_m,
        },
        EventKind::Relabelled {
            track_id: 7,
            before: None,
            after: mug(),
            before_is_probable: false,
            after_is_probable: false,
        },
        EventKind::Moved {
            track_id: 7,
            from_m: place(1).position_m,
            to_m: place(2).position_m,
        },
        EventKind::Vanished {
            track_id: 7,
            label: mug(),
            is_probable: false,
        },
    ];
    assert_eq!(kinds(&model, 0), expected);
    assert_eq!(model.objects().count(), 0);
}

#[test]
fn label_becomes_certain_once_and_is_found_when_it_is_only_probable() {
    let mut model = WorldModel::new(CONFIG);
    for (second, is_probable) in [(1, true), (2, true), (3, false), (4, true)] {
        let seen = Sighting {
            is_probable,
            ..sighting(&(7, 0, 1, 1), second * SECOND)
        };
        model.observe([seen], true, second * SECOND);
    }
    assert!(model.objects().all(|object| object.is_probable));
    let of_mugs = model.facts(&FactQuery {
        subject: None,
        label: Some("mug".to_owned()),
        region: None,
        window: None,
        before: None,
        n_most: 10,
    });
    let labels = of_mugs.facts.iter().rev();
    let labels: Vec<_> = labels
        .filter(|fact| fact.value.property() == Property::Label)
        .map(|fact| (fact.value.clone(), fact.start_ns / SECOND))
        .collect();
    let mug = || "mug".to_owned();
    let expected = [(Value::ProbableLabel(mug()), 1), (Value::Label(mug()), 3)];
    assert_eq!(labels, expected);
    // Doubt about a label that stays is no event.
    assert_eq!(kinds(&model, 0).len(), 1);
}

/// Level surface of a metre by a metre at a height.
fn surface(height_m: f32) -> (f64, [[f32; 3]; 4]) {
    let corner = |x, y| [x, y, height_m];
    let corners = [
        corner(0., 0.),
        corner(1., 0.),
        corner(1., 1.),
        corner(0., 1.),
    ];
    (-f64::from(height_m), corners)
}

/// Numbers of the level surfaces at some heights, seen in one scene.
fn see_surfaces(model: &mut WorldModel, heights_m: &[f32], now_ns: u64) -> Vec<Option<u64>> {
    let seen: Vec<_> = heights_m
        .iter()
        .map(|height_m| surface(*height_m))
        .collect();
    let sightings = seen.iter().map(|(offset_m, corners_m)| SurfaceSighting {
        kind: "table",
        plane: [0.0, 0.0, 1.0, *offset_m],
        corners_m,
    });
    let mut numbers = Vec::new();
    model.observe_surfaces(sightings, now_ns, &mut numbers);
    numbers
}

#[test]
fn surface_is_kept_after_a_second_and_a_moved_one_is_another() {
    let mut model = WorldModel::new(CONFIG);
    assert_eq!(see_surfaces(&mut model, &[0.7], SECOND), [None]);
    assert_eq!(see_surfaces(&mut model, &[0.71], SECOND + 1), [None]);
    assert_eq!(model.surfaces().count(), 0);
    assert_eq!(
        see_surfaces(&mut model, &[0.7, 1.1], 2 * SECOND),
        [Some(1), None]
    );
    // One that is seen once is forgotten.
    assert_eq!(see_surfaces(&mut model, &[0.7], 3 * SECOND), [Some(1)]);
    assert_eq!(see_surfaces(&mut model, &[1.1], 4 * SECOND), [None]);
    assert_eq!(see_surfaces(&mut model, &[1.1], 5 * SECOND), [Some(2)]);
    let states: Vec<_> = model
        .surfaces()
        .map(|one| (one.number, one.state()))
        .collect();
    assert_eq!(states, [(1, "unseen"), (2, "seen")]);
    see_surfaces(&mut model, &[1.1], 63 * SECOND);
    assert_eq!(
        model.surfaces().map(|one| one.number).collect::<Vec<_>>(),
        [2]
    );
    let facts = model.facts(&FactQuery {
        subject: Some(Subject::Surface(1)),
        label: None,
        region: None,
        window: None,
        before: None,
        n_most: 10,
    });
    let place = facts.facts.iter().find_map(|fact| match &fact.value {
        Value::Place(place) => Some((*place, fact.end_ns)),
        _ => None,
    });
    let (place, end_ns) = place.unwrap();
    assert_eq!(end_ns, Some(3 * SECOND));
    for (found, expected) in place.position_m.iter().zip([0.5, 0.5, 0.7]) {
        assert!((found - expected).abs() < 1e-6, "{place:?}");
    }
    for (found, expected) in place.size_m.iter().zip([1.0, 1.0, 0.0]) {
        assert!((found - expected).abs() < 1e-6, "{place:?}");
    }
}

#[test]
fn unchanged_observation_is_not_written() {
    let mut model = WorldModel::new(CONFIG);
    see(&mut model, &[(7, 0, 1, 1), (8, 0, 0, 2)], SECOND);
    model.observe_robot(&robot(false), SECOND);
    while !model.take_writes().is_empty() {}
    for second in 1..10 {
        see(&mut model, &[(7, 0, 1, 1), (8, 0, 0, 2)], second * SECOND);
        model.observe_robot(&robot(false), second * SECOND);
    }
    assert!(!model.has_changes());
    // Only when it was last seen, now and then.
    see(&mut model, &[(7, 0, 1, 1), (8, 0, 0, 2)], 11 * SECOND);
    assert_eq!(model.take_writes().len(), 2);
}

#[test]
fn action_end_is_one_event() {
    let mut model = WorldModel::new(CONFIG);
    let mut tell = |command_id, outcome| {
        let sighting = RobotSighting {
            outcome,
            command_id,
            ..robot(false)
        };
        let newest = model.newest_event();
        model.observe_robot(&sighting, SECOND);
        kinds(&model, newest)
    };
    let succeeded = Some(Outcome::Succeeded);
    assert_eq!(tell(3, succeeded), [], "it was over before");
    assert_eq!(tell(4, None), []);
    let ended = |command_id, outcome| {
        [EventKind::ActionEnded {
            command_id,
            outcome,
            note: String::new(),
        }]
    };
    assert_eq!(tell(4, succeeded), ended(4, Outcome::Succeeded));
    assert_eq!(tell(4, succeeded), []);
    // Too short to be seen at work.
    assert_eq!(tell(5, Some(Outcome::Failed)), ended(5, Outcome::Failed));
}

#[test]
fn teaching_is_one_event() {
    let mut model = WorldModel::new(CONFIG);
    let learned = |history| Lesson {
        kind: LessonKind::Taught,
        category: "mug".to_owned(),
        track_id: Some(7),
        author: "anna".to_owned(),
        history,
    };
    for history in [1, 1, 2, 1] {
        model.record_teaching(learned(history), SECOND);
    }
    assert_eq!(
        kinds(&model, 0),
        [1, 2].map(|history| EventKind::Lesson(learned(history)))
    );
}

#[test]
fn oversized_texts_and_too_many_tasks_are_refused() {
    let mut model = WorldModel::new(CONFIG);
    let new = |id: u128, kind: &str, parameters: usize| NewTask {
        id: MutationId(id),
        kind: kind.to_owned(),
        parameters: "x".repeat(parameters),
        author: "anna".to_owned(),
    };
    for wrong in [new(1, "", 0), new(1, &"k".repeat(65), 0), new(1, "k", 2049)] {
        let refusal = model.start_task(&wrong, SECOND).unwrap_err();
        assert!(matches!(refusal, TaskRefusal::Text { .. }), "{refusal}");
    }
    let started = (0..1001).map(|id| model.start_task(&new(id, "k", 0), SECOND).is_ok());
    assert_eq!(started.filter(|started| *started).count(), 1000);
    assert_eq!(model.tasks_before(u64::MAX).count(), 1000);
}
