//! Tracking under evaluation: the frame pipeline of the daemon, run sequentially.

use evaluation::tracked_frame::TrackState;
use learning::CategoryIndex;
use pipeline::{Config, FramePipeline, SequentialFrame, SequentialState, Track, TrackUpdate};
use tracking::{AssociationConfig, MotionConfig, Visibility};

/// Frame pipeline with its sequential executor.
pub(in super::super) struct TrackingPipeline {
    pipeline: FramePipeline,
    state: SequentialState,
}

impl TrackingPipeline {
    /// Pipeline with the daemon's default settings and nothing taught.
    pub(in super::super) fn new() -> Result<Self, pipeline::Error> {
        let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
        let config = Config::new(motion, association, Config::KNOWN_PROBABILITY_MIN)?;
        Ok(Self {
            pipeline: FramePipeline::new(config),
            state: SequentialState::new(detection::Config::default(), config)?,
        })
    }

    /// Processes one frame: detection, association and track update.
    ///
    /// # Errors
    /// When the frame cannot be searched or an object cannot be described.
    pub(in super::super) fn step(
        &mut self,
        frame: &SequentialFrame<'_>,
    ) -> Result<(), pipeline::Error> {
        self.state.process(&mut self.pipeline, frame)
    }

    /// Live tracks after the last frame.
    pub(in super::super) fn tracks(&self) -> &[Track] {
        self.pipeline.tracks()
    }

    /// Executor state after the last frame.
    pub(in super::super) fn state(&self) -> &SequentialState {
        &self.state
    }

    /// Replaces the taught categories, between two frames.
    pub(in super::super) fn set_categories(&mut self, categories: CategoryIndex) {
        self.state.set_categories(categories);
    }

    /// States of the live tracks after the last frame.
    pub(super) fn track_states(&self) -> Vec<TrackState> {
        let tracks = self.pipeline.tracks().iter().map(|track| TrackState {
            id: track.id,
            is_output: track.visibility() == Visibility::Visible,
            box_in_world: track.box_in_world(),
        });
        tracks.collect()
    }

    /// Sightings and ended tracks of the last frame.
    pub(in super::super) fn update(&self) -> &TrackUpdate {
        self.pipeline.update()
    }
}
