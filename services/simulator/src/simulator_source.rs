//! The simulated table as a source of frames.

use crate::arm_desk::{ArmRequest, ArmRequests};
use crate::broadcast::Broadcast;
use crate::increment::Increment;
use crate::translate;
use capture::{FrameInfo, FrameSize, Source, SourceError, Waiting};
use geometry::PinholeCamera;
use message::FrameHeader;
use message::control::{Refusal, RefusalKind};
use nalgebra::{Unit, Vector3};
use point_cloud::Point;
use service::monotonic_ns;
use simulated_world::{SimulatedKinect, TrueObject, World};

/// Plays the world for ever.
pub(crate) struct SimulatorSource {
    name: String,
    rate_hz: f64,
    increment: Increment,
    kinect: SimulatedKinect,
    truth: Vec<TrueObject>,
    requests: ArmRequests,
    broadcast: Broadcast,
    /// Samples of the arm that have been published.
    n_published: usize,
}

impl SimulatorSource {
    pub(crate) fn new(
        name: String,
        rate_hz: f64,
        world: World,
        requests: ArmRequests,
        broadcast: Broadcast,
    ) -> Result<Self, simulated_world::Error> {
        let mut kinect = SimulatedKinect::new(&world, PinholeCamera::KINECT_V1)?;
        // The first looks draw the room; no frame is to wait for that.
        let mut points = vec![Point::default(); kinect.camera().n_pixels()];
        for _ in 0..2 {
            kinect.look(&world, 0, &mut points)?;
        }
        Ok(Self {
            name,
            rate_hz,
            kinect,
            increment: Increment::new(world, rate_hz),
            truth: Vec::new(),
            requests,
            broadcast,
            n_published: 0,
        })
    }

    /// Renders the world as it is at the end of the increment.
    fn look(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let frame = self.increment.frame();
        let world = self.increment.world();
        self.truth = self.kinect.look(world, frame, points).map_err(unusable)?;
        let world_from_camera = world.world_from_camera();
        Ok(FrameInfo {
            camera: *self.kinect.camera(),
            is_calibrated: true,
            up_in_camera: Some(Unit::new_normalize(
                world_from_camera.rotation.inverse() * Vector3::z(),
            )),
            world_from_camera: Some(world_from_camera),
            source_frame: frame as usize - 1,
            captured_ns: None,
        })
    }

    /// Answers what waits at the desk; true when the world is another one now.
    /// The increment ends at `end_ns`.
    fn serve(&mut self, end_ns: u64) -> Result<bool, SourceError> {
        let mut is_another_world = false;
        while let Ok(request) = self.requests.waiting.try_recv() {
            // Whoever has the answer must not see the arm as it was before.
            self.publish_arm(end_ns, request.arrived_ns.min(monotonic_ns()))?;
            is_another_world |= self.answer(request, end_ns);
        }
        Ok(is_another_world)
    }

    fn answer(&mut self, request: ArmRequest, end_ns: u64) -> bool {
        let before_end_ns = end_ns.saturating_sub(request.arrived_ns);
        let told = translate::command(&request.command).and_then(|command| match command {
            None => Ok(false),
            Some(command) => {
                tracing::info!("arm: {:?}", request.command);
                self.increment
                    .command(&command, before_end_ns, self.n_published)
            }
        });
        let is_another_world = matches!(told, Ok(true));
        let status = self.increment.status_at(before_end_ns);
        let report = told.and_then(|_| status.ok_or("the scene has no arm".into()));
        let report = report
            .map(|status| translate::report(&status))
            .map_err(|sentence| Refusal::new(RefusalKind::Invalid, sentence));
        // Whoever asked may have gone.
        let _ = request.answer.send(report);
        is_another_world
    }

    /// Publishes the samples of the arm up to an instant; that of the next one is
    /// returned.
    fn publish_arm(&mut self, end_ns: u64, until_ns: u64) -> Result<Option<u64>, SourceError> {
        while let Some(sample) = self.increment.samples().get(self.n_published) {
            let stamp_ns = end_ns.saturating_sub(self.increment.before_end_ns(self.n_published));
            if stamp_ns > until_ns {
                return Ok(Some(stamp_ns));
            }
            self.broadcast.arm(sample, stamp_ns).map_err(unusable)?;
            self.n_published += 1;
        }
        Ok(None)
    }
}

impl Source for SimulatorSource {
    fn name(&self) -> &str {
        &self.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.rate_hz)
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        self.requests.wake_this_thread();
        // What came since the last frame acts from here on.
        self.serve(0)?;
        self.increment.advance();
        self.n_published = 0;
        let camera = self.kinect.camera();
        Ok(Some(FrameSize {
            width: camera.width as usize,
            height: camera.height as usize,
        }))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        self.look(points)
    }

    fn while_waiting(
        &mut self,
        due_ns: u64,
        points: Option<&mut [Point]>,
    ) -> Result<Waiting, SourceError> {
        let is_another_world = self.serve(due_ns)?;
        let drawn = points.filter(|_| is_another_world);
        let rewritten = drawn.map(|points| self.look(points)).transpose()?;
        let again_ns = self.publish_arm(due_ns, monotonic_ns())?;
        Ok(Waiting {
            rewritten,
            again_ns,
        })
    }

    fn sending(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        self.publish_arm(header.capture_stamp_ns, u64::MAX)?;
        self.broadcast
            .person(header, self.increment.world())
            .map_err(unusable)
    }

    fn sent(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        for note in self.increment.world_mut().take_notes() {
            tracing::warn!("{note}");
        }
        self.broadcast
            .truth(header, &self.truth, self.kinect.mask())
            .map_err(unusable)
    }
}

fn unusable(error: impl std::fmt::Display) -> SourceError {
    SourceError::Unusable(error.to_string())
}
