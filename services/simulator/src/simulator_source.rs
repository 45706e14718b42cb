//! Frame source that renders the simulated table.

use crate::arm_command_queue::{ArmCommandQueue, QueuedArmCommand};
use crate::frame_interval::FrameInterval;
use crate::wire_conversion;
use crate::world_publishers::WorldPublishers;
use capture::{FrameInfo, FrameSize, IdleUpdate, Source, SourceError};
use control_protocol::{Refusal, RefusalKind};
use geometry::PinholeCamera;
use message::FrameHeader;
use nalgebra::{Unit, Vector3};
use point_cloud::Point;
use service::monotonic_ns;
use simulated_world::{ObjectTruth, SimulatedKinect, World};

/// Endless frame source of a simulated world.
pub(crate) struct SimulatorSource {
    name: String,
    rate_hz: f64,
    interval: FrameInterval,
    kinect: SimulatedKinect,
    truth: Vec<ObjectTruth>,
    requests: ArmCommandQueue,
    world_publishers: WorldPublishers,
    /// Number of arm samples of this interval that are published.
    n_published: usize,
}

impl SimulatorSource {
    pub(crate) fn new(
        name: String,
        rate_hz: f64,
        world: World,
        requests: ArmCommandQueue,
        world_publishers: WorldPublishers,
    ) -> Result<Self, simulated_world::Error> {
        let mut kinect = SimulatedKinect::new(&world, PinholeCamera::KINECT_V1)?;
        // Warm-up: the first views render the room, which no frame shall wait for.
        let mut points = vec![Point::default(); kinect.camera().n_pixels()];
        for _ in 0..2 {
            kinect.look(&world, 0, &mut points)?;
        }
        Ok(Self {
            name,
            rate_hz,
            kinect,
            interval: FrameInterval::new(world, rate_hz),
            truth: Vec::new(),
            requests,
            world_publishers,
            n_published: 0,
        })
    }

    /// Renders the simulated world at the end of the frame interval.
    fn look(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let frame = self.interval.frame();
        let world = self.interval.world();
        let seen = self.kinect.look(world, frame, points);
        self.truth = seen.map_err(|error| SourceError::Unusable(error.to_string()))?;
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

    /// Answers waiting arm commands; true if the world has changed. The interval ends at
    /// `end_ns`.
    fn serve(&mut self, end_ns: u64) -> Result<bool, SourceError> {
        let mut is_world_changed = false;
        while let Some(request) = self.requests.next() {
            // The arm states before the answer are published before it.
            self.publish_arm(end_ns, request.arrived_ns.min(monotonic_ns()))?;
            is_world_changed |= self.answer(request, end_ns);
        }
        Ok(is_world_changed)
    }

    fn answer(&mut self, request: QueuedArmCommand, end_ns: u64) -> bool {
        let before_end_ns = end_ns.saturating_sub(request.arrived_ns);
        let executed =
            wire_conversion::command(&request.command).and_then(|command| match command {
                None => Ok(false),
                Some(command) => {
                    tracing::info!("arm: {:?}", request.command);
                    self.interval
                        .command(&command, before_end_ns, self.n_published)
                }
            });
        let is_world_changed = matches!(executed, Ok(true));
        let status = self.interval.status_at(before_end_ns);
        let report = executed.and_then(|_| status.ok_or("the scene has no arm".into()));
        let report = report
            .map(|status| wire_conversion::report(&status))
            .map_err(|sentence| Refusal::new(RefusalKind::Invalid, sentence));
        // The client may have gone.
        let _ = request.answer.send(report);
        is_world_changed
    }

    /// Publishes the arm samples up to a time; returns the time of the next one.
    fn publish_arm(&mut self, end_ns: u64, until_ns: u64) -> Result<Option<u64>, SourceError> {
        while let Some(sample) = self.interval.samples().get(self.n_published) {
            let stamp_ns = end_ns.saturating_sub(self.interval.before_end_ns(self.n_published));
            if stamp_ns > until_ns {
                return Ok(Some(stamp_ns));
            }
            self.world_publishers.arm(sample, stamp_ns)?;
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
        // Commands since the last frame act from here on.
        self.serve(0)?;
        self.interval.advance();
        self.n_published = 0;
        Ok(Some(FrameSize::of(self.kinect.camera())))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        self.look(points)
    }

    fn while_waiting(
        &mut self,
        due_ns: u64,
        points: Option<&mut [Point]>,
    ) -> Result<IdleUpdate, SourceError> {
        let is_world_changed = self.serve(due_ns)?;
        let drawn = points.filter(|_| is_world_changed);
        let rewritten = drawn.map(|points| self.look(points)).transpose()?;
        let again_ns = self.publish_arm(due_ns, monotonic_ns())?;
        Ok(IdleUpdate {
            rewritten,
            next_call_ns: again_ns,
        })
    }

    fn before_send(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        self.publish_arm(header.capture_stamp_ns, u64::MAX)?;
        Ok(self
            .world_publishers
            .person(header, self.interval.world())?)
    }

    fn after_send(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        for note in self.interval.world_mut().take_notes() {
            tracing::warn!("{note}");
        }
        Ok(self
            .world_publishers
            .truth(header, &self.truth, self.kinect.mask())?)
    }
}
