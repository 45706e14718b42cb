//! Frame source that renders the simulated table.

use crate::arm_orders::{OrderSender, Snapshot};
use crate::world_publishers::WorldPublishers;
use capture::{FrameInfo, FrameSize, IdleUpdate, Source, SourceError};
use geometry::PinholeCamera;
use message::FrameHeader;
use nalgebra::{Unit, Vector3};
use point_cloud::Point;
use simulated_world::{ObjectTruth, SimulatedKinect, World};

/// Endless frame source of a simulated world.
pub(crate) struct SimulatorSource {
    name: String,
    rate_hz: f64,
    arm_loop: OrderSender,
    kinect: SimulatedKinect,
    /// World at the end of the frame interval; `None` between two frames.
    snapshot: Option<Snapshot>,
    truth: Vec<ObjectTruth>,
    world_publishers: WorldPublishers,
    /// End of the interval that the arm's loop knows, monotonic, nanoseconds.
    known_end_ns: Option<u64>,
}

impl SimulatorSource {
    /// Source of the world that the arm's loop owns.
    pub(crate) fn new(
        name: String,
        rate_hz: f64,
        kinect: SimulatedKinect,
        arm_loop: OrderSender,
        world_publishers: WorldPublishers,
    ) -> Self {
        Self {
            name,
            rate_hz,
            arm_loop,
            kinect,
            snapshot: None,
            truth: Vec::new(),
            world_publishers,
            known_end_ns: None,
        }
    }

    /// Renders the simulated world at the end of the frame interval.
    fn look(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let Snapshot { world, frame } = self.snapshot.as_ref().ok_or_else(no_world)?;
        let seen = self.kinect.look(world, *frame, points);
        self.truth = seen.map_err(|error| SourceError::Unusable(error.to_string()))?;
        let world_from_camera = world.world_from_camera();
        Ok(FrameInfo {
            camera: *self.kinect.camera(),
            is_calibrated: true,
            up_in_camera: Some(Unit::new_normalize(
                world_from_camera.rotation.inverse() * Vector3::z(),
            )),
            world_from_camera: Some(world_from_camera),
            source_frame: *frame as usize - 1,
            captured_ns: None,
        })
    }
}

/// Camera of a world, warmed up: the first views render the room, which no frame shall wait for.
///
/// # Errors
/// When the scene cannot be rendered.
pub(crate) fn warm_camera(world: &World) -> Result<SimulatedKinect, simulated_world::Error> {
    let mut kinect = SimulatedKinect::new(world, PinholeCamera::KINECT_V1)?;
    let mut points = vec![Point::default(); kinect.camera().n_pixels()];
    for _ in 0..2 {
        kinect.look(world, 0, &mut points)?;
    }
    Ok(kinect)
}

fn no_world() -> SourceError {
    SourceError::Unavailable("a frame was to be rendered before its world was simulated".into())
}

impl Source for SimulatorSource {
    fn name(&self) -> &str {
        &self.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.rate_hz)
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        // Returned first, so that the world need not be cloned.
        self.snapshot = None;
        self.known_end_ns = None;
        self.snapshot = Some(self.arm_loop.advance()?);
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
        if self.known_end_ns != Some(due_ns) {
            self.arm_loop.ends_at(due_ns)?;
            self.known_end_ns = Some(due_ns);
        }
        let Some(changed) = self.arm_loop.changed() else {
            return Ok(IdleUpdate::default());
        };
        self.snapshot = Some(changed);
        Ok(IdleUpdate {
            rewritten: points.map(|points| self.look(points)).transpose()?,
            next_call_ns: None,
        })
    }

    fn before_send(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        self.arm_loop.close(header.capture_stamp_ns)?;
        let snapshot = self.snapshot.as_ref().ok_or_else(no_world)?;
        Ok(self.world_publishers.person(header, &snapshot.world)?)
    }

    fn after_send(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        Ok(self
            .world_publishers
            .truth(header, &self.truth, self.kinect.mask())?)
    }
}
