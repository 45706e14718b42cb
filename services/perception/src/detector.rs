//! Object detection as a job on the worker pool.

use crate::frame_receiver::ReceivedFrame;
use crate::helper_threads::HelperThreads;
use crate::scene_priors::PriorBuffers;
use actor::{JobLost, Progress, WorkerPool};
use detection::{
    Config, Detection, DetectionInput, DetectionStage, Execution, ScenePriors, Workspace, detect,
};
use message::{SegmentLocation, Span, Stage, points};
use point_cloud::OrganizedCloud;
use service::Stopwatch;
use std::sync::Arc;

/// Detection job runner that reuses its buffers from frame to frame.
pub(crate) struct Detector {
    pool: WorkerPool,
    helper_threads: Arc<HelperThreads>,
    config: Arc<Config>,
    buffers: DetectionBuffers,
    /// Number of the frame whose detection panics.
    #[cfg(feature = "fault-injection")]
    fault_frame: Option<u64>,
}

#[derive(Default)]
struct DetectionBuffers {
    priors: PriorBuffers,
    workspace: Workspace,
    detection: Detection,
    spans: Vec<Span>,
}

/// Detection of a frame, with the location of its points and the measured time spans.
#[derive(Debug, Default)]
pub(crate) struct DetectedFrame {
    pub(crate) detection: Detection,
    pub(crate) location: SegmentLocation,
    /// Time spans of the steps, followed by that of the whole detection.
    pub(crate) spans: Vec<Span>,
}

/// Reason why a frame has no detection.
#[derive(Debug)]
pub(crate) enum DetectionError {
    /// Failed detection: the cloud cannot be searched, with the reason.
    Unusable(String),
    /// Failed detection: the job panicked or stalled; its buffers are lost with it.
    Lost(JobLost),
}

impl DetectionError {
    /// True if a worker or its buffers were restarted, which counts as a restart in
    /// health. An unusable cloud restarts nothing.
    pub(crate) fn is_restart(&self) -> bool {
        matches!(self, Self::Lost(_))
    }
}

impl Detector {
    pub(crate) fn new(pool: WorkerPool, config: Config) -> Self {
        Self {
            helper_threads: Arc::new(HelperThreads::of(&pool)),
            pool,
            config: Arc::new(config),
            buffers: DetectionBuffers::default(),
            #[cfg(feature = "fault-injection")]
            fault_frame: None,
        }
    }

    /// The same with a frame whose detection panics.
    #[cfg(feature = "fault-injection")]
    pub(crate) fn with_fault(self, frame: Option<u64>) -> Self {
        Self {
            fault_frame: frame,
            ..self
        }
    }

    /// Scene priors of the next frame, to be filled.
    pub(crate) fn priors_mut(&mut self) -> &mut PriorBuffers {
        &mut self.buffers.priors
    }

    /// Detection settings in use.
    pub(crate) fn config(&self) -> &Config {
        &self.config
    }

    /// Replaces the settings, between two frames.
    pub(crate) fn set_config(&mut self, config: Config) {
        self.config = Arc::new(config);
    }

    /// Detects objects in a frame, reading the points in shared memory without a copy.
    pub(crate) async fn detect(
        &mut self,
        received: &ReceivedFrame,
    ) -> Result<DetectedFrame, DetectionError> {
        let buffers = std::mem::take(&mut self.buffers);
        let (received, config) = (received.clone(), self.config.clone());
        let helper_threads = self.helper_threads.clone();
        #[cfg(feature = "fault-injection")]
        let is_faulty = self.fault_frame == Some(received.frame.header().sequence);
        let search = move |_: &Progress| {
            #[cfg(feature = "fault-injection")]
            assert!(!is_faulty, "a fault on purpose");
            search(&received, &config, &helper_threads, buffers)
        };
        let job = self.pool.run(search);
        let (buffers, found) = job.await.map_err(DetectionError::Lost)?;
        self.buffers = buffers;
        let location = found.map_err(DetectionError::Unusable)?;
        let DetectionBuffers {
            detection, spans, ..
        } = &mut self.buffers;
        Ok(DetectedFrame {
            detection: std::mem::take(detection),
            location,
            spans: std::mem::take(spans),
        })
    }

    /// Returns the buffers of a detection for reuse.
    pub(crate) fn recycle(&mut self, detected: DetectedFrame) {
        self.buffers.detection = detected.detection;
        self.buffers.spans = detected.spans;
    }
}

fn search(
    received: &ReceivedFrame,
    config: &Config,
    helper_threads: &HelperThreads,
    mut buffers: DetectionBuffers,
) -> (DetectionBuffers, Result<SegmentLocation, String>) {
    let begin = Stopwatch::start();
    let header = received.frame.header();
    let [width, height] = header.size_px.map(|side| side as usize);
    let cloud = OrganizedCloud::new(points(received.frame.items()), width, height);
    let found = cloud.map_err(|error| error.to_string()).and_then(|cloud| {
        let DetectionBuffers {
            priors,
            workspace,
            detection,
            spans,
        } = &mut buffers;
        let frame = DetectionInput {
            cloud,
            up_in_camera: received.checked.up_in_camera,
            priors: ScenePriors {
                world_from_camera: received.frame_pose().world_from_camera,
                ..priors.priors()
            },
        };
        let mut watch = begin;
        spans.clear();
        let on_stage = &mut |ended| spans.push(watch.lap(stage(ended), 0));
        let execution = Execution {
            parallelism: helper_threads,
            observer: Some(on_stage),
        };
        let found = detect(&frame, config, workspace, detection, execution);
        priors.bodies.assign(&detection.bodies);
        helper_threads.take_spans(spans);
        // Discards the time after the last stage.
        let _ = watch.lap(Stage::Detection, 0);
        spans.push(watch.span_since(&begin, Stage::Detection, 0));
        found.map_err(|error| error.to_string())
    });
    (buffers, found.map(|()| received.frame.location()))
}

fn stage(ended: DetectionStage) -> Stage {
    match ended {
        DetectionStage::Subsampling => Stage::Samples,
        DetectionStage::TablePlane => Stage::TablePlane,
        DetectionStage::TableSurface => Stage::TableSurface,
        DetectionStage::PrismFilter => Stage::Prism,
        DetectionStage::Clustering => Stage::Clusters,
        DetectionStage::Segmentation => Stage::Segmentation,
        DetectionStage::TrackRegrouping => Stage::Regrouping,
        DetectionStage::SupportPlaneGrowth => Stage::SupportGrowth,
        DetectionStage::BoundingBoxes => Stage::Boxes,
        DetectionStage::ConstraintEvaluation => Stage::ConstraintEvaluation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_lost_job_counts_as_a_restart() {
        let unusable = DetectionError::Unusable("the cloud has no rows".into());
        assert!(!unusable.is_restart());
        assert!(DetectionError::Lost(JobLost::Stalled).is_restart());
    }
}
