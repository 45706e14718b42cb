//! Raw images on `camera/image`: those of the frame whose cloud has the same session and
//! sequence, from each kind of source.

use crate::daemon::{Sandbox, WATCHDOG};
use crate::fakenect;
use channel::topic::{CameraCloud, CameraImages};
use channel::{Domain, Received, Role, SharedMessage, Subscriber};
use message::{CheckedImages, CloudPoint, FrameHeader};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Number of frames that are compared.
const N_FRAMES: usize = 5;
/// Largest difference between the depth of a pixel and its point, metres: rounding to whole
/// millimetres.
const ROUNDING_M: f32 = 0.000_51;

/// Cloud copied out of shared memory.
struct Cloud {
    header: FrameHeader,
    points: Vec<CloudPoint>,
}

/// Guest that pairs clouds and images.
struct ImageWatcher {
    clouds: Subscriber<CameraCloud>,
    images: Subscriber<CameraImages>,
    waiting: BTreeMap<(u64, u64), Cloud>,
    n_compared: usize,
}

impl ImageWatcher {
    fn new(sandbox: &Sandbox) -> Self {
        let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
        Self {
            clouds: Subscriber::polled(&domain).unwrap(),
            images: Subscriber::polled(&domain).unwrap(),
            waiting: BTreeMap::new(),
            n_compared: 0,
        }
    }

    /// Compares frames until there were enough.
    fn watch(&mut self, compare: impl Fn(&Cloud, &CheckedImages, &[u8])) {
        let deadline = Instant::now() + WATCHDOG;
        while self.n_compared < N_FRAMES {
            assert!(Instant::now() < deadline, "{} compared", self.n_compared);
            self.take_clouds();
            // The images of a frame follow its cloud, so that it is there.
            while let Received::Message(images) = self.images.receive().unwrap() {
                self.take_clouds();
                self.compare(&images, &compare);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn take_clouds(&mut self) {
        while let Received::Message(cloud) = self.clouds.receive().unwrap() {
            let header = *cloud.header();
            let points = cloud.items().to_vec();
            let frame = (header.session, header.sequence);
            self.waiting.insert(frame, Cloud { header, points });
            while self.waiting.len() > 4 {
                self.waiting.pop_first();
            }
        }
    }

    fn compare(
        &mut self,
        images: &SharedMessage<CameraImages>,
        compare: impl Fn(&Cloud, &CheckedImages, &[u8]),
    ) {
        let header = images.header();
        let checked = header.checked(images.items().len()).unwrap();
        let Some(cloud) = self.waiting.remove(&(header.session, header.sequence)) else {
            return;
        };
        assert_eq!(header.capture_stamp_ns, cloud.header.capture_stamp_ns);
        let frame = cloud.header.checked(cloud.points.len(), u64::MAX).unwrap();
        assert_eq!(checked.depth_camera, frame.camera);
        assert_eq!(checked.world_from_camera, frame.world_from_camera);
        compare(&cloud, &checked, images.items());
        self.n_compared += 1;
    }
}

/// Asserts that each depth pixel is the depth of its point, and none where there is none.
fn check_depth(cloud: &Cloud, images: &CheckedImages, payload: &[u8]) {
    let mut n_with_depth = 0;
    for (depth_mm, point) in images.depth_mm(payload).zip(&cloud.points) {
        if depth_mm == 0 {
            assert!(!point.z.is_finite(), "{point:?}");
            continue;
        }
        n_with_depth += 1;
        let difference_m = (f32::from(depth_mm) * 0.001 - point.z).abs();
        assert!(difference_m < ROUNDING_M, "{depth_mm} mm, {point:?}");
    }
    assert!(n_with_depth > cloud.points.len() / 4, "{n_with_depth}");
}

/// Asserts that both images show what the cloud shows, pixel by pixel.
fn check_registered(cloud: &Cloud, images: &CheckedImages, payload: &[u8]) {
    assert!(images.is_registered);
    check_depth(cloud, images, payload);
    for (&[red, green, blue], point) in images.color_rgb(payload).iter().zip(&cloud.points) {
        let [_, r, g, b] = point.argb.to_be_bytes();
        assert_eq!([red, green, blue], [r, g, b]);
    }
}

/// Watches a source with an image for each point.
fn check_registered_source(arguments: &[&str]) {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(arguments);
    let mut watcher = ImageWatcher::new(&sandbox);
    watcher.watch(check_registered);
    drop(watcher);
    daemon.stop();
}

#[test]
fn images_of_the_synthetic_table_are_those_of_its_cloud() {
    check_registered_source(&["--source", "synthetic:0"]);
}

#[test]
fn images_of_the_simulation_are_those_of_its_cloud() {
    check_registered_source(&["--source", "simulation:isolated"]);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn images_of_a_recorded_sequence_are_those_of_its_cloud() {
    let folder = test_data::path("kitchen-sequence");
    let source = folder.to_str().unwrap();
    check_registered_source(&["--source", source, "--loop"]);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn images_of_pcd_scenes_are_those_of_their_clouds() {
    let folder = test_data::path("tabletop-scenes");
    let source = folder.to_str().unwrap();
    check_registered_source(&["--source", source, "--loop", "--rate", "5"]);
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn images_of_a_kinect_are_those_of_its_two_cameras() {
    let scene = fakenect::KinectScene::new(0);
    let folder = fakenect::recording(&scene);
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", &fakenect::source(&folder), "--loop"]);
    let mut watcher = ImageWatcher::new(&sandbox);
    let rendered = scene.color().rgb;
    watcher.watch(|cloud, images, payload| {
        assert!(!images.is_registered);
        assert_eq!(images.color_camera, scene.calibration.color_camera);
        let error = images.color_from_depth.inverse() * scene.calibration.color_from_depth;
        assert!(error.translation.vector.norm() < 1e-9);
        check_depth(cloud, images, payload);
        assert_eq!(images.color_rgb(payload).as_flattened(), rendered);
    });
    drop(watcher);
    daemon.stop();
}
