use super::*;
use message::frame_flag;
use mutation_fuzzing::{assert_sentence, fuzz, truncations};
use proptest::prelude::*;
use std::path::Path;
use test_data::golden;

fn camera(width: u32, height: u32) -> PinholeCamera {
    PinholeCamera {
        fx_px: 20.0,
        fy_px: 21.0,
        cx_px: 3.25,
        cy_px: 2.5,
        width,
        height,
    }
}

fn header(camera: &PinholeCamera) -> FrameHeader {
    let mut header = FrameHeader {
        flags: frame_flag::HAS_UP | frame_flag::HAS_WORLD_POSE | frame_flag::LOCKSTEP,
        session: u64::MAX,
        sequence: 2,
        source_frame: 3,
        capture_stamp_ns: 4,
        scheduled_stamp_ns: 5,
        published_stamp_ns: 6,
        wall_clock_offset_ns: -7,
        up_in_camera: [0.0, -1.0, 0.0],
        source_name: Text::truncated("küche"),
        ..FrameHeader::default()
    };
    header.world_from_camera.rows[1][3] = 0.1;
    header.set_camera(camera);
    header
}

/// Points on their rays, as a source computes them.
fn on_rays(camera: &PinholeCamera) -> Vec<CloudPoint> {
    let rays = Rays::new(camera);
    let pixels = rays.x_of_pixels().zip(rays.y_of_pixels()).enumerate();
    pixels
        .map(|(i, (x, y))| {
            let z = if i % 5 == 0 {
                f32::NAN
            } else {
                0.5 + i as f32 * 0.013
            };
            CloudPoint {
                x: x * z,
                y: y * z,
                z,
                argb: 0xff00_0000 + i as u32,
            }
        })
        .collect()
}

fn encoded(header: &FrameHeader, points: &[CloudPoint]) -> Vec<u8> {
    let mut bytes = vec![1, 2, 3];
    encode_frame(header, points, &mut bytes).unwrap();
    bytes
}

fn bits(points: &[CloudPoint]) -> Vec<[u32; 4]> {
    let bits = |p: &CloudPoint| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.argb];
    points.iter().map(bits).collect()
}

/// Asserts that header and points come back to the bit; returns the number of planes of x and y.
fn check_round_trip(header: &FrameHeader, points: &[CloudPoint]) -> usize {
    let bytes = encoded(header, points);
    let frame = FrameRecord::parse(&bytes).unwrap();
    assert_eq!(frame.header, *header);
    let mut read = vec![CloudPoint::default(); frame.n_points()];
    frame.fill(&mut read).unwrap();
    assert_eq!(bits(&read), bits(points));
    usize::from(frame.x.is_some()) + usize::from(frame.y.is_some())
}

#[test]
fn frame_on_its_rays_needs_depth_and_colour_only() {
    let camera = camera(8, 6);
    assert_eq!(check_round_trip(&header(&camera), &on_rays(&camera)), 0);
}

#[test]
fn frame_beside_its_rays_keeps_the_differing_coordinate() {
    let camera = camera(8, 6);
    let mut points = on_rays(&camera);
    points[11].x += 1e-6;
    assert_eq!(check_round_trip(&header(&camera), &points), 1);
    points[12].y = f32::INFINITY;
    assert_eq!(check_round_trip(&header(&camera), &points), 2);
}

/// Bytes of a frame, and what they are read as.
type PinnedFrame = (FrameHeader, Vec<[u32; 4]>);

/// Frames with planes of depth, a table of depths, and coordinates beside their rays.
fn pinned_frames() -> [(&'static str, PinnedFrame); 3] {
    let camera = camera(4, 3);
    let header = header(&camera);
    let planes = on_rays(&camera);
    let mut table = planes.clone();
    for (point, ray) in table.iter_mut().zip(Rays::new(&camera).x_of_pixels()) {
        (point.x, point.z) = (ray * 0.5, 0.5);
    }
    let mut beside_rays = planes.clone();
    (beside_rays[6].x, beside_rays[7].y) = (1.0, f32::INFINITY);
    [
        ("planes", (header, bits(&planes))),
        ("table", (header, bits(&table))),
        ("beside rays", (header, bits(&beside_rays))),
    ]
}

#[test]
fn golden_frames_are_written_and_read() {
    let point = |&[x, y, z, argb]: &[u32; 4]| {
        let [x, y, z] = [x, y, z].map(f32::from_bits);
        CloudPoint { x, y, z, argb }
    };
    golden::check(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/frame.txt"),
        &pinned_frames(),
        |(header, points)| {
            let points: Vec<_> = points.iter().map(point).collect();
            let mut bytes = Vec::new();
            encode_frame(header, &points, &mut bytes).unwrap();
            bytes
        },
        |bytes| {
            let frame = FrameRecord::parse(bytes).unwrap();
            let mut points = vec![CloudPoint::default(); frame.n_points()];
            frame.fill(&mut points).unwrap();
            (frame.header, bits(&points))
        },
    );
}

proptest! {
    #[test]
    fn frame_of_any_bits_comes_back(words: [[u32; 4]; 6]) {
        let points = words.map(|[x, y, z, argb]| {
            let [x, y, z] = [x, y, z].map(f32::from_bits);
            CloudPoint { x, y, z, argb }
        });
        check_round_trip(&header(&camera(3, 2)), &points);
    }
}

#[test]
fn frame_with_an_impossible_header_is_not_encoded() {
    let good = header(&camera(8, 6));
    let mut out = Vec::new();
    assert!(encode_frame(&good, &[CloudPoint::default(); 47], &mut out).is_err());
}

#[test]
fn fuzz_frames() {
    let camera = camera(8, 6);
    let plain = encoded(&header(&camera), &on_rays(&camera));
    let mut points = on_rays(&camera);
    points[3].x = 0.0;
    points[3].y = 0.0;
    let both = encoded(&header(&camera), &points);
    for bytes in truncations(&plain) {
        assert!(FrameRecord::parse(&bytes).is_err());
    }
    fuzz(&[plain, both], |bytes| match FrameRecord::parse(bytes) {
        Ok(frame) => {
            let mut points = vec![CloudPoint::default(); frame.n_points()];
            frame.fill(&mut points).unwrap();
            assert!(frame.n_points() * 6 <= bytes.len());
        }
        Err(error) => assert_sentence(&error),
    });
}
