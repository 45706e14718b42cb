//! Detection on the worker pool.

use crate::bodies::Known;
use crate::helpers::Helpers;
use crate::intake::Arrived;
use actor::{JobLost, Progress, WorkerPool};
use detection::{Config, Detection, Frame, Step, Workspace, detect_in_steps};
use message::{SegmentLocation, Span, Stage, points};
use point_cloud::OrganizedCloud;
use service::Stopwatch;
use std::sync::Arc;

/// Detects, reusing its buffers from frame to frame.
pub(crate) struct Detector {
    pool: WorkerPool,
    helpers: Arc<Helpers>,
    config: Arc<Config>,
    buffers: Buffers,
}

#[derive(Default)]
struct Buffers {
    known: Known,
    workspace: Workspace,
    detection: Detection,
    spans: Vec<Span>,
}

/// A detection, where its points were read, and what it took.
#[derive(Debug, Default)]
pub(crate) struct Detected {
    pub(crate) detection: Detection,
    pub(crate) location: SegmentLocation,
    /// The whole detection last, its steps before.
    pub(crate) spans: Vec<Span>,
}

/// Why a frame gave no detection.
#[derive(Debug)]
pub(crate) enum DetectFailed {
    /// The cloud can not be searched.
    Unusable(String),
    /// The kernel has panicked or stalled; its buffers are gone with it.
    Lost(JobLost),
}

impl DetectFailed {
    /// True if a worker or its buffers were started again: counted as a restart in
    /// health. An unusable cloud is the camera's fault and restarts nothing.
    pub(crate) fn is_restart(&self) -> bool {
        matches!(self, Self::Lost(_))
    }
}

impl Detector {
    pub(crate) fn new(pool: WorkerPool, config: Config) -> Self {
        Self {
            helpers: Arc::new(Helpers::of(&pool)),
            pool,
            config: Arc::new(config),
            buffers: Buffers::default(),
        }
    }

    /// What is known to be there before the next frame is searched.
    pub(crate) fn known_mut(&mut self) -> &mut Known {
        &mut self.buffers.known
    }

    /// The settings.
    pub(crate) fn config(&self) -> &Config {
        &self.config
    }

    /// Searches a frame, in the camera's own bytes.
    pub(crate) async fn detect(&mut self, arrived: &Arrived) -> Result<Detected, DetectFailed> {
        let buffers = std::mem::take(&mut self.buffers);
        let (arrived, config) = (arrived.clone(), self.config.clone());
        let helpers = self.helpers.clone();
        let search = move |_: &Progress| search(&arrived, &config, &helpers, buffers);
        let job = self.pool.run(search);
        let (buffers, found) = job.await.map_err(DetectFailed::Lost)?;
        self.buffers = buffers;
        let location = found.map_err(DetectFailed::Unusable)?;
        let Buffers {
            detection, spans, ..
        } = &mut self.buffers;
        Ok(Detected {
            detection: std::mem::take(detection),
            location,
            spans: std::mem::take(spans),
        })
    }

    /// Takes a detection's memory back for the next frame.
    pub(crate) fn recycle(&mut self, detected: Detected) {
        self.buffers.detection = detected.detection;
        self.buffers.spans = detected.spans;
    }
}

fn search(
    arrived: &Arrived,
    config: &Config,
    helpers: &Helpers,
    mut buffers: Buffers,
) -> (Buffers, Result<SegmentLocation, String>) {
    let begin = Stopwatch::start();
    let header = arrived.frame.header();
    let [width, height] = header.size_px.map(|side| side as usize);
    let cloud = OrganizedCloud::new(points(arrived.frame.items()), width, height);
    let found = cloud.map_err(|error| error.to_string()).and_then(|cloud| {
        let Buffers {
            known,
            workspace,
            detection,
            spans,
        } = &mut buffers;
        let frame = Frame {
            cloud,
            up_in_camera: arrived.checked.up_in_camera,
            // The frame's own number: a replay draws the same samples.
            seed: header.sequence,
            surroundings: known.surroundings(),
        };
        let mut watch = begin;
        spans.clear();
        let on_step = &mut |step| spans.push(watch.lap(stage(step), 0));
        let found = detect_in_steps(&frame, config, workspace, detection, helpers, on_step);
        helpers.tell(spans);
        // What follows the last step, where not all were taken.
        let _ = watch.lap(Stage::Detection, 0);
        spans.push(watch.span_since(&begin, Stage::Detection, 0));
        found.map_err(|error| error.to_string())
    });
    (buffers, found.map(|()| arrived.frame.location()))
}

fn stage(step: Step) -> Stage {
    match step {
        Step::Samples => Stage::Samples,
        Step::TablePlane => Stage::TablePlane,
        Step::TableSurface => Stage::TableSurface,
        Step::Prism => Stage::Prism,
        Step::Clusters => Stage::Clusters,
        Step::Piles => Stage::Piles,
        Step::Regrouping => Stage::Regrouping,
        Step::Feet => Stage::Feet,
        Step::Boxes => Stage::Boxes,
        Step::Judging => Stage::Judging,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_lost_job_counts_as_a_restart() {
        let unusable = DetectFailed::Unusable("the cloud has no rows".into());
        assert!(!unusable.is_restart());
        assert!(DetectFailed::Lost(JobLost::Stalled).is_restart());
    }
}
