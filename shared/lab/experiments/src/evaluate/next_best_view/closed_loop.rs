//! Closed loop: views are chosen one after the other until the objects are found.

use super::bin_scene::BinScene;
use super::captured_view::CapturedView;
use super::findable_objects::findable;
use super::loop_method::Method;
use random::Random;
use service::Failure;
use view_planning::{PlanSettings, plan};

/// Share of the objects at which a loop ends (Kasaei et al. 2018 have no closed loop).
const FOUND_SHARE: f64 = 0.95;
/// Number of views after which a loop gives up. Chosen.
pub(super) const N_VIEWS_MAX: usize = 30;

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

/// Scene of a loop with its captured views, from which plans were made.
#[derive(Clone, Copy)]
pub(super) struct LoopScene<'a> {
    pub(super) scene: &'a BinScene,
    pub(super) views: &'a [CapturedView],
    pub(super) settings: &'a PlanSettings,
    /// Seed of the draws.
    pub(super) seed: u64,
}

/// Runs a loop from a first view. A loop without a view left to choose gives up.
pub(super) fn run(loop_scene: &LoopScene<'_>, method: Method, start: usize) -> LoopCourse {
    let views = loop_scene.views;
    let is_findable = findable(views);
    let n_findable = is_findable.iter().filter(|&&is| is).count();
    let n_wanted = (FOUND_SHARE * n_findable as f64).ceil() as usize;
    let mut is_found = vec![false; is_findable.len()];
    let mut random = Random::substream(loop_scene.seed, start as u64);
    let (mut course, mut travel_m, mut next) = (LoopCourse::default(), 0.0, Some(start));
    while let Some(view) = next {
        if let Some(&last) = course.views.last() {
            travel_m += loop_scene.distance_m(last, view);
        }
        course.views.push(view);
        let detected = &views[view].segments.is_detected;
        for (is_found, is_detected) in is_found.iter_mut().zip(detected) {
            *is_found |= is_detected;
        }
        let found = is_found.iter().zip(&is_findable);
        let n_found = found.filter(|(is_found, is)| **is_found && **is).count();
        let share = n_found as f64 / n_findable.max(1) as f64;
        course.found_shares.push(share);
        course.travel_m.push(travel_m);
        course.is_complete = n_found >= n_wanted;
        if course.is_complete || course.views.len() >= N_VIEWS_MAX.min(views.len()) {
            break;
        }
        next = loop_scene.choose(method, &course.views, view, &mut random);
    }
    course
}

impl LoopScene<'_> {
    /// Distance of two cameras, metres.
    fn distance_m(&self, a: usize, b: usize) -> f64 {
        let place = |view: usize| self.scene.cameras[view].translation.vector;
        (place(a) - place(b)).norm()
    }

    /// Next view; `None` when none is left.
    fn choose(
        &self,
        method: Method,
        visited: &[usize],
        current: usize,
        random: &mut Random,
    ) -> Option<usize> {
        let n_views = self.views.len();
        let left: Vec<usize> = (0..n_views).filter(|v| !visited.contains(v)).collect();
        let clearance_m = |view: usize| {
            let distances_m = visited.iter().map(|&v| self.distance_m(v, view));
            distances_m.fold(f64::INFINITY, f64::min)
        };
        match method {
            Method::Random => random.choice(&left).copied(),
            Method::Farthest => {
                let farther =
                    |a: &&usize, b: &&usize| clearance_m(**a).total_cmp(&clearance_m(**b));
                left.iter().max_by(farther).copied()
            }
            Method::Nearest => {
                let away_m = |view: usize| self.distance_m(current, view);
                let nearer = |a: &&usize, b: &&usize| away_m(**a).total_cmp(&away_m(**b));
                left.iter().min_by(nearer).copied()
            }
            _ => self.plan(method, visited, current, random).ok(),
        }
    }

    /// Choice by the plan from the current view, as `tabula view plan` makes it.
    fn plan(
        &self,
        method: Method,
        visited: &[usize],
        current: usize,
        random: &mut Random,
    ) -> Result<usize, Failure> {
        let content = &self.views[current].plans.contents[method.source() as usize];
        let visited: Vec<_> = visited
            .iter()
            .map(|&view| self.scene.cameras[view])
            .collect();
        let visited = content.frame.poses(&visited);
        let candidates = content.frame.poses(&self.scene.cameras);
        let settings = method.settings(self.settings);
        Ok(plan(content, &candidates, &visited, &settings, random)?.chosen)
    }
}
