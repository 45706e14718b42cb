//! Scene update: effects of an observed scene on objects, facts and events.

use crate::event::EventKind;
use crate::fact::{Property, Subject, Value, ValueRef};
use crate::object::{ObjectRecord, Sighting};
use crate::record_key::RecordKey;
use crate::world_model::WorldModel;

/// Minimum rest time of an object before its motion is an event, nanoseconds. Chosen.
const RESTED_NS: u64 = 1_000_000_000;

impl WorldModel {
    /// Updates the model from one scene. If it `is_whole`, objects that are not in it have
    /// disappeared.
    pub fn observe<'a>(
        &mut self,
        sightings: impl IntoIterator<Item = Sighting<'a>>,
        is_whole: bool,
        now_ns: u64,
    ) {
        self.n_scenes += 1;
        for sighting in sightings {
            self.observe_object(&sighting, now_ns);
        }
        if is_whole {
            self.end_missing_objects(now_ns);
        }
    }

    fn observe_object(&mut self, sighting: &Sighting<'_>, now_ns: u64) {
        let track_id = sighting.track_id;
        let has_changed = match self.objects.get(&track_id) {
            None => {
                self.start_object(sighting, now_ns);
                true
            }
            Some(_) => self.record_changes(sighting, now_ns),
        };
        let (subject, config) = (Subject::Object(track_id), &self.config);
        let (facts, dirty) = (&mut self.facts, &mut self.dirty);
        facts.assert_fact(
            subject,
            ValueRef::State(sighting.state),
            now_ns,
            config,
            dirty,
        );
        match sighting.label {
            Some(label) => {
                let label = if sighting.is_probable {
                    ValueRef::ProbableLabel(label)
                } else {
                    ValueRef::Label(label)
                };
                facts.assert_fact(subject, label, now_ns, config, dirty);
            }
            None => facts.retract(subject, Property::Label, now_ns, dirty),
        }
        facts.assert_fact(
            subject,
            ValueRef::Place(&sighting.place),
            now_ns,
            config,
            dirty,
        );
        if let Some(object) = self.objects.get_mut(&track_id) {
            object.update(sighting);
            object.scene = self.n_scenes;
            if let Some(gone_ns) = object.gone_ns.take() {
                self.gone.remove(gone_ns, track_id);
                self.present.insert(track_id);
            }
            let unwritten_ns = object.last_seen_ns.abs_diff(object.noted_seen_ns);
            if has_changed || unwritten_ns >= self.config.seen_period_ns {
                object.noted_seen_ns = object.last_seen_ns;
                dirty.add(RecordKey::Object(track_id));
            }
        }
    }

    fn start_object(&mut self, sighting: &Sighting<'_>, now_ns: u64) {
        let track_id = sighting.track_id;
        self.present.insert(track_id);
        self.objects.insert(track_id, ObjectRecord::new(sighting));
        let appeared = EventKind::Appeared {
            track_id,
            label: sighting.label.map(str::to_owned),
            is_probable: sighting.is_probable,
            position_m: sighting.place.position_m,
        };
        self.events.add(appeared, now_ns, &mut self.dirty);
    }

    /// Records label change and motion of a known object; `true` if its record has to be written.
    fn record_changes(&mut self, sighting: &Sighting<'_>, now_ns: u64) -> bool {
        let track_id = sighting.track_id;
        let Some(object) = self.objects.get(&track_id) else {
            return false;
        };
        let is_other = object.gone_ns.is_some() || object.state != sighting.state;
        let is_relabelled = object.label.as_deref() != sighting.label;
        if is_relabelled {
            let relabelled = EventKind::Relabelled {
                track_id,
                before: object.label.clone(),
                after: sighting.label.map(str::to_owned),
                before_is_probable: object.is_probable,
                after_is_probable: sighting.is_probable,
            };
            self.events.add(relabelled, now_ns, &mut self.dirty);
        }
        let has_moved = self.record_motion(sighting, now_ns);
        is_other || is_relabelled || has_moved
    }

    fn record_motion(&mut self, sighting: &Sighting<'_>, now_ns: u64) -> bool {
        let subject = Subject::Object(sighting.track_id);
        let known = self.facts.holding(subject, Property::Place);
        let Some((Value::Place(place), start_ns)) = known.map(|fact| (&fact.value, fact.start_ns))
        else {
            return false;
        };
        let has_moved = sighting.place.has_moved_from(place, &self.config);
        if has_moved && now_ns.saturating_sub(start_ns) >= RESTED_NS {
            let moved = EventKind::Moved {
                track_id: sighting.track_id,
                from_m: place.position_m,
                to_m: sighting.place.position_m,
            };
            self.events.add(moved, now_ns, &mut self.dirty);
        }
        has_moved
    }

    fn end_missing_objects(&mut self, now_ns: u64) {
        let is_missed = |track: &u64| self.objects[track].scene != self.n_scenes;
        let missed: Vec<u64> = self.present.iter().copied().filter(is_missed).collect();
        for track_id in missed {
            let object = &self.objects[&track_id];
            let vanished = EventKind::Vanished {
                track_id,
                label: object.label.clone(),
                is_probable: object.is_probable,
            };
            self.events.add(vanished, now_ns, &mut self.dirty);
            self.end_object(track_id, now_ns);
        }
    }

    /// Ends an object and all facts about it.
    pub(crate) fn end_object(&mut self, track_id: u64, end_ns: u64) {
        for property in [Property::State, Property::Label, Property::Place] {
            let subject = Subject::Object(track_id);
            self.facts
                .retract(subject, property, end_ns, &mut self.dirty);
        }
        self.present.remove(&track_id);
        if let Some(object) = self.objects.get_mut(&track_id) {
            object.gone_ns = Some(end_ns);
            self.gone.insert(end_ns, track_id);
            self.dirty.add(RecordKey::Object(track_id));
        }
    }
}
