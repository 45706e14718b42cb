//! Raw images during capture: asked for and sent only while somebody subscribes.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use capture::{
    CaptureLoop, DepthPixels, FrameInfo, FramePace, FrameSize, Source, SourceError, SourceImages,
};
use channel::topic::{CameraCloud, CameraImages};
use channel::{Domain, Role, RunFolder, Subscriber};
use geometry::PinholeCamera;
use message::{FrameHeader, ProcessKind};
use point_cloud::{Point, Rgba};
use service::{Context, HealthCounters, Home, Shutdown};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};

const SIZE: FrameSize = FrameSize {
    width: 4,
    height: 3,
};
const N_FRAMES: usize = 5;
/// Depth of the points and of the depth image in a frame.
const DEPTH_MM: u16 = 1250;

/// Source of a few equal frames that counts how often its images are asked for.
struct CountingSource {
    n_filled: usize,
    n_asked: Arc<AtomicU32>,
    depth_mm: Vec<u16>,
    color_rgb: Vec<u8>,
    has_images: bool,
    subscribers: Subscribers,
    received: Sender<ReceivedFrame>,
}

/// Subscribers of the test, which receive while the publishers live.
struct Subscribers {
    clouds: Subscriber<CameraCloud>,
    images: Option<Subscriber<CameraImages>>,
}

/// Session and sequence of a frame, and its images.
#[derive(Debug, PartialEq)]
struct ReceivedFrame {
    frame: (u64, u64),
    images: Option<ReceivedImages>,
}

/// Session, sequence and pixels of received images.
#[derive(Debug, PartialEq)]
struct ReceivedImages {
    frame: (u64, u64),
    depth_mm: Vec<u16>,
    color_rgb: Vec<[u8; 3]>,
}

impl Subscribers {
    fn receive(&mut self) -> ReceivedFrame {
        let cloud = self.clouds.latest().unwrap().unwrap();
        let newest = |images: &mut Subscriber<CameraImages>| images.latest().unwrap();
        let images = self.images.as_mut().and_then(newest).map(|message| {
            let header = message.header();
            let checked = header.checked(message.items().len()).unwrap();
            assert!(checked.is_registered);
            ReceivedImages {
                frame: (header.session, header.sequence),
                depth_mm: checked.depth_mm(message.items()).collect(),
                color_rgb: checked.color_rgb(message.items()).to_vec(),
            }
        });
        let header = cloud.header();
        ReceivedFrame {
            frame: (header.session, header.sequence),
            images,
        }
    }
}

fn camera() -> PinholeCamera {
    PinholeCamera {
        fx_px: 4.0,
        fy_px: 4.0,
        cx_px: 1.5,
        cy_px: 1.0,
        width: SIZE.width as u32,
        height: SIZE.height as u32,
    }
}

impl Source for CountingSource {
    fn name(&self) -> &'static str {
        "the counting source"
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(1000.0)
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        Ok((self.n_filled < N_FRAMES).then_some(SIZE))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        self.n_filled += 1;
        points.fill(Point {
            z: f32::from(DEPTH_MM) * 0.001,
            color: Rgba::opaque(1, 2, 3),
            ..Point::default()
        });
        Ok(FrameInfo {
            camera: camera(),
            is_calibrated: true,
            world_from_camera: None,
            up_in_camera: None,
            source_frame: self.n_filled,
            captured_ns: None,
        })
    }

    fn images(&self) -> Option<SourceImages<'_>> {
        self.n_asked.fetch_add(1, Ordering::Relaxed);
        self.has_images.then_some(SourceImages {
            depth: DepthPixels::Units {
                pixels: &self.depth_mm,
                unit_mm: 1.0,
            },
            color_rgb: &self.color_rgb,
            depth_camera: camera(),
            color_camera: camera(),
            color_from_depth: None,
        })
    }

    fn after_send(&mut self, _header: &FrameHeader) -> Result<(), SourceError> {
        self.received.send(self.subscribers.receive()).unwrap();
        Ok(())
    }
}

static N_DOMAINS: AtomicU32 = AtomicU32::new(0);

/// Captures all frames; returns how often the images were asked for, and what was received.
fn capture(is_subscribed: bool, has_images: bool) -> (usize, Vec<ReceivedFrame>) {
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    let number = N_DOMAINS.fetch_add(1, Ordering::Relaxed);
    let name = format!("i{}-{number}", std::process::id()).parse().unwrap();
    let run_folder = RunFolder::at(folder.path().to_owned());
    let domain = Domain::join(&name, &run_folder, Role::Guest).unwrap();
    let subscribers = Subscribers {
        clouds: Subscriber::polled(&domain).unwrap(),
        images: is_subscribed.then(|| Subscriber::polled(&domain).unwrap()),
    };
    let n_asked = Arc::new(AtomicU32::new(0));
    let (sender, received) = channel();
    let source = Box::new(CountingSource {
        n_filled: 0,
        n_asked: n_asked.clone(),
        depth_mm: vec![DEPTH_MM; SIZE.n_points()],
        color_rgb: [1, 2, 3].repeat(SIZE.n_points()),
        has_images,
        subscribers,
        received: sender,
    });
    let context = Context {
        process: ProcessKind::CAMERA,
        domain,
        home: Home::at(folder.path().join("home")),
        shutdown: Shutdown::new().1,
        health: Arc::new(HealthCounters::default()),
    };
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let capture = CaptureLoop::new(
        context,
        source,
        FramePace::Schedule,
        runtime.handle().clone(),
    )
    .unwrap();
    capture.run().unwrap();
    let n_asked = n_asked.load(Ordering::Relaxed) as usize;
    (n_asked, received.try_iter().collect())
}

#[test]
fn images_are_not_asked_for_without_a_subscriber() {
    let (n_asked, received) = capture(false, true);
    assert_eq!((n_asked, received.len()), (0, N_FRAMES));
    assert!(received.iter().all(|frame| frame.images.is_none()));
}

#[test]
fn images_belong_to_the_cloud_of_their_frame() {
    for has_images in [false, true] {
        let (n_asked, received) = capture(true, has_images);
        assert_eq!((n_asked, received.len()), (N_FRAMES, N_FRAMES));
        for ReceivedFrame { frame, images } in received {
            let expected = ReceivedImages {
                frame,
                depth_mm: vec![DEPTH_MM; SIZE.n_points()],
                color_rgb: vec![[1, 2, 3]; SIZE.n_points()],
            };
            assert_eq!(images, Some(expected), "own images: {has_images}");
        }
    }
}
