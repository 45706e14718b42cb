use super::*;
use mutation_fuzzing::{assert_sentence, corruption};
use proptest::prelude::*;
use std::fs;
use tempfile::TempDir;

const SIZE: (u32, u32) = (16, 8);
const N_PIXELS: usize = 128;
const INTRINSICS: &str = "16.0 0 7.5\n0 16 3.5\n0 0 1\n";
const POSE: &str = "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n";

fn depth_png(size: (u32, u32), depth_mm: &[u16]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size.0, size.1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    let bytes: Vec<u8> = depth_mm
        .iter()
        .flat_map(|depth| depth.to_be_bytes())
        .collect();
    writer.write_image_data(&bytes).unwrap();
    writer.finish().unwrap();
    file
}

/// JPEG image: grey on the left, red on the right.
fn color_jpg() -> Vec<u8> {
    test_flat_jpeg::encode(2, 1, &[[100, 128, 128], [76, 85, 255]])
}

fn depth() -> impl Strategy<Value = Vec<u16>> {
    let pixel = prop_oneof![Just(0), Just(u16::MAX), Just(1), Just(65534), any::<u16>()];
    prop::collection::vec(pixel, N_PIXELS)
}

/// Sequence folder with three frames; the second has no pose.
fn sequence(depth_mm: &[u16]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &[u8]| fs::write(folder.path().join(name), content).unwrap();
    write("camera-intrinsics.txt", INTRINSICS.as_bytes());
    for frame in ["frame-9", "frame-000010", "frame-000011"] {
        write(&format!("{frame}.depth.png"), &depth_png(SIZE, depth_mm));
        write(&format!("{frame}.color.jpg"), &color_jpg());
    }
    write("frame-9.pose.txt", POSE.as_bytes());
    write("frame-000011.pose.txt", POSE.as_bytes());
    write("notes.txt", b"not part of it");
    folder
}

proptest! {
    #[test]
    fn a_depth_image_is_decoded_as_encoded(depth in depth()) {
        let mut decoded = vec![7; 3];
        decode_depth(&depth_png(SIZE, &depth), SIZE, &mut decoded).unwrap();
        prop_assert_eq!(decoded, depth);
    }

    #[test]
    fn a_point_projects_to_its_pixel_at_its_depth(depth in depth()) {
        let camera = parse_intrinsics(INTRINSICS.as_bytes(), SIZE).unwrap();
        let color: Vec<u8> = (0..3 * N_PIXELS).map(|value| value as u8).collect();
        let mut out = vec![Point::default(); N_PIXELS];
        BackProjection::new(&camera).fill(&depth, &color, &mut out).unwrap();
        for (pixel, (point, &mm)) in out.iter().zip(&depth).enumerate() {
            prop_assert_eq!(&point.color.rgb(), &color[3 * pixel..3 * pixel + 3]);
            if mm == 0 || mm == u16::MAX {
                prop_assert!(point.x.is_nan() && point.y.is_nan() && point.z.is_nan());
                continue;
            }
            let expected = f64::from(mm) / 1000.0;
            prop_assert!((f64::from(point.z) - expected).abs() < 1e-6 * expected);
            let projected = camera.project(&point.position()).unwrap();
            prop_assert!((projected.x - (pixel % 16) as f64).abs() < 1e-4);
            prop_assert!((projected.y - (pixel / 16) as f64).abs() < 1e-4);
        }
    }

    #[test]
    fn a_pose_is_read_as_written(axis in any::<[i8; 3]>(), t in prop::array::uniform3(-1e3..1e3)) {
        let axis = Vector3::from(axis.map(|component| f64::from(component) / 50.0));
        let pose = RigidTransform::new(Vector3::from(t), axis);
        // As in the sequences: about seven digits.
        let matrix = pose.to_homogeneous();
        let text: String = matrix.row_iter().fold(String::new(), |text, row| {
            text + &format!("{:.6e} {:.6e} {:.6e} {:.9e}\n", row[0], row[1], row[2], row[3])
        });
        let read = parse_pose(text.as_bytes()).unwrap();
        prop_assert!(read.rotation.angle_to(&pose.rotation) < 1e-5);
        prop_assert!((read.translation.vector - pose.translation.vector).amax() < 1e-5);
        let rotation = read.rotation.to_rotation_matrix();
        let deviation = rotation.matrix().transpose() * rotation.matrix() - nalgebra::Matrix3::identity();
        prop_assert!(deviation.amax() < 1e-14);
    }

    #[test]
    fn damaged_files_are_read_or_explained(depth in depth(), corruption in corruption()) {
        let depth_file = corruption.apply(&depth_png(SIZE, &depth));
        let errors = [
            decode_depth(&depth_file, SIZE, &mut Vec::new()).err(),
            depth_image_size(&depth_file).err(),
            decode_color(&corruption.apply(&color_jpg()), SIZE).err(),
            parse_pose(&corruption.apply(POSE.as_bytes())).err(),
            parse_intrinsics(&corruption.apply(INTRINSICS.as_bytes()), SIZE).err(),
            parse_gravity(&corruption.apply(b"0 0.6 0.8")).err(),
        ];
        errors.iter().flatten().for_each(|error| assert_sentence(error));
    }

    #[test]
    fn arbitrary_bytes_are_explained(bytes in any::<Vec<u8>>()) {
        assert_sentence(&decode_depth(&bytes, SIZE, &mut Vec::new()).unwrap_err());
        assert_sentence(&decode_color(&bytes, SIZE).unwrap_err());
        assert_sentence(&parse_pose(&bytes).unwrap_err());
    }
}

#[test]
fn frames_come_in_natural_order_with_their_poses() {
    let depth_mm: Vec<u16> = (0..N_PIXELS as u16).map(|pixel| 100 * pixel).collect();
    let folder = sequence(&depth_mm);
    let sequence = RgbdSequence::open(folder.path()).unwrap();
    let names = (0..4).map(|index| sequence.name(index)).collect::<Vec<_>>();
    assert_eq!(
        names,
        [
            Some("frame-9"),
            Some("frame-000010"),
            Some("frame-000011"),
            None
        ]
    );
    assert_eq!(sequence.gravity_in_world(), None);
    let mut scratch = Scratch::default();
    let mut out = vec![Point::default(); N_PIXELS];
    let pose = sequence.fill(0, &mut scratch, &mut out).unwrap().unwrap();
    let moved = pose.transform_point(&nalgebra::Point3::new(1.0, 0.0, 0.0));
    assert!((moved - nalgebra::Point3::new(1.0, 3.0, 3.0)).norm() < 1e-12);
    assert_eq!(sequence.fill(1, &mut scratch, &mut out).unwrap(), None);
    assert!(out[0].z.is_nan() && (out[127].z - 12.7).abs() < 1e-5);
    let distance = |pixel: usize, wanted: [u8; 3]| {
        let pairs = out[pixel].color.rgb().into_iter().zip(wanted);
        pairs
            .map(|(left, right)| left.abs_diff(right))
            .max()
            .unwrap()
    };
    assert!(
        distance(3, [100; 3]) <= 2 && distance(12, [254, 0, 0]) <= 2,
        "{out:?}"
    );
}

#[test]
fn gravity_is_read_if_it_is_there() {
    let folder = sequence(&[0; N_PIXELS]);
    fs::write(
        folder.path().join("gravity-direction.txt"),
        "0\n0.6\n0.8001\n",
    )
    .unwrap();
    let gravity = RgbdSequence::open(folder.path())
        .unwrap()
        .gravity_in_world()
        .unwrap();
    assert!((gravity.norm() - 1.0).abs() < 1e-15 && (gravity.y - 0.6).abs() < 1e-3);
}

#[test]
fn a_wrong_folder_is_refused_with_its_reason() {
    let cases: [(&str, Option<&[u8]>, &str); 6] = [
        (
            "frame-9.color.jpg",
            None,
            "frame-9.depth.png has no companion",
        ),
        (
            "frame-000011.depth.png",
            None,
            "frame-000011.color.jpg has no companion",
        ),
        ("camera-intrinsics.txt", None, "could not read"),
        ("camera-intrinsics.txt", Some(b"1 2 3"), "9 finite numbers"),
        (
            "camera-intrinsics.txt",
            Some(b"16 1 8 0 16 4 0 0 1"),
            "form fx 0 cx",
        ),
        (
            "camera-intrinsics.txt",
            Some(b"16 0 8 0 -16 4 0 0 1"),
            "focal lengths",
        ),
    ];
    for (name, content, reason) in cases {
        let folder = sequence(&[0; N_PIXELS]);
        let path = folder.path().join(name);
        match content {
            Some(content) => fs::write(path, content).unwrap(),
            None => fs::remove_file(path).unwrap(),
        }
        let error = RgbdSequence::open(folder.path()).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error} / {reason}");
    }
    let empty = tempfile::tempdir().unwrap();
    assert!(matches!(
        RgbdSequence::open(empty.path()),
        Err(Error::NoFrames(_))
    ));
}

#[test]
fn a_wrong_frame_is_refused_with_its_reason() {
    let larger = depth_png((16, 9), &[0; 144]);
    let grey = {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 16, 8);
        encoder.set_color(png::ColorType::Grayscale);
        encoder
            .write_header()
            .unwrap()
            .write_image_data(&[0; N_PIXELS])
            .unwrap();
        file
    };
    let wide = test_flat_jpeg::encode(3, 1, &[[0; 3]; 3]);
    let bad_pose = |from: &str, to: &str| POSE.replacen(from, to, 1).into_bytes();
    let cases = [
        ("frame-000011.depth.png", larger, "16x9"),
        ("frame-000011.depth.png", grey, "16 bits"),
        ("frame-000011.color.jpg", wide, "24x8"),
        (
            "frame-000011.color.jpg",
            [0xff, 0xda].repeat(65),
            "64 scans",
        ),
        (
            "frame-000011.pose.txt",
            bad_pose("0 0 0 1", "0 0 1 1"),
            "last row",
        ),
        ("frame-000011.pose.txt", bad_pose("-1", "1"), "rotation"),
        ("frame-000011.pose.txt", bad_pose("-1", "-1.1"), "rotation"),
        ("frame-000011.pose.txt", bad_pose("-1", "nan"), "16 finite"),
        (
            "frame-000011.pose.txt",
            bad_pose(" 3\n", " 3e9\n"),
            "1000 km",
        ),
        (
            "frame-000011.pose.txt",
            bad_pose("1\n", "1 5\n"),
            "16 finite",
        ),
    ];
    let mut out = vec![Point::default(); N_PIXELS];
    for (name, content, reason) in cases {
        let folder = sequence(&[1000; N_PIXELS]);
        let sequence = RgbdSequence::open(folder.path()).unwrap();
        fs::write(folder.path().join(name), content).unwrap();
        assert!(sequence.fill(1, &mut Scratch::default(), &mut out).is_ok());
        let error = sequence
            .fill(2, &mut Scratch::default(), &mut out)
            .unwrap_err();
        assert_sentence(&error);
        let text = error.to_string();
        assert!(
            text.contains(reason) && text.contains(name),
            "{text} / {reason}"
        );
    }
}

#[test]
fn all_frames_have_the_size_of_the_first() {
    let folder = sequence(&[0; N_PIXELS]);
    fs::write(
        folder.path().join("frame-9.depth.png"),
        depth_png((8, 8), &[0; 64]),
    )
    .unwrap();
    let sequence = RgbdSequence::open(folder.path()).unwrap();
    assert_eq!((sequence.camera().width, sequence.camera().height), (8, 8));
    let mut out = vec![Point::default(); 64];
    let error = sequence
        .fill(1, &mut Scratch::default(), &mut out)
        .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("16x8 pixels, and the sequence's first depth image 8x8")
    );
}

#[test]
fn invalid_arguments_are_refused() {
    let folder = sequence(&[0; N_PIXELS]);
    let sequence = RgbdSequence::open(folder.path()).unwrap();
    let mut out = vec![Point::default(); N_PIXELS];
    let short = sequence
        .fill(0, &mut Scratch::default(), &mut out[1..])
        .unwrap_err();
    assert!(
        matches!(
            short,
            Error::OutputLength {
                found: 127,
                needed: 128
            }
        ),
        "{short}"
    );
    let late = sequence
        .fill(3, &mut Scratch::default(), &mut out)
        .unwrap_err();
    assert!(
        matches!(late, Error::NoSuch { index: 3, n: 3, .. }),
        "{late}"
    );
}

#[test]
fn a_large_image_needs_a_large_file() {
    let mut file = depth_png(SIZE, &[0; N_PIXELS]);
    // The width and height within the first chunk, and that chunk's checksum.
    file[16..24].copy_from_slice(&[0, 0, 32, 0, 0, 0, 32, 0]);
    let mut crc = u32::MAX;
    for byte in &file[12..29] {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = crc >> 1 ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1));
        }
    }
    file[29..33].copy_from_slice(&(!crc).to_be_bytes());
    let error = depth_image_size(&file).unwrap_err().to_string();
    assert!(error.contains("too short"), "{error}");
}
