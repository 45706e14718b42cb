//! Benchmark workload: the mutations made to both stores, and the scenarios that are timed.

use std::ops::Range;

/// Views per taught track.
pub const VIEWS_PER_TRACK: u32 = 3;
/// Tracks stored by one step of the prefill.
pub const TRACKS_PER_STEP: usize = 340;
/// Size of the point cloud of a view, bytes.
pub const CLOUD_BYTES: usize = 60_000;
/// Number of callers of the background load that stores views.
const BACKGROUND_CALLERS: usize = 8;

/// One mutation of the store.
pub enum WorkloadStep {
    /// Stores the views of a range of tracks, without clouds.
    StoreTracks(Range<u64>),
    /// Labels a track.
    Teach(u64),
    /// Step that stores one view with its cloud.
    StoreView { track_id: u64, view_id: u32 },
}

/// Sequence of steps: the prefill of tracks, their labelling, then the views with clouds.
pub struct Workload {
    n_tracks: usize,
    n_views: usize,
    /// Scenarios, in the order in which they run.
    pub scenarios: Vec<Scenario>,
}

/// Timed scenario: a range of steps, its callers and its background load.
#[derive(Clone)]
pub struct Scenario {
    /// Name in the report.
    pub name: String,
    /// Indices of the timed steps.
    pub steps: Range<usize>,
    /// Number of concurrent callers.
    pub n_callers: usize,
    /// Concurrent load that is not timed.
    pub background: BackgroundLoad,
}

/// Background load during a scenario.
#[derive(Clone)]
pub enum BackgroundLoad {
    /// No background load.
    Nothing,
    /// Steps that store views, and the number of their callers; the scenario ends with them.
    Views(Range<usize>, usize),
    /// Full compaction; the scenario ends with it.
    Compaction,
}

impl Workload {
    /// Workload with a `share` (0 to 1) of all counts.
    pub fn new(share: f64) -> Self {
        let count = |n: usize| (n as f64 * share) as usize;
        let teachings = [(1, count(400)), (8, count(1_600)), (64, count(6_400))];
        let n_teachings_under_load = count(1_000);
        let views = [(1, count(200)), (8, count(600)), (64, count(1_200))];
        let n_background_views = count(800);
        let n_tracks = teachings.iter().map(|(_, n)| n).sum::<usize>() + 2 * n_teachings_under_load;
        let n_views = views.iter().map(|(_, n)| n).sum::<usize>() + n_background_views;

        let mut workload = Self {
            n_tracks,
            n_views,
            scenarios: Vec::new(),
        };
        let (mut teaching, mut view) = (workload.prefill().end, workload.prefill().end + n_tracks);
        for (n_callers, n) in teachings {
            let name = format!("teach, {n_callers} callers");
            workload.add_scenario(
                name,
                take(&mut teaching, n),
                n_callers,
                BackgroundLoad::Nothing,
            );
        }
        for (n_callers, n) in views {
            let name = format!("store a view, {n_callers} callers");
            workload.add_scenario(name, take(&mut view, n), n_callers, BackgroundLoad::Nothing);
        }
        let background =
            BackgroundLoad::Views(take(&mut view, n_background_views), BACKGROUND_CALLERS);
        let name = format!("teach while {BACKGROUND_CALLERS} store views");
        workload.add_scenario(
            name,
            take(&mut teaching, n_teachings_under_load),
            1,
            background,
        );
        let name = "teach while all is compacted".to_owned();
        workload.add_scenario(
            name,
            take(&mut teaching, n_teachings_under_load),
            1,
            BackgroundLoad::Compaction,
        );
        workload
    }

    /// Adds a timed scenario.
    fn add_scenario(
        &mut self,
        name: String,
        steps: Range<usize>,
        n_callers: usize,
        background: BackgroundLoad,
    ) {
        self.scenarios.push(Scenario {
            name,
            steps,
            n_callers,
            background,
        });
    }

    /// Number of steps.
    pub fn n_steps(&self) -> usize {
        self.prefill().end + self.n_tracks + self.n_views
    }

    /// Untimed steps that precede all scenarios.
    pub fn prefill(&self) -> Range<usize> {
        0..self.n_tracks.div_ceil(TRACKS_PER_STEP)
    }

    /// Step of an index.
    pub fn step(&self, index: usize) -> WorkloadStep {
        let n_prefill = self.prefill().end;
        if index < n_prefill {
            let first = index * TRACKS_PER_STEP;
            let end = (first + TRACKS_PER_STEP).min(self.n_tracks);
            return WorkloadStep::StoreTracks(first as u64 + 1..end as u64 + 1);
        }
        let n = index - n_prefill;
        if n < self.n_tracks {
            return WorkloadStep::Teach(n as u64 + 1);
        }
        WorkloadStep::StoreView {
            track_id: (self.n_tracks + 1 + n / 10) as u64,
            view_id: (n % 10) as u32,
        }
    }
}

impl Scenario {
    /// Scenario limited to the first `share` (0 to 1) of its steps.
    pub fn truncated(&self, share: f64) -> Self {
        let Range { start, .. } = self.steps;
        let n_steps = (self.steps.len() as f64 * share) as usize;
        Self {
            steps: start..start + n_steps,
            ..self.clone()
        }
    }
}

/// Range of the next `n` indices; advances `next`.
fn take(next: &mut usize, n: usize) -> Range<usize> {
    let first = *next;
    *next += n;
    first..*next
}
