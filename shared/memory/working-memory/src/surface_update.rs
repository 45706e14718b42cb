//! Surface update: effects of the support surfaces of a scene on records and facts.

use crate::fact::{Property, Subject, ValueRef};
use crate::record_key::RecordKey;
use crate::surface::{SurfaceRecord, SurfaceSighting};
use crate::world_model::WorldModel;

/// Time for which a surface is seen before the model keeps it, nanoseconds. Chosen.
const KEPT_AFTER_NS: u64 = 1_000_000_000;
/// Time after which a surface that is not seen has ended, nanoseconds: that of an object out of
/// view. Chosen.
const ENDS_AFTER_NS: u64 = 60_000_000_000;

impl SurfaceRecord {
    /// State of the surface, as a word: `seen` when the newest scene shows it, or `unseen`.
    pub fn state(&self) -> &'static str {
        if self.is_seen { "seen" } else { "unseen" }
    }

    /// True if it was seen for long enough to have a number.
    pub(crate) fn is_kept(&self) -> bool {
        self.number > 0
    }
}

impl WorldModel {
    /// Updates the surfaces from one scene. `numbers` gets the number of each, `None` before it is
    /// kept.
    pub fn observe_surfaces<'a>(
        &mut self,
        sightings: impl IntoIterator<Item = SurfaceSighting<'a>>,
        now_ns: u64,
        numbers: &mut Vec<Option<u64>>,
    ) {
        for surface in &mut self.surfaces {
            surface.is_seen = false;
        }
        numbers.clear();
        for sighting in sightings {
            numbers.push(self.observe_surface(&sighting, now_ns));
        }
        for index in (0..self.surfaces.len()).rev() {
            let surface = &self.surfaces[index];
            let unseen_ns = now_ns.saturating_sub(surface.last_seen_ns);
            if !surface.is_kept() {
                if !surface.is_seen {
                    self.surfaces.remove(index);
                }
            } else if unseen_ns >= ENDS_AFTER_NS {
                self.end_surface(index);
            } else {
                self.record_surface(index, now_ns);
            }
        }
    }

    /// Number of the surface of an observation; a surface that was moved is another one.
    fn observe_surface(&mut self, sighting: &SurfaceSighting<'_>, now_ns: u64) -> Option<u64> {
        let known = self.surfaces.iter().enumerate();
        let known = known.filter(|(_, known)| !known.is_seen);
        let near = known.filter_map(|(index, known)| Some((known.distance_m(sighting)?, index)));
        let Some((_, index)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            self.surfaces.push(SurfaceRecord::new(sighting, now_ns));
            return None;
        };
        let surface = &mut self.surfaces[index];
        surface.update(sighting, now_ns);
        if !surface.is_kept() && now_ns.saturating_sub(surface.first_seen_ns) >= KEPT_AFTER_NS {
            self.newest_surface += 1;
            surface.number = self.newest_surface;
            let (subject, place) = (Subject::Surface(surface.number), sighting.place());
            let (value, config, dirty) = (ValueRef::Place(&place), &self.config, &mut self.dirty);
            dirty.add(RecordKey::Meta);
            self.facts
                .assert_fact(subject, value, now_ns, config, dirty);
        }
        let surface = &self.surfaces[index];
        surface.is_kept().then_some(surface.number)
    }

    /// Asserts the state of a kept surface, and marks its record when it has to be written.
    fn record_surface(&mut self, index: usize, now_ns: u64) {
        let surface = &mut self.surfaces[index];
        let (config, dirty) = (&self.config, &mut self.dirty);
        let unwritten_ns = surface.last_seen_ns.abs_diff(surface.noted_seen_ns);
        if surface.noted_seen_ns == 0 || unwritten_ns >= config.seen_period_ns {
            surface.noted_seen_ns = surface.last_seen_ns;
            dirty.add(RecordKey::Surface(surface.number));
        }
        let subject = Subject::Surface(surface.number);
        let state = ValueRef::State(surface.state());
        self.facts
            .assert_fact(subject, state, now_ns, config, dirty);
    }

    /// Ends a surface and all facts about it, when it was seen last.
    pub(crate) fn end_surface(&mut self, index: usize) {
        let surface = self.surfaces.remove(index);
        let subject = Subject::Surface(surface.number);
        for property in [Property::State, Property::Place] {
            let end_ns = surface.last_seen_ns;
            self.facts
                .retract(subject, property, end_ns, &mut self.dirty);
        }
        self.dirty.add(RecordKey::Surface(surface.number));
    }

    /// Support surfaces of the present, in the order of their first observation.
    pub fn surfaces(&self) -> impl Iterator<Item = &SurfaceRecord> {
        self.surfaces.iter().filter(|surface| surface.is_kept())
    }

    /// Kept surface with this number.
    pub(crate) fn surface(&self, number: u64) -> Option<&SurfaceRecord> {
        self.surfaces().find(|surface| surface.number == number)
    }
}
