//! The world model: everything that is known, and how it changes.

use std::collections::{BTreeMap, BTreeSet};

use super::event::{Event, Happening, Learned};
use super::event_log::EventLog;
use super::expiry::Expiry;
use super::fact::{Property, Subject};
use super::fact_table::FactTable;
use super::keys::Entry;
use super::object::Object;
use super::query::{self, FactPage, FactQuery};
use super::robot::Robot;
use super::task::{Task, TaskState};
use super::task_table::TaskTable;
use super::touched::Touched;
use super::world_config::WorldConfig;

/// Events that an earlier process may have told and not written any more: their
/// sequences are not given again, for somebody may wait for what comes after them.
const UNWRITTEN_EVENTS: u64 = 1000;
/// Most things that are forgotten in one step.
const FORGOTTEN_AT_ONCE: usize = 256;

/// What is and was known of the world. All times are the wall clock's, nanoseconds
/// since 1970, and arguments; when that clock steps back, nothing ends before it
/// began.
///
/// What is unchanged costs no allocation.
#[derive(Debug)]
pub struct WorldModel {
    pub(super) config: WorldConfig,
    pub(super) facts: FactTable,
    pub(super) events: EventLog,
    pub(super) tasks: TaskTable,
    pub(super) objects: BTreeMap<u64, Object>,
    pub(super) robot: Option<Robot>,
    pub(super) touched: Touched,
    /// Those of the objects that are there.
    pub(super) present: BTreeSet<u64>,
    pub(super) gone: Expiry,
    pub(super) n_scenes: u64,
}

impl WorldModel {
    /// A model that knows nothing.
    pub fn new(config: WorldConfig) -> Self {
        Self {
            config,
            facts: FactTable::default(),
            events: EventLog::default(),
            tasks: TaskTable::default(),
            objects: BTreeMap::new(),
            robot: None,
            touched: Touched::default(),
            present: BTreeSet::new(),
            gone: Expiry::default(),
            n_scenes: 0,
        }
    }

    /// Notes that somebody taught, corrected or forgot, once for each entry of the
    /// perceptual memory's history.
    pub fn note_lesson(&mut self, learned: Learned, now_ns: u64) {
        let is_this = |event: &Event| match &event.happening {
            Happening::Learned(known) => known.history == learned.history,
            _ => false,
        };
        if !self.events.all().rev().any(is_this) {
            let learned = Happening::Learned(learned);
            self.events.add(learned, now_ns, &mut self.touched);
        }
    }

    /// Forgets some of what has been over for too long, or is too much; whether
    /// there may be more to forget.
    pub fn expire(&mut self, now_ns: u64) -> bool {
        (0..FORGOTTEN_AT_ONCE).all(|_| self.forget_one(now_ns))
    }

    fn forget_one(&mut self, now_ns: u64) -> bool {
        let (config, touched) = (&self.config, &mut self.touched);
        let (keep_ns, n_most) = (config.keep_ns, config.n_kept_most);
        if let Some(track_id) = self.gone.take(now_ns, keep_ns, n_most) {
            self.objects.remove(&track_id);
            touched.add(Entry::Object(track_id));
            return true;
        }
        self.facts.expire(now_ns, config, touched)
            || self.tasks.expire(now_ns, config, touched)
            || self.events.expire(now_ns, keep_ns, n_most, touched)
    }

    /// The objects that are there, by track-id.
    pub fn objects(&self) -> impl Iterator<Item = &Object> {
        self.present.iter().map(|track_id| &self.objects[track_id])
    }

    /// Since when what is known now holds of a subject's property, nanoseconds.
    pub fn since_ns(&self, subject: Subject, property: Property) -> Option<u64> {
        query::since_ns(&self.facts, subject, property)
    }

    /// The robot, unless it was never heard of.
    pub fn robot(&self) -> Option<&Robot> {
        self.robot.as_ref()
    }

    /// A page of facts, newest first.
    pub fn facts(&self, query: &FactQuery) -> FactPage {
        query::facts(&self.facts, query)
    }

    /// The events after one, oldest first; all that are known for zero.
    pub fn events_since(&self, sequence: u64) -> impl DoubleEndedIterator<Item = &Event> {
        self.events.since(sequence)
    }

    /// Sequence of the newest event; zero before the first.
    pub fn newest_event(&self) -> u64 {
        self.events.newest
    }

    /// The tasks with a number below `before`, newest first.
    pub fn tasks_before(&self, before: u64) -> impl Iterator<Item = &Task> {
        self.tasks.before(before)
    }

    /// Grows with each change.
    pub fn version(&self) -> u64 {
        self.touched.version()
    }

    /// Whether something is not on its way to the disk yet.
    pub fn has_changes(&self) -> bool {
        !self.touched.is_empty()
    }

    /// Has what is seen all the time written as it is now: before the end.
    pub(super) fn note_all_seen(&mut self) {
        for track_id in &self.present {
            self.touched.add(Entry::Object(*track_id));
        }
        if self.robot.is_some() {
            self.touched.add(Entry::Robot);
        }
    }

    /// Ends what an earlier process held to be true when that was last seen, and
    /// begins anew. Tasks go on: they belong to who runs them.
    pub(super) fn begin_session(&mut self, now_ns: u64) {
        let left: Vec<u64> = self.present.iter().copied().collect();
        for track_id in left {
            self.part_with(track_id, self.objects[&track_id].last_seen_ns);
        }
        self.lose_robot();
        let open: Vec<_> = self.facts.open().collect();
        for (subject, property) in open {
            let is_task = |task| self.tasks.get(task).is_some_and(is_running);
            if !matches!(subject, Subject::Task(task) if is_task(task)) {
                // Its object or task was not written any more: it ends as it began.
                self.facts.cease(subject, property, 0, &mut self.touched);
            }
        }
        if self.events.newest > 0 {
            self.events.newest += UNWRITTEN_EVENTS;
        }
        self.events
            .add(Happening::Started, now_ns, &mut self.touched);
    }

    /// Takes in an object that is read.
    pub(super) fn insert_object(&mut self, mut object: Object) {
        object.noted_seen_ns = object.last_seen_ns;
        match object.gone_ns {
            Some(gone_ns) => self.gone.insert(gone_ns, object.track_id),
            None => {
                self.present.insert(object.track_id);
            }
        }
        self.objects.insert(object.track_id, object);
    }
}

fn is_running(task: &Task) -> bool {
    task.state == TaskState::Running
}
