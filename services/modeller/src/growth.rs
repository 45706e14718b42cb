//! Growth of a model: its views, what is refused, and what is still missing.

use crate::next_move::NextMove;
use crate::object_receiver::ReceivedView;
use model_construction::{Config, ModelBuilder, PoseSigma, View};
use nalgebra::Vector3;
use object_model::{DirectionSphere, RefusedView, UnseenDirections};
use std::time::{Duration, Instant};

/// Angle between a direction and that of a view within which its side counts as seen, 40°, as the
/// cosine. Chosen: a surface that is turned away by more is measured badly.
pub(crate) const SEEN_COSINE: f32 = 0.766;

/// Maximum number of fused views. Chosen: 300 MB.
const N_VIEWS_MAX: usize = 200;

/// Maximum number of refused views that are told.
const N_REFUSED_MAX: usize = 200;

/// Model under construction, with its figures.
#[derive(Debug)]
pub(crate) struct Growth {
    builder: ModelBuilder,
    sigma: PoseSigma,
    refused: Vec<RefusedView>,
    n_refused: usize,
    /// Share of new surface and number of points of each fused view.
    shares: Vec<(f32, u32)>,
    wall_clock_offset_ns: i64,
    view_ms: Vec<f64>,
}

/// State of a model under construction, for a person.
#[derive(Debug, Clone)]
pub(crate) struct GrowthState {
    n_views: usize,
    n_refused: usize,
    unseen: UnseenDirections,
    next_move: Option<NextMove>,
}

impl GrowthState {
    /// Line that tells how far the model is, and where to go next.
    pub(crate) fn line(&self, elapsed: Duration, n_waiting: usize) -> String {
        let missing = self.unseen.in_words();
        let missing = match missing.as_slice() {
            [] => "nothing".to_owned(),
            some => some.join(", "),
        };
        let waiting = match n_waiting {
            0 | 1 => String::new(),
            n => format!(", {n} waiting"),
        };
        let next = match self.next_move {
            Some(next) => next.in_words(),
            None => "nothing more can be seen from above the table".to_owned(),
        };
        format!(
            "{:.0} s: {} views, {} refused{waiting}, {:.0} % of all directions seen; missing: \
             {missing}; next: {next}",
            elapsed.as_secs_f64(),
            self.n_views,
            self.n_refused,
            100.0 * self.unseen.completeness()
        )
    }
}

/// Result of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// Fused into the model.
    Fused,
    /// Fused, and all views were brought into agreement because they lead around the object.
    Closed,
    /// Near a fused view, or beyond the maximum number.
    Nothing,
    /// Refused.
    Refused,
}

impl Growth {
    pub(crate) fn new(config: Config, sigma: PoseSigma) -> Self {
        Self {
            builder: ModelBuilder::new(config),
            sigma,
            refused: Vec::new(),
            n_refused: 0,
            shares: Vec::new(),
            wall_clock_offset_ns: 0,
            view_ms: Vec::new(),
        }
    }

    /// Adds a view.
    pub(crate) fn add(&mut self, view: &ReceivedView) -> Step {
        if self.builder.views().len() >= N_VIEWS_MAX {
            return Step::Nothing;
        }
        self.wall_clock_offset_ns = view.wall_clock_offset_ns;
        let (n_views, was_closed) = (self.builder.views().len(), self.builder.is_closed());
        let begun = Instant::now();
        let added = self.builder.add(&View {
            points: &view.points,
            camera: view.camera,
            captured_ns: view.captured_ns,
            world_from_camera: view.world_from_camera,
            sigma: self.sigma,
        });
        match added {
            Err(error) => {
                self.refuse(view, error.to_string());
                return Step::Refused;
            }
            Ok(Some(_)) if self.builder.views().len() == n_views => return Step::Nothing,
            Ok(registration) => {
                // A model with a bad beginning has begun anew.
                self.shares.truncate(self.builder.views().len() - 1);
                let known = registration.map_or(0.0, |found| found.common_share);
                self.shares
                    .push((1.0 - known as f32, view.points.len() as u32));
            }
        }
        if self.builder.is_closed() && !was_closed {
            return Step::Closed;
        }
        self.view_ms.push(1e3 * begun.elapsed().as_secs_f64());
        Step::Fused
    }

    fn refuse(&mut self, view: &ReceivedView, reason: String) {
        self.n_refused += 1;
        if self.refused.len() < N_REFUSED_MAX {
            self.refused.push(RefusedView {
                captured_ns: self.wall_clock_ns(view.captured_ns),
                reason,
            });
        }
    }

    /// Time since 1970 of a capture, nanoseconds.
    pub(crate) fn wall_clock_ns(&self, captured_ns: u64) -> u64 {
        captured_ns.saturating_add_signed(self.wall_clock_offset_ns)
    }

    /// Brings all views into agreement.
    pub(crate) fn finish(&mut self) {
        self.builder.finish();
    }

    pub(crate) fn builder(&self) -> &ModelBuilder {
        &self.builder
    }

    pub(crate) fn shares(&self) -> &[(f32, u32)] {
        &self.shares
    }

    pub(crate) fn refused(&self) -> &[RefusedView] {
        &self.refused
    }

    pub(crate) fn n_refused(&self) -> usize {
        self.n_refused
    }

    /// Times of the fused views, but for closing the loop, milliseconds.
    pub(crate) fn view_ms(&self) -> &[f64] {
        &self.view_ms
    }

    /// Directions from which no view was taken.
    pub(crate) fn unseen(&self) -> UnseenDirections {
        let seen: Vec<Vector3<f32>> = self
            .builder
            .views()
            .iter()
            .map(|view| view.direction().cast())
            .collect();
        UnseenDirections::of(DirectionSphere::Icosphere162, |direction| {
            !seen.iter().any(|seen| seen.dot(direction) > SEEN_COSINE)
        })
    }

    /// Move of the camera to the unseen directions; `None` without views, and where nothing is left
    /// to see.
    pub(crate) fn next_move(&self, unseen: &UnseenDirections) -> Option<NextMove> {
        let view = self.builder.views().last()?;
        NextMove::towards(unseen, &view.direction().cast())
    }

    /// State for a person.
    pub(crate) fn state(&self) -> GrowthState {
        let unseen = self.unseen();
        GrowthState {
            n_views: self.builder.views().len(),
            n_refused: self.n_refused,
            next_move: self.next_move(&unseen),
            unseen,
        }
    }
}
