//! World model: objects, surfaces, robot, facts, events and tasks, with their updates.

use std::collections::{BTreeMap, BTreeSet};

use crate::dirty_set::DirtySet;
use crate::event::{Event, EventKind, Lesson};
use crate::event_log::EventLog;
use crate::expiry_queue::ExpiryQueue;
use crate::fact::{Property, Subject};
use crate::fact_table::FactTable;
use crate::object::ObjectRecord;
use crate::query::{self, FactPage, FactQuery};
use crate::record_key::RecordKey;
use crate::robot::Robot;
use crate::surface::SurfaceRecord;
use crate::task::{Task, TaskState};
use crate::task_table::TaskTable;
use crate::world_config::WorldConfig;

/// Gap in the event sequence at a start. An earlier process may have sent events that it did not
/// write, and clients may wait for later sequence numbers. Chosen.
const UNWRITTEN_EVENTS: u64 = 1000;
/// Maximum number of expired items removed in one step. Chosen.
const FORGOTTEN_AT_ONCE: usize = 256;

/// Present and past state of the world. All times are wall-clock times, nanoseconds since 1970,
/// passed as arguments. Nothing ends before it began, even if the clock steps back.
///
/// An unchanged observation does not allocate.
#[derive(Debug)]
pub struct WorldModel {
    pub(crate) config: WorldConfig,
    pub(crate) facts: FactTable,
    pub(crate) events: EventLog,
    pub(crate) tasks: TaskTable,
    pub(crate) objects: BTreeMap<u64, ObjectRecord>,
    pub(crate) robot: Option<Robot>,
    pub(crate) dirty: DirtySet,
    /// Track-ids of the present objects.
    pub(crate) present: BTreeSet<u64>,
    pub(crate) gone: ExpiryQueue,
    /// Support surfaces of the present, also those that are not kept yet.
    pub(crate) surfaces: Vec<SurfaceRecord>,
    /// Number of the newest kept surface; zero before the first.
    pub(crate) newest_surface: u64,
    pub(crate) n_scenes: u64,
}

impl WorldModel {
    /// Empty world model.
    pub fn new(config: WorldConfig) -> Self {
        Self {
            config,
            facts: FactTable::default(),
            events: EventLog::default(),
            tasks: TaskTable::default(),
            objects: BTreeMap::new(),
            robot: None,
            dirty: DirtySet::default(),
            present: BTreeSet::new(),
            gone: ExpiryQueue::default(),
            surfaces: Vec::new(),
            newest_surface: 0,
            n_scenes: 0,
        }
    }

    /// Replaces the configuration, from the next observation on.
    pub fn set_config(&mut self, config: WorldConfig) {
        self.config = config;
    }

    /// Records a teaching event, once per history entry of the perceptual memory.
    pub fn record_teaching(&mut self, learned: Lesson, now_ns: u64) {
        let is_this = |event: &Event| match &event.kind {
            EventKind::Lesson(known) => known.history == learned.history,
            _ => false,
        };
        if !self.events.all().rev().any(is_this) {
            let learned = EventKind::Lesson(learned);
            self.events.add(learned, now_ns, &mut self.dirty);
        }
    }

    /// Records a question to a person about an object.
    pub fn record_question(
        &mut self,
        track_id: u64,
        category: Option<String>,
        sentence: String,
        now_ns: u64,
    ) {
        let question = EventKind::Question {
            track_id,
            category,
            sentence,
        };
        self.events.add(question, now_ns, &mut self.dirty);
    }

    /// Removes some expired items; `true` if there may be more.
    pub fn expire(&mut self, now_ns: u64) -> bool {
        (0..FORGOTTEN_AT_ONCE).all(|_| self.forget_one(now_ns))
    }

    fn forget_one(&mut self, now_ns: u64) -> bool {
        let (config, dirty) = (&self.config, &mut self.dirty);
        let (keep_ns, n_most) = (config.keep_ns, config.n_kept_most);
        if let Some(track_id) = self.gone.take(now_ns, keep_ns, n_most) {
            self.objects.remove(&track_id);
            dirty.add(RecordKey::Object(track_id));
            return true;
        }
        self.facts.expire(now_ns, config, dirty)
            || self.tasks.expire(now_ns, config, dirty)
            || self.events.expire(now_ns, keep_ns, n_most, dirty)
    }

    /// Present objects, ordered by track-id.
    pub fn objects(&self) -> impl Iterator<Item = &ObjectRecord> {
        self.present.iter().map(|track_id| &self.objects[track_id])
    }

    /// Objects that are gone, ordered by track-id.
    pub fn past_objects(&self) -> impl Iterator<Item = &ObjectRecord> {
        let all = self.objects.values();
        all.filter(|object| object.gone_ns.is_some())
    }

    /// Start of the current fact about a property of a subject, nanoseconds since 1970.
    pub fn since_ns(&self, subject: Subject, property: Property) -> Option<u64> {
        query::since_ns(&self.facts, subject, property)
    }

    /// Robot of the world model; `None` before its first report.
    pub fn robot(&self) -> Option<&Robot> {
        self.robot.as_ref()
    }

    /// Page of facts that match a query, newest first.
    pub fn facts(&self, query: &FactQuery) -> FactPage {
        query::facts(&self.facts, query)
    }

    /// Events after a sequence number, oldest first; all for zero.
    pub fn events_since(&self, sequence: u64) -> impl DoubleEndedIterator<Item = &Event> {
        self.events.since(sequence)
    }

    /// Sequence number of the newest event; zero before the first.
    pub fn newest_event(&self) -> u64 {
        self.events.newest
    }

    /// Tasks with a number below `before`, newest first.
    pub fn tasks_before(&self, before: u64) -> impl Iterator<Item = &Task> {
        self.tasks.before(before)
    }

    /// Task with this number; `None` if it was never started or is forgotten.
    pub fn task(&self, number: u64) -> Option<&Task> {
        self.tasks.get(number)
    }

    /// Version of the model, incremented by each change.
    pub fn version(&self) -> u64 {
        self.dirty.version()
    }

    /// `true` if changes wait to be written.
    pub fn has_changes(&self) -> bool {
        !self.dirty.is_empty()
    }

    /// Marks present objects, surfaces and the robot as dirty, so that their last-seen times are
    /// written before the end.
    pub(crate) fn mark_present_dirty(&mut self) {
        for track_id in &self.present {
            self.dirty.add(RecordKey::Object(*track_id));
        }
        for surface in self.surfaces.iter().filter(|surface| surface.is_kept()) {
            self.dirty.add(RecordKey::Surface(surface.number));
        }
        if self.robot.is_some() {
            self.dirty.add(RecordKey::Robot);
        }
    }

    /// Starts a session: ends the facts of the earlier process at the last observation of their
    /// subject. Tasks continue, since they belong to their clients.
    pub(crate) fn begin_session(&mut self, now_ns: u64) {
        let left: Vec<u64> = self.present.iter().copied().collect();
        for track_id in left {
            self.end_object(track_id, self.objects[&track_id].last_seen_ns);
        }
        for index in (0..self.surfaces.len()).rev() {
            self.end_surface(index);
        }
        self.lose_robot();
        let open: Vec<_> = self.facts.open().collect();
        for (subject, property) in open {
            let is_task = |task| self.tasks.get(task).is_some_and(is_running);
            if !matches!(subject, Subject::Task(task) if is_task(task)) {
                // The object, surface or task was not written in time: the fact ends at its start.
                self.facts.retract(subject, property, 0, &mut self.dirty);
            }
        }
        if self.events.newest > 0 {
            self.events.newest += UNWRITTEN_EVENTS;
        }
        self.events.add(EventKind::Started, now_ns, &mut self.dirty);
    }

    /// Inserts an object read from disk.
    pub(crate) fn insert_object(&mut self, mut object: ObjectRecord) {
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
