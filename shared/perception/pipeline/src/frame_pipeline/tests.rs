use super::*;
use geometry::RigidTransform;
use std::future::ready;
use tracking::{AssociationConfig, MotionConfig};

/// Executor that records the calls and finds nothing.
#[derive(Default)]
struct Recorder {
    calls: Vec<String>,
    expected: Vec<ExpectedTrack>,
    surfaces: Vec<Plane>,
    fails_to_detect: bool,
}

impl FrameExecutor for Recorder {
    type Detected = Detection;
    type Error = &'static str;

    fn stage_started(&mut self, stage: FrameStage) {
        self.calls.push(format!("{stage:?}"));
    }

    fn expected_tracks(&mut self) -> &mut Vec<ExpectedTrack> {
        &mut self.expected
    }

    fn expected_surfaces(&mut self) -> &mut Vec<Plane> {
        &mut self.surfaces
    }

    fn gather_priors(&mut self) -> Result<(), &'static str> {
        self.calls.push("gather".into());
        Ok(())
    }

    fn detect(&mut self) -> impl Future<Output = Result<Detection, &'static str>> + Send {
        self.calls.push("detect".into());
        ready(if self.fails_to_detect {
            Err("unusable")
        } else {
            Ok(Detection::default())
        })
    }

    fn detection(detected: &Detection) -> &Detection {
        detected
    }

    fn next_track_id(&mut self) -> Option<u64> {
        None
    }

    fn track_started(&mut self, _track_id: u64) {}

    fn track_ended(&mut self, _track_id: u64) {}

    fn observe(
        &mut self,
        _detected: &Detection,
        _sightings: &[Sighting],
        _tracks: ObservedTracks<'_>,
    ) -> impl Future<Output = Result<(), &'static str>> + Send {
        self.calls.push("observe".into());
        ready(Ok(()))
    }
}

fn process(recorder: &mut Recorder) -> Result<Detection, &'static str> {
    let config = Config::new(MotionConfig::default(), AssociationConfig::default(), 0.5).unwrap();
    let frame = FramePose {
        capture_ns: 1,
        world_from_camera: RigidTransform::identity(),
        up_in_camera: None,
        camera: None,
    };
    let mut pipeline = FramePipeline::new(config);
    pipeline.process_now(&frame, &[], recorder).unwrap()
}

#[test]
fn stages_follow_each_other_in_the_documented_order() {
    let mut recorder = Recorder::default();
    process(&mut recorder).unwrap();
    let order = ["Priors", "gather", "detect", "Association", "observe"];
    assert_eq!(recorder.calls, order);
}

#[test]
fn failed_detection_ends_the_frame() {
    let mut recorder = Recorder {
        fails_to_detect: true,
        ..Recorder::default()
    };
    assert_eq!(process(&mut recorder), Err("unusable"));
    assert_eq!(recorder.calls, ["Priors", "gather", "detect"]);
}
