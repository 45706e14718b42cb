//! Detection on the worker pool.

use crate::bodies::Known;
use crate::intake::Arrived;
use actor::{JobLost, WorkerPool};
use detection::{Config, Detection, Frame, Workspace};
use message::{SegmentLocation, points};
use point_cloud::OrganizedCloud;
use std::sync::Arc;

/// Detects, reusing its buffers from frame to frame.
pub(crate) struct Detector {
    pool: WorkerPool,
    config: Arc<Config>,
    buffers: Buffers,
}

#[derive(Default)]
struct Buffers {
    known: Known,
    workspace: Workspace,
    detection: Detection,
}

/// A detection and where its points were read.
#[derive(Debug, Default)]
pub(crate) struct Detected {
    pub(crate) detection: Detection,
    pub(crate) location: SegmentLocation,
}

/// Why a frame gave no detection.
#[derive(Debug)]
pub(crate) enum DetectFailed {
    /// The cloud can not be searched.
    Unusable(String),
    /// The kernel has panicked or stalled; its buffers are gone with it.
    Lost(JobLost),
}

impl Detector {
    pub(crate) fn new(pool: WorkerPool, config: Config) -> Self {
        Self {
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
        let job = self.pool.run(move |_| search(&arrived, &config, buffers));
        let (buffers, found) = job.await.map_err(DetectFailed::Lost)?;
        self.buffers = buffers;
        let location = found.map_err(DetectFailed::Unusable)?;
        let detection = std::mem::take(&mut self.buffers.detection);
        Ok(Detected {
            detection,
            location,
        })
    }

    /// Takes a detection's memory back for the next frame.
    pub(crate) fn recycle(&mut self, detected: Detected) {
        self.buffers.detection = detected.detection;
    }
}

fn search(
    arrived: &Arrived,
    config: &Config,
    mut buffers: Buffers,
) -> (Buffers, Result<SegmentLocation, String>) {
    let header = arrived.frame.header();
    let [width, height] = header.size_px.map(|side| side as usize);
    let cloud = OrganizedCloud::new(points(arrived.frame.items()), width, height);
    let found = cloud.map_err(|error| error.to_string()).and_then(|cloud| {
        let up_in_camera = arrived.checked.up_in_camera;
        // The frame's own number: a replay draws the same samples.
        let Buffers {
            known,
            workspace,
            detection,
        } = &mut buffers;
        let frame = Frame {
            cloud,
            up_in_camera,
            seed: header.sequence,
            surroundings: known.surroundings(),
        };
        detection::detect(&frame, config, workspace, detection).map_err(|error| error.to_string())
    });
    (buffers, found.map(|()| arrived.frame.location()))
}
