//! Frame pipeline: predict, detect, associate, observe and apply, in this order.
//!
//! The order stands here and nowhere else. What needs threads, actors or clocks is an
//! executor's: the daemon detects on a worker pool and observes with one actor for each
//! object, evaluation and replay do both on the calling thread
//! ([`SequentialExecutor`](crate::SequentialExecutor)).

use crate::surface_memory::SurfaceMemory;
use crate::{Config, FramePose, Posterior, Sighting, Track, TrackTable, TrackUpdate};
use detection::{Detection, ExpectedTrack};
use geometry::Plane;
use learning::{CategoryIndex, TrackEvidence};
use point_cloud::Point;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Stage of a frame on the pipeline's own thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameStage {
    /// Prediction of the tracks to the frame and gathering of the scene priors.
    Priors,
    /// Association of the candidates with the tracks; start and end of tracks.
    Association,
}

/// Executor of a frame: detection and observation, and the owner of what tracks have.
pub trait FrameExecutor {
    /// Finished detection, with whatever the executor keeps beside it.
    type Detected: Send;
    /// Error type of a failure that ends the frame.
    type Error;

    /// Called before a stage, for instance to read a clock.
    fn stage_started(&mut self, _stage: FrameStage) {}

    /// Callback after a stage of the frame has finished.
    fn stage_finished(&mut self, _stage: FrameStage) {}

    /// Buffer for the expected tracks, a prior of the coming detection.
    fn expected_tracks(&mut self) -> &mut Vec<ExpectedTrack>;

    /// Buffer for the planes of the expected surfaces, a prior of the coming detection.
    fn expected_surfaces(&mut self) -> &mut Vec<Plane>;

    /// Gathers the other scene priors: people and the robot.
    ///
    /// # Errors
    /// When their sources fail.
    fn gather_priors(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Detects the candidates of the frame.
    fn detect(&mut self) -> impl Future<Output = Result<Self::Detected, Self::Error>> + Send;

    /// Detection contained in a finished detection result.
    fn detection(detected: &Self::Detected) -> &Detection;

    /// Next track-id, ascending; `None` while there are none.
    fn next_track_id(&mut self) -> Option<u64>;

    /// Callback for each track that starts.
    fn track_started(&mut self, track_id: u64);

    /// Callback for each track that ends.
    fn track_ended(&mut self, track_id: u64);

    /// Observes the sighted objects, each with the evidence of its track, and applies their
    /// posteriors. A late posterior is left out; its track is predicted and keeps its evidence.
    fn observe(
        &mut self,
        detected: &Self::Detected,
        sightings: &[Sighting],
        tracks: ObservedTracks<'_>,
    ) -> impl Future<Output = Result<(), Self::Error>> + Send;
}

/// Tracks during the observation of a frame: their evidence so far, and the receiver of their
/// posteriors.
#[derive(Debug)]
pub struct ObservedTracks<'a>(&'a mut TrackTable);

impl ObservedTracks<'_> {
    /// Evidence of a track before this frame.
    pub fn evidence(&self, track_id: u64) -> TrackEvidence {
        self.0.evidence(track_id)
    }

    /// Applies the posterior of an object to its track.
    pub fn apply(&mut self, track_id: u64, posterior: &Posterior) {
        self.0.apply_posterior(track_id, posterior);
    }
}

/// Frame pipeline: the live tracks, and the last frame's changes to them.
#[derive(Debug)]
pub struct FramePipeline {
    tracks: TrackTable,
    surfaces: SurfaceMemory,
    update: TrackUpdate,
    last_capture_ns: u64,
}

impl FramePipeline {
    /// Frame pipeline without tracks.
    pub fn new(config: Config) -> Self {
        Self {
            tracks: TrackTable::new(config),
            surfaces: SurfaceMemory::default(),
            update: TrackUpdate::default(),
            last_capture_ns: 0,
        }
    }

    /// Replaces the settings, between two frames.
    pub fn set_config(&mut self, config: Config) {
        self.tracks.set_config(config);
    }

    /// Live tracks, ascending by track-id.
    pub fn tracks(&self) -> &[Track] {
        self.tracks.tracks()
    }

    /// Evidence of the tracks whose labels were read from another state of the taught views, or by
    /// another rule, than the present ones; to be read anew with
    /// [`CategoryIndex::reread_track`] and [set](Self::set_evidence) again.
    pub fn outdated_evidence(&self, taught: &CategoryIndex) -> Vec<(u64, TrackEvidence)> {
        self.tracks.outdated_evidence(taught)
    }

    /// Sets the evidence of live tracks that was read anew.
    pub fn set_evidence(&mut self, reread: impl IntoIterator<Item = (u64, TrackEvidence)>) {
        for (track_id, evidence) in reread {
            self.tracks.set_evidence(track_id, evidence);
        }
    }

    /// Ratio of the depth noise measured on the table to the configured law, median over the
    /// last frames; `None` before a second with a table.
    pub fn noise_ratio(&self) -> Option<f32> {
        self.tracks.noise_ratio()
    }

    /// Sightings, ended tracks and rejected candidates of the last frame.
    pub fn update(&self) -> &TrackUpdate {
        &self.update
    }

    /// Processes one frame; `cloud` is the whole frame, camera frame. Capture times that
    /// run backwards are another recording: all tracks end first.
    ///
    /// # Errors
    /// When the executor fails; the tracks are predicted then, and keep their last state
    /// if it failed before association.
    pub async fn process<E: FrameExecutor>(
        &mut self,
        frame: &FramePose,
        cloud: &[Point],
        executor: &mut E,
    ) -> Result<E::Detected, E::Error> {
        self.restart_if_time_jumped(frame.capture_ns, executor);
        executor.stage_started(FrameStage::Priors);
        self.tracks.predict(frame, executor.expected_tracks());
        self.surfaces.predict(frame, executor.expected_surfaces());
        executor.gather_priors()?;
        executor.stage_finished(FrameStage::Priors);
        let detected = executor.detect().await?;
        self.associate(frame, cloud, E::detection(&detected), executor);
        let tracks = ObservedTracks(&mut self.tracks);
        executor
            .observe(&detected, &self.update.sightings, tracks)
            .await?;
        Ok(detected)
    }

    /// [`process`](Self::process) with an executor that never waits.
    ///
    /// # Errors
    /// As for [`process`](Self::process); `None` when the executor did wait, which a
    /// sequential one never does.
    pub fn process_now<E: FrameExecutor>(
        &mut self,
        frame: &FramePose,
        cloud: &[Point],
        executor: &mut E,
    ) -> Option<Result<E::Detected, E::Error>> {
        let future = pin!(self.process(frame, cloud, executor));
        match future.poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(result) => Some(result),
            Poll::Pending => None,
        }
    }

    fn restart_if_time_jumped<E: FrameExecutor>(&mut self, capture_ns: u64, executor: &mut E) {
        if capture_ns < self.last_capture_ns {
            self.update.ended_tracks.clear();
            self.tracks.clear(&mut self.update.ended_tracks);
            self.surfaces.clear();
            for track_id in &self.update.ended_tracks {
                executor.track_ended(*track_id);
            }
        }
        self.last_capture_ns = capture_ns;
    }

    fn associate<E: FrameExecutor>(
        &mut self,
        frame: &FramePose,
        cloud: &[Point],
        detection: &Detection,
        executor: &mut E,
    ) {
        executor.stage_started(FrameStage::Association);
        self.surfaces.update(&detection.surfaces, frame);
        let next_id = || executor.next_track_id();
        self.tracks
            .update(detection, cloud, frame, next_id, &mut self.update);
        for sighting in self.update.sightings.iter().filter(|seen| seen.is_new) {
            executor.track_started(sighting.track_id);
        }
        for track_id in &self.update.ended_tracks {
            executor.track_ended(*track_id);
        }
        executor.stage_finished(FrameStage::Association);
    }
}

#[cfg(test)]
mod tests;
