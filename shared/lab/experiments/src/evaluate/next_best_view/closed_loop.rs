//! Closed loop: views are chosen one after the other until the objects are found.

use super::bin_scene::BinScene;
use super::captured_view::{CapturedView, MEASURED_SPACING_M};
use super::findable_objects::findable;
use super::loop_method::Method;
use super::object_hypotheses::{HypothesisNoise, ObjectHypotheses};
use super::object_registration::RegisteredModel;
use nalgebra::Vector3;
use next_best_view::{
    CandidateState, CandidateViews, Config, OccupancyGrid, PlanningScene, SurfaceModel,
    ViewPlanner, ViewScore, ViewSelection, choose_view,
};
use random::Random;
use service::Failure;

/// Share of the objects at which a loop ends (Kasaei et al. 2018 have no closed loop).
const FOUND_SHARE: f64 = 0.95;
/// Number of views after which a loop gives up. Chosen.
pub(super) const N_VIEWS_MAX: usize = 30;
/// Side of the voxels of the occupancy, metres. Chosen.
const VOXEL_M: f64 = 0.02;

/// Course of a loop: after each view, the share of the objects found and the way travelled.
#[derive(Debug, Clone, Default)]
pub(super) struct LoopCourse {
    pub(super) found_shares: Vec<f64>,
    pub(super) travel_m: Vec<f64>,
    /// Indices of the views.
    pub(super) views: Vec<usize>,
    /// `true` if the objects were found before the loop gave up.
    pub(super) is_complete: bool,
}

/// Scene of a loop with its captured views.
#[derive(Clone, Copy)]
pub(super) struct LoopScene<'a> {
    pub(super) scene: &'a BinScene,
    pub(super) views: &'a [CapturedView],
    pub(super) config: &'a Config,
    /// Seed of the noise of hypotheses and of draws.
    pub(super) seed: u64,
}

/// State of a running loop.
struct LoopState {
    visited: Vec<usize>,
    is_found: Vec<bool>,
    /// Model of each object that lies on a segment of a visited view with the least contradiction.
    models: Vec<Option<RegisteredModel>>,
    travel_m: f64,
    /// Measured points of all visited views, world frame.
    measured: Vec<[f32; 3]>,
    occupancy: Option<OccupancyGrid>,
    random: Random,
}

/// Runs a loop from a first view.
pub(super) fn run(
    loop_scene: &LoopScene<'_>,
    method: Method,
    start: usize,
    planner: &mut ViewPlanner,
) -> Result<LoopCourse, Failure> {
    let LoopScene { scene, views, .. } = loop_scene;
    let is_findable = findable(views);
    let n_findable = is_findable
        .iter()
        .filter(|&&is_findable| is_findable)
        .count();
    let n_wanted = (FOUND_SHARE * n_findable as f64).ceil() as usize;
    let workspace = &scene.workspace;
    let occupancy = method
        .needs_occupancy(loop_scene.config)
        .then(|| OccupancyGrid::new(workspace.least, workspace.greatest, VOXEL_M));
    let mut state = LoopState {
        visited: Vec::new(),
        is_found: vec![false; scene.objects.len()],
        models: vec![None; scene.objects.len()],
        travel_m: 0.0,
        measured: Vec::new(),
        occupancy: occupancy.transpose().map_err(Failure::general)?,
        random: Random::substream(loop_scene.seed, start as u64),
    };
    let (mut course, mut next) = (LoopCourse::default(), start);
    loop {
        state.visit(loop_scene, next, method)?;
        let found = state.is_found.iter().zip(&is_findable);
        let n_found = found
            .filter(|(is_found, is_findable)| **is_found && **is_findable)
            .count();
        course
            .found_shares
            .push(n_found as f64 / n_findable.max(1) as f64);
        course.travel_m.push(state.travel_m);
        course.is_complete = n_found >= n_wanted;
        if course.is_complete || state.visited.len() >= N_VIEWS_MAX.min(views.len()) {
            course.views = state.visited;
            return Ok(course);
        }
        next = state.choose(loop_scene, method, planner)?;
    }
}

impl LoopState {
    fn visit(
        &mut self,
        loop_scene: &LoopScene<'_>,
        view: usize,
        method: Method,
    ) -> Result<(), Failure> {
        let cameras = &loop_scene.scene.cameras;
        if let Some(&last) = self.visited.last() {
            let shift = cameras[view].translation.vector - cameras[last].translation.vector;
            self.travel_m += shift.norm();
        }
        self.visited.push(view);
        let captured = &loop_scene.views[view];
        for (is_found, is_detected) in self.is_found.iter_mut().zip(&captured.segments.is_detected)
        {
            *is_found |= is_detected;
        }
        for model in captured.segments.good_models() {
            let known = &mut self.models[model.object];
            if known.is_none_or(|known| model.contradiction < known.contradiction) {
                *known = Some(*model);
            }
        }
        if method.needs_entropy() {
            self.measured.extend_from_slice(&captured.measured);
            if !self.measured.is_empty() {
                let thinned = SurfaceModel::of_points(&self.measured, MEASURED_SPACING_M);
                self.measured = thinned.map_err(Failure::general)?.points().to_vec();
            }
        }
        if let Some(occupancy) = &mut self.occupancy {
            let observed = occupancy.observe(&captured.rays, &cameras[view]);
            observed.map_err(Failure::general)?;
        }
        Ok(())
    }

    fn choose(
        &mut self,
        loop_scene: &LoopScene<'_>,
        method: Method,
        planner: &mut ViewPlanner,
    ) -> Result<usize, Failure> {
        let cameras = &loop_scene.scene.cameras;
        let current = self.visited.last().copied().unwrap_or(0);
        let place = |view: usize| cameras[view].translation.vector;
        let distance_m = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm();
        let left: Vec<usize> = (0..cameras.len())
            .filter(|v| !self.visited.contains(v))
            .collect();
        let clearance_m = |view: &usize| {
            let visited = self
                .visited
                .iter()
                .map(|&v| distance_m(place(v), place(*view)));
            visited.fold(f64::INFINITY, f64::min)
        };
        let away_m = |view: &usize| distance_m(place(current), place(*view));
        let chosen = match method {
            Method::Random => self.random.choice(&left).copied(),
            Method::Farthest => {
                let farther = |a: &&usize, b: &&usize| clearance_m(a).total_cmp(&clearance_m(b));
                left.iter().max_by(farther).copied()
            }
            Method::Nearest => {
                let nearer = |a: &&usize, b: &&usize| away_m(a).total_cmp(&away_m(b));
                left.iter().min_by(nearer).copied()
            }
            _ => Some(self.plan(loop_scene, method, planner)?),
        };
        chosen.ok_or_else(|| Failure::general("there is no view left to choose"))
    }

    /// Hypotheses of what was seen so far, and the other segments of the current view: registered
    /// models, or the truth with noise.
    fn hypotheses(
        &self,
        loop_scene: &LoopScene<'_>,
        method: Method,
        current: usize,
    ) -> Result<ObjectHypotheses, Failure> {
        let LoopScene { scene, seed, .. } = *loop_scene;
        let current = &loop_scene.views[current];
        if method == Method::GreedyTruth {
            let is_found = |object: usize| self.is_found[object];
            let noise = HypothesisNoise::POSES;
            let mut known = ObjectHypotheses::noisy(scene, &noise, seed, is_found);
            known.add_fragments(current)?;
            return Ok(known);
        }
        let mut known = ObjectHypotheses::of_models(self.models.iter().flatten());
        known.add_unregistered(current)?;
        Ok(known)
    }

    /// Choice by the planner.
    fn plan(
        &mut self,
        loop_scene: &LoopScene<'_>,
        method: Method,
        planner: &mut ViewPlanner,
    ) -> Result<usize, Failure> {
        let LoopScene { scene, config, .. } = loop_scene;
        let current = self.visited.last().copied().unwrap_or(0);
        let known = self.hypotheses(loop_scene, method, current)?;
        let planned = if method == Method::InformationGain {
            PlanningScene::default()
        } else {
            known.planning_scene(scene, &self.measured)?
        };
        let visited: Vec<_> = self
            .visited
            .iter()
            .map(|&view| scene.cameras[view])
            .collect();
        let candidates = CandidateViews {
            world_from_candidates: &scene.cameras,
            world_from_current: scene.cameras[current],
            world_from_visited: &visited,
        };
        let config = method.config(config);
        let scores = planner.score(&planned, &candidates, &config, self.occupancy.as_ref());
        let mut scores: Vec<ViewScore> = scores.map_err(Failure::general)?.to_vec();
        let selection = match method {
            Method::Sampled => ViewSelection::Sampled { beta: 1.0 },
            Method::Least => ViewSelection::Least,
            _ => ViewSelection::Greedy,
        };
        if method == Method::InformationGain {
            for score in &mut scores {
                score.utility = score.gain;
            }
        }
        debug_assert!(scores[current].state == CandidateState::Visited);
        let choice = choose_view(&scores, selection, &mut self.random);
        Ok(choice.map_err(Failure::general)?.candidate)
    }
}
