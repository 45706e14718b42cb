//! Growth of a model: its views, what is refused, and what is still missing.

use crate::camera_motion::{CameraMotion, Mover, has_moved};
use crate::next_move::NextMove;
use crate::object_receiver::ReceivedView;
use model_construction::{Config, ModelBuilder, PoseSigma, View};
use nalgebra::{Isometry3, Vector3};
use object_model::{DirectionSphere, RefusedView, UnseenDirections};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Angle between a direction and that of a view within which its side counts as seen, 40°, as the
/// cosine. Chosen: a surface that is turned away by more is measured badly.
pub(crate) const SEEN_COSINE: f32 = 0.766;

/// Maximum number of fused views. Chosen: 300 MB.
const N_VIEWS_MAX: usize = 200;

/// Maximum number of refused views that are told.
const N_REFUSED_MAX: usize = 200;

/// Number of refused views in a row after which the object counts as turned, if the camera has not
/// moved. Chosen: half a second or more.
const N_REFUSED_TURNED: u32 = 10;

/// Model under construction, with its figures.
#[derive(Debug)]
pub(crate) struct Growth {
    builder: ModelBuilder,
    is_turn_known: bool,
    camera_motion: CameraMotion,
    sigma: PoseSigma,
    refused: Vec<RefusedView>,
    n_refused: usize,
    /// Number of refused views since the last one that fitted, and the camera's pose of that one.
    n_refused_in_row: u32,
    fitting_pose: Option<Isometry3<f64>>,
    /// Number of placements that were found by views that did not fit any more.
    n_found_placements: u32,
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
    mover: Mover,
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
        let next = match (self.next_move, self.mover) {
            (Some(next), _) => next.in_words(),
            (None, Mover::Object) => {
                "nothing more can be seen by turning the object; raise or lower the camera"
                    .to_owned()
            }
            (None, _) => "nothing more can be seen from above the table".to_owned(),
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
    /// Growth of a model, which stops bringing its views into agreement when the flag is set.
    pub(crate) fn new(config: Config, sigma: PoseSigma, stop: Arc<AtomicBool>) -> Self {
        Self {
            is_turn_known: config.turn_rad.is_some(),
            camera_motion: CameraMotion::default(),
            builder: ModelBuilder::new(config).stopped_by(stop),
            sigma,
            refused: Vec::new(),
            n_refused: 0,
            n_refused_in_row: 0,
            fitting_pose: None,
            n_found_placements: 0,
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
        self.camera_motion.note(view.world_from_camera);
        let was_closed = self.builder.is_closed();
        let begun = Instant::now();
        let added = self.builder.add(&View {
            points: &view.points,
            camera: view.camera,
            captured_ns: view.captured_ns,
            world_from_camera: view.world_from_camera,
            sigma: self.sigma,
            up_in_camera: view.up_in_camera,
            placement: view.placement + self.n_found_placements,
        });
        match added {
            Err(error) => {
                self.refuse(view, error.to_string());
                self.note_misfit(view);
                return Step::Refused;
            }
            Ok(registration) => {
                self.note_fit(view);
                if !self.is_last(view) {
                    return Step::Nothing;
                }
                // A placement with a bad beginning has been taken back.
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

    fn note_fit(&mut self, view: &ReceivedView) {
        self.n_refused_in_row = 0;
        self.fitting_pose = view.world_from_camera;
    }

    /// Takes the object for turned after many views that did not fit: it looks different to a
    /// camera that has not moved, or whose moves are not known. Not where each placement counts as
    /// one known turn.
    fn note_misfit(&mut self, view: &ReceivedView) {
        self.n_refused_in_row += 1;
        let poses = view.world_from_camera.zip(self.fitting_pose);
        let has_moved = poses.is_some_and(|(now, then)| has_moved(&then, &now));
        if self.n_refused_in_row >= N_REFUSED_TURNED && !has_moved && !self.is_turn_known {
            self.n_refused_in_row = 0;
            self.n_found_placements += 1;
        }
    }

    /// `true` if a view is the last one of the model.
    fn is_last(&self, view: &ReceivedView) -> bool {
        let last = self.builder.views().last();
        last.is_some_and(|last| last.captured_ns == view.captured_ns)
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

    /// Brings all views into agreement; `false` if it was stopped.
    pub(crate) fn finish(&mut self) -> bool {
        self.builder.finish()
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

    /// Move of the camera, or of the object, to the unseen directions; `None` without views, and
    /// where nothing is left to see.
    pub(crate) fn next_move(&self, unseen: &UnseenDirections) -> Option<NextMove> {
        let view = self.builder.views().last()?;
        let direction = view.direction().cast();
        NextMove::towards(unseen, &direction, self.camera_motion.mover())
    }

    /// State for a person.
    pub(crate) fn state(&self) -> GrowthState {
        let unseen = self.unseen();
        GrowthState {
            n_views: self.builder.views().len(),
            n_refused: self.n_refused,
            mover: self.camera_motion.mover(),
            next_move: self.next_move(&unseen),
            unseen,
        }
    }
}
