//! What is done to both stores, step by step, and what of it is timed.

use std::ops::Range;

/// Views of a track that is taught.
pub const VIEWS_PER_TRACK: u32 = 3;
/// Tracks whose views are stored by one step before anything is timed.
pub const TRACKS_PER_STEP: usize = 340;
/// Bytes of the cloud that comes with a view.
pub const CLOUD_BYTES: usize = 60_000;
/// Callers that store views while another one teaches.
const BUSY_CALLERS: usize = 8;

/// One change to the store.
pub enum Step {
    /// The views of some tracks, without clouds.
    StoreTracks(Range<u64>),
    /// A name for a track.
    Teach(u64),
    /// One view with its cloud.
    StoreView { track_id: u64, view_id: u32 },
}

/// The steps: first the tracks to teach are stored, then come the teachings, then
/// the views with clouds.
pub struct Plan {
    n_tracks: usize,
    n_views: usize,
    pub scenarios: Vec<Scenario>,
}

/// Something to be timed.
#[derive(Clone)]
pub struct Scenario {
    pub name: String,
    pub steps: Range<usize>,
    pub n_callers: usize,
    pub beside: Beside,
}

/// What the store is busy with meanwhile.
#[derive(Clone)]
pub enum Beside {
    Nothing,
    /// These steps, from so many callers; what is timed ends with them.
    Views(Range<usize>, usize),
    /// A compaction of everything; what is timed ends with it.
    Compaction,
}

impl Plan {
    /// A plan with `share` of all counts.
    pub fn new(share: f64) -> Self {
        let count = |n: usize| (n as f64 * share) as usize;
        let teachings = [(1, count(400)), (8, count(1_600)), (64, count(6_400))];
        let n_beside = count(1_000);
        let views = [(1, count(200)), (8, count(600)), (64, count(1_200))];
        let n_views_beside = count(800);
        let n_tracks = teachings.iter().map(|(_, n)| n).sum::<usize>() + 2 * n_beside;
        let n_views = views.iter().map(|(_, n)| n).sum::<usize>() + n_views_beside;

        let mut plan = Self {
            n_tracks,
            n_views,
            scenarios: Vec::new(),
        };
        let (mut teaching, mut view) = (plan.prefill().end, plan.prefill().end + n_tracks);
        for (n_callers, n) in teachings {
            let name = format!("teach, {n_callers} callers");
            plan.time(name, take(&mut teaching, n), n_callers, Beside::Nothing);
        }
        for (n_callers, n) in views {
            let name = format!("store a view, {n_callers} callers");
            plan.time(name, take(&mut view, n), n_callers, Beside::Nothing);
        }
        let beside = Beside::Views(take(&mut view, n_views_beside), BUSY_CALLERS);
        let name = format!("teach while {BUSY_CALLERS} store views");
        plan.time(name, take(&mut teaching, n_beside), 1, beside);
        let name = "teach while all is compacted".to_owned();
        plan.time(name, take(&mut teaching, n_beside), 1, Beside::Compaction);
        plan
    }

    fn time(&mut self, name: String, steps: Range<usize>, n_callers: usize, beside: Beside) {
        self.scenarios.push(Scenario {
            name,
            steps,
            n_callers,
            beside,
        });
    }

    pub fn n_steps(&self) -> usize {
        self.prefill().end + self.n_tracks + self.n_views
    }

    /// The steps to be made before anything is timed.
    pub fn prefill(&self) -> Range<usize> {
        0..self.n_tracks.div_ceil(TRACKS_PER_STEP)
    }

    pub fn step(&self, index: usize) -> Step {
        let n_prefill = self.prefill().end;
        if index < n_prefill {
            let first = index * TRACKS_PER_STEP;
            let end = (first + TRACKS_PER_STEP).min(self.n_tracks);
            return Step::StoreTracks(first as u64 + 1..end as u64 + 1);
        }
        let n = index - n_prefill;
        if n < self.n_tracks {
            return Step::Teach(n as u64 + 1);
        }
        Step::StoreView {
            track_id: (self.n_tracks + 1 + n / 10) as u64,
            view_id: (n % 10) as u32,
        }
    }
}

impl Scenario {
    /// The same with the first `share` of its steps.
    pub fn shortened(&self, share: f64) -> Self {
        let Range { start, .. } = self.steps;
        let n_steps = (self.steps.len() as f64 * share) as usize;
        Self {
            steps: start..start + n_steps,
            ..self.clone()
        }
    }
}

fn take(next: &mut usize, n: usize) -> Range<usize> {
    let first = *next;
    *next += n;
    first..*next
}
