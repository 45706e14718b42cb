//! Messages for Foxglove and Lichtblick beside the exact ones: a thinned cloud and the colour
//! image at a reduced rate, the boxes of the tracked objects, the pose of the camera.

mod boxes;
mod image;
mod points;

use crate::queued_message::{Content, QueuedMessage};
use foxglove::Encode;
use foxglove::messages::{
    CompressedImage, FrameTransform, FrameTransforms, PointCloud, Quaternion, SceneUpdate,
    Timestamp, Vector3,
};
use message::{CheckedFrame, WirePose};
use recording::{ChannelSpec, Error, MessageTime, RecordingWriter};
use std::io::Write;
use std::time::{Duration, Instant};

const POINTS: &str = "foxglove/points";
const IMAGE: &str = "foxglove/image";
const OBJECTS: &str = "foxglove/objects";
const TRANSFORMS: &str = "foxglove/transforms";

/// Name of the world frame.
const WORLD: &str = "world";
/// Name of the camera's frame: x right, y down, z forward.
const CAMERA: &str = "camera";

/// Writer of the messages for viewers.
pub(crate) struct FoxgloveView {
    /// Interval between two clouds and images.
    period: Duration,
    max_points: usize,
    /// Instant of the newest cloud, on the monotonic clock.
    newest: Option<Instant>,
    encoded: Vec<u8>,
}

impl FoxgloveView {
    /// View with `rate_hz` clouds and images a second; `None` at a rate of zero.
    pub(crate) fn new(rate_hz: f64, max_points: usize) -> Option<Self> {
        (rate_hz > 0.0).then(|| Self {
            period: Duration::try_from_secs_f64(1.0 / rate_hz).unwrap_or(Duration::MAX),
            max_points: max_points.max(1),
            newest: None,
            encoded: Vec::new(),
        })
    }

    /// Channels of the view.
    pub(crate) fn channels() -> Vec<ChannelSpec> {
        vec![
            channel::<PointCloud>(POINTS),
            channel::<CompressedImage>(IMAGE),
            channel::<SceneUpdate>(OBJECTS),
            channel::<FrameTransforms>(TRANSFORMS),
        ]
    }

    /// Writes what a viewer shows of a message.
    pub(crate) fn write<W: Write>(
        &mut self,
        writer: &mut RecordingWriter<W>,
        message: &QueuedMessage,
    ) -> Result<(), Error> {
        let time = MessageTime::at(message.received_ns);
        match &message.content {
            Content::Frame(frame) => {
                let (header, points) = (frame.header(), frame.items());
                let Ok(checked) = header.checked(points.len(), u64::MAX) else {
                    return Ok(());
                };
                self.write_message(writer, TRANSFORMS, time, &transforms(&checked, time))?;
                if !self.is_due(Instant::now()) {
                    return Ok(());
                }
                let cloud = points::cloud(points, self.max_points, timestamp(time));
                self.write_message(writer, POINTS, time, &cloud)?;
                match image::compressed(points, &checked.camera, timestamp(time)) {
                    Some(image) => self.write_message(writer, IMAGE, time, &image),
                    None => Ok(()),
                }
            }
            Content::Scene(_, objects) => {
                let update = boxes::update(objects, timestamp(time));
                self.write_message(writer, OBJECTS, time, &update)
            }
            _ => Ok(()),
        }
    }

    /// True if a cloud is due, whose instant is then noted.
    fn is_due(&mut self, now: Instant) -> bool {
        let is_due = |newest: Instant| now.saturating_duration_since(newest) >= self.period;
        let is_due = self.newest.is_none_or(is_due);
        if is_due {
            self.newest = Some(now);
        }
        is_due
    }

    fn write_message<W: Write, M: Encode>(
        &mut self,
        writer: &mut RecordingWriter<W>,
        topic: &str,
        time: MessageTime,
        message: &M,
    ) -> Result<(), Error> {
        self.encoded.clear();
        // A growing buffer has room for any message.
        if message.encode(&mut self.encoded).is_err() {
            return Ok(());
        }
        writer.write(topic, time, &self.encoded)
    }
}

fn channel<M: Encode>(topic: &str) -> ChannelSpec {
    let schema = M::get_schema();
    let (name, data) = schema.map_or_else(Default::default, |s| (s.name, s.data.into_owned()));
    ChannelSpec::protobuf(topic, &name, data)
}

fn timestamp(time: MessageTime) -> Timestamp {
    const NS_PER_S: u64 = 1_000_000_000;
    let seconds = u32::try_from(time.log_ns / NS_PER_S).unwrap_or(u32::MAX);
    let rest_ns = (time.log_ns % NS_PER_S) as u32;
    Timestamp::new_checked(seconds, rest_ns).unwrap_or(Timestamp::MAX)
}

fn vector([x, y, z]: [f64; 3]) -> Vector3 {
    Vector3 { x, y, z }
}

fn quaternion([x, y, z, w]: [f64; 4]) -> Quaternion {
    Quaternion { x, y, z, w }
}

/// Pose of the camera in the world; without a known pose the world is the camera's frame.
fn transforms(frame: &CheckedFrame, time: MessageTime) -> FrameTransforms {
    let pose = WirePose::from(&frame.world_from_camera.unwrap_or_default());
    FrameTransforms {
        transforms: vec![FrameTransform {
            timestamp: Some(timestamp(time)),
            parent_frame_id: WORLD.into(),
            child_frame_id: CAMERA.into(),
            translation: Some(vector(pose.position_m)),
            rotation: Some(quaternion(pose.orientation_xyzw)),
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_have_the_schemas_that_viewers_know() {
        let names: Vec<_> = FoxgloveView::channels()
            .into_iter()
            .map(|channel| {
                assert!(!channel.schema.is_empty());
                channel.schema_name
            })
            .collect();
        let expected = [
            "PointCloud",
            "CompressedImage",
            "SceneUpdate",
            "FrameTransforms",
        ];
        assert_eq!(names, expected.map(|name| format!("foxglove.{name}")));
    }

    #[test]
    fn clouds_come_at_the_rate_of_the_monotonic_clock() {
        let mut view = FoxgloveView::new(2.0, 100).unwrap();
        let start = Instant::now();
        let due: Vec<bool> = [0, 499, 500, 600, 1000]
            .map(|ms| view.is_due(start + Duration::from_millis(ms)))
            .into();
        assert_eq!(due, [true, false, true, false, true]);
        // A rate close to zero has a period longer than any duration.
        assert!(FoxgloveView::new(1e-300, 100).unwrap().is_due(start));
    }

    #[test]
    fn view_can_be_switched_off() {
        assert!(FoxgloveView::new(0.0, 100).is_none());
        assert_eq!(FoxgloveView::new(2.0, 0).unwrap().max_points, 1);
    }
}
