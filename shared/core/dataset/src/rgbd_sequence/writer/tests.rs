use super::*;
use crate::rgbd_sequence::{
    RgbdSequence, Scratch, decode_color, decode_depth, decode_mask, depth_image_size,
};
use mutation_fuzzing::{assert_sentence, flipped_bits, truncations};
use nalgebra::{Unit, Vector3};
use point_cloud::Point;
use proptest::prelude::*;
use std::fs;

const SIZE: (u32, u32) = (16, 8);
const N_PIXELS: usize = 128;
const CAMERA: PinholeCamera = PinholeCamera {
    fx_px: 16.1,
    fy_px: 15.9,
    cx_px: 7.512_345_678_901_234,
    cy_px: 3.5,
    width: SIZE.0,
    height: SIZE.1,
};

/// Content of one frame.
#[derive(Debug, Clone)]
struct FrameContent {
    color: Vec<u8>,
    depth_mm: Vec<u16>,
    instances: Option<Vec<u16>>,
    world_from_camera: Option<RigidTransform>,
    truth: Option<Vec<u8>>,
}

impl FrameContent {
    fn view(&self) -> FrameView<'_> {
        FrameView {
            color: &self.color,
            depth_mm: &self.depth_mm,
            instances: self.instances.as_deref(),
            world_from_camera: self.world_from_camera,
            truth: self.truth.as_deref(),
        }
    }
}

fn content() -> impl Strategy<Value = FrameContent> {
    let pixels = || prop::collection::vec(any::<u16>(), N_PIXELS);
    let vector = |limit: f64| prop::array::uniform3(-limit..limit).prop_map(Vector3::from);
    let pose = (vector(1e5), vector(3.0)).prop_map(|(t, axis)| RigidTransform::new(t, axis));
    (
        prop::collection::vec(any::<u8>(), 3 * N_PIXELS),
        pixels(),
        prop::option::of(pixels()),
        prop::option::of(pose),
        prop::option::of(any::<Vec<u8>>()),
    )
        .prop_map(
            |(color, depth_mm, instances, world_from_camera, truth)| FrameContent {
                color,
                depth_mm,
                instances,
                world_from_camera,
                truth,
            },
        )
}

fn plain() -> FrameContent {
    FrameContent {
        color: vec![7; 3 * N_PIXELS],
        depth_mm: vec![1000; N_PIXELS],
        instances: Some(vec![3; N_PIXELS]),
        world_from_camera: Some(RigidTransform::translation(1.0, 2.0, 3.0)),
        truth: Some(b"{}".to_vec()),
    }
}

/// Compares a frame of the sequence with the written content.
fn check_frame(sequence: &RgbdSequence, index: usize, written: &FrameContent) {
    let (mut scratch, mut instances, mut truth) = (Scratch::default(), vec![1], vec![1]);
    let mut points = vec![Point::default(); N_PIXELS];
    let pose = sequence.fill(index, &mut scratch, &mut points).unwrap();
    assert_eq!(scratch.depth, written.depth_mm);
    for (point, rgb) in points.iter().zip(written.color.as_chunks().0) {
        assert_eq!(point.color.rgb(), *rgb);
    }
    assert_eq!(pose.is_some(), written.world_from_camera.is_some());
    for (read, pose) in pose.iter().zip(&written.world_from_camera) {
        assert_eq!(read.translation, pose.translation);
        assert!(read.rotation.angle_to(&pose.rotation) < 1e-7);
        let difference = read.to_homogeneous() - pose.to_homogeneous();
        assert!(difference.amax() < 1e-14, "{difference}");
    }
    let has_mask = sequence.read_mask(index, &mut scratch, &mut instances);
    assert_eq!(has_mask.unwrap(), written.instances.is_some());
    assert_eq!(instances, written.instances.clone().unwrap_or_default());
    let has_truth = sequence.read_truth(index, &mut truth).unwrap();
    assert_eq!(has_truth.then_some(truth), written.truth);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn written_frames_are_played(
        frames in prop::collection::vec(content(), 1..4),
        down in prop::option::of(prop::array::uniform3(0.1..1.0)),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let down = down.map(|down| Unit::new_normalize(Vector3::from(down)));
        let mut writer = SequenceWriter::create(folder.path(), &CAMERA, down).unwrap();
        for frame in &frames {
            writer.write(&frame.view()).unwrap();
        }
        prop_assert_eq!(writer.n_frames(), frames.len());
        let sequence = RgbdSequence::open(folder.path()).unwrap();
        prop_assert_eq!(sequence.camera(), &CAMERA);
        prop_assert_eq!(sequence.gravity_in_world().is_some(), down.is_some());
        for (read, down) in sequence.gravity_in_world().iter().zip(&down) {
            prop_assert!((**read - **down).amax() < 1e-15);
        }
        prop_assert_eq!(sequence.n_frames(), frames.len());
        for (index, frame) in frames.iter().enumerate() {
            check_frame(&sequence, index, frame);
        }
    }
}

#[test]
fn the_files_are_those_of_a_recorded_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("new/folder");
    let down = Some(Vector3::z_axis());
    let mut writer = SequenceWriter::create(&target, &CAMERA, down).unwrap();
    writer.write(&plain().view()).unwrap();
    let names = file_names(&target, |_| true).unwrap();
    assert_eq!(
        names,
        [
            "camera-intrinsics.txt",
            "frame-000000.color.png",
            "frame-000000.depth.png",
            "frame-000000.mask.png",
            "frame-000000.pose.txt",
            "frame-000000.truth.json",
            "gravity-direction.txt",
        ]
    );
    let pose = fs::read_to_string(target.join("frame-000000.pose.txt")).unwrap();
    assert_eq!(pose, "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n");
    let kind = crate::detect_recording_kind(&target).unwrap();
    assert_eq!(kind, crate::RecordingKind::RgbdSequence);
}

#[test]
fn a_folder_with_a_sequence_is_refused() {
    for name in [
        "frame-000007.depth.png",
        "frame-1.color.jpg",
        "frame-1.truth.json",
        "camera-intrinsics.txt",
        "gravity-direction.txt",
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("notes.txt"), "these do not matter").unwrap();
        assert!(SequenceWriter::create(folder.path(), &CAMERA, None).is_ok());
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), "these do").unwrap();
        let error = SequenceWriter::create(folder.path(), &CAMERA, None).unwrap_err();
        assert!(matches!(error, Error::SequenceExists(_)), "{name}: {error}");
        assert_sentence(&error);
        assert_eq!(folder.path().read_dir().unwrap().count(), 1);
    }
}

#[test]
fn invalid_content_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let bad_camera = PinholeCamera {
        fx_px: f64::NAN,
        ..CAMERA
    };
    assert_sentence(&SequenceWriter::create(folder.path(), &bad_camera, None).unwrap_err());
    let mut writer = SequenceWriter::create(folder.path(), &CAMERA, None).unwrap();
    let mut cases = vec![plain(); 6];
    cases[0].color.pop();
    cases[1].depth_mm.push(0);
    cases[2].instances = Some(Vec::new());
    cases[3].world_from_camera = Some(RigidTransform::translation(f64::NAN, 0.0, 0.0));
    cases[4].world_from_camera = Some(RigidTransform::translation(2e6, 0.0, 0.0));
    cases[5].truth = Some(vec![0; 1 + MAX_TRUTH_BYTES as usize]);
    for case in &cases {
        assert_sentence(&writer.write(&case.view()).unwrap_err());
        assert_eq!(writer.n_frames(), 0);
        assert!(RgbdSequence::open(folder.path()).is_err());
    }
    writer.write(&plain().view()).unwrap();
    check_frame(&RgbdSequence::open(folder.path()).unwrap(), 0, &plain());
}

/// A dangling link with the name of a file stops the writer as a kill would.
#[test]
fn an_interrupted_sequence_is_played_up_to_its_last_whole_frame() {
    let suffixes = [
        "mask.png",
        "truth.json",
        "pose.txt",
        "color.png",
        "depth.png",
    ];
    for (n_written, suffix) in suffixes.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = SequenceWriter::create(folder.path(), &CAMERA, None).unwrap();
        writer.write(&plain().view()).unwrap();
        let path = |suffix: &str| folder.path().join(format!("frame-000001.{suffix}"));
        std::os::unix::fs::symlink("nowhere", path(suffix)).unwrap();
        assert_sentence(&writer.write(&plain().view()).unwrap_err());
        let is_there = suffixes.map(|suffix| path(suffix).exists());
        assert_eq!(is_there, std::array::from_fn(|idx| idx < n_written));
        fs::remove_file(path(suffix)).unwrap();
        let sequence = RgbdSequence::open(folder.path()).unwrap();
        assert_eq!(sequence.n_frames(), 1);
        check_frame(&sequence, 0, &plain());

        // Leftover files of the frame do not become part of another.
        let other = FrameContent {
            instances: None,
            world_from_camera: None,
            truth: None,
            ..plain()
        };
        writer.write(&other.view()).unwrap();
        check_frame(&RgbdSequence::open(folder.path()).unwrap(), 1, &other);
    }
}

#[test]
fn a_color_image_within_the_sequence_needs_its_depth() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = SequenceWriter::create(folder.path(), &CAMERA, None).unwrap();
    for _ in 0..2 {
        writer.write(&plain().view()).unwrap();
    }
    fs::remove_file(folder.path().join("frame-000000.depth.png")).unwrap();
    let error = RgbdSequence::open(folder.path()).unwrap_err();
    assert!(matches!(error, Error::Unpaired { .. }), "{error}");
    assert_sentence(&error);
}

#[test]
fn an_image_cut_or_flipped_anywhere_is_read_or_explained() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = SequenceWriter::create(folder.path(), &CAMERA, None).unwrap();
    let mut frame = plain();
    for (idx, value) in frame.color.iter_mut().enumerate() {
        *value = (idx * idx) as u8;
    }
    writer.write(&frame.view()).unwrap();
    let read = |suffix| fs::read(folder.path().join("frame-000000".to_owned() + suffix)).unwrap();
    let check = |file: &[u8]| {
        let results = [
            decode_color(file, SIZE).map(|color| assert_eq!(color.len(), 3 * N_PIXELS)),
            decode_depth(file, SIZE, &mut Vec::new()),
            decode_mask(file, SIZE, &mut Vec::new()),
            depth_image_size(file).map(|_| ()),
        ];
        results
            .into_iter()
            .filter_map(Result::err)
            .for_each(|error| assert_sentence(&error));
    };
    for suffix in [".color.png", ".depth.png", ".mask.png"] {
        let file = read(suffix);
        truncations(&file).for_each(|file| check(&file));
        flipped_bits(&file).for_each(|file| check(&file));
    }
    // Images of another format or size are rejected.
    for (wrong, size, reason) in [
        (read(".depth.png"), SIZE, "red, green and blue"),
        (read(".color.png"), (8, 8), "16x8"),
    ] {
        let error = decode_color(&wrong, size).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
}
