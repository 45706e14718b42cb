use super::*;
use crate::png_image::{PixelKind, encode, to_big_endian_samples};
use crate::rgbd_sequence::test_flat_jpeg;
use crate::{RecordingKind, detect_recording_kind};
use mutation_fuzzing::{assert_sentence, corruption};
use proptest::prelude::*;
use std::fs;
use tempfile::TempDir;

const SIZE: (u32, u32) = (16, 8);
const N_PIXELS: usize = 128;
const JSON: &str =
    r#"{"img_width": 16, "img_height": 8, "fx": 16.0, "fy": 17, "x_offset": 7.5, "y_offset": 3}"#;

fn png(kind: PixelKind, size: (u32, u32), samples: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    encode(kind, size, samples, &mut file).unwrap();
    file
}

fn depth_png(size: (u32, u32), depth: u16) -> Vec<u8> {
    let mut samples = Vec::new();
    to_big_endian_samples(&vec![depth; (size.0 * size.1) as usize], &mut samples);
    png(PixelKind::Depth, size, &samples)
}

fn color_png(grey: u8) -> Vec<u8> {
    png(PixelKind::Color, SIZE, &[grey; 3 * N_PIXELS])
}

fn color_jpg() -> Vec<u8> {
    test_flat_jpeg::encode(2, 1, &[[100, 128, 128]; 2])
}

fn extension(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, extension)| extension)
}

/// Folder of these files; the content follows from the name.
fn folder(names: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in names {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let content = match *name {
            json if extension(json) == "json" => JSON.into(),
            jpg if extension(jpg).starts_with("jp") => color_jpg(),
            depth if depth.to_lowercase().contains("depth") => depth_png(SIZE, 1000),
            _ => color_png(100),
        };
        fs::write(path, content).unwrap();
    }
    folder
}

fn names(images: &RegisteredImages) -> Vec<&str> {
    (0..images.n_frames())
        .map(|index| images.name(index).unwrap())
        .collect()
}

fn open(folder: &TempDir) -> Result<RegisteredImages, Error> {
    RegisteredImages::open(folder.path())
}

fn points(images: &RegisteredImages, index: usize) -> Result<Vec<Point>, Error> {
    let mut out = vec![Point::default(); images.camera().n_pixels()];
    images.fill(index, &mut Scratch::default(), &mut out)?;
    Ok(out)
}

#[test]
fn registered_images_are_paired_by_name() {
    for (files, expected) in [
        (
            &["10-color.png", "10-depth.png", "9-color.jpg", "9-depth.png"][..],
            &["9", "10"][..],
        ),
        (&["a_rgb.jpeg", "a_depth.png", "a_label.png"], &["a"]),
        (&["a.b.colour.png", "a.b.Depth.PNG"], &["a.b"]),
        (
            &["rgb/2.png", "depth/2.png", "rgb/11.jpg", "depth/11.png"],
            &["2", "11"],
        ),
        (&["color/a-depth.jpg", "depth/a-depth.png"], &["a-depth"]),
        (&["frame-1.color.png", "frame-1.depth.png"], &["frame-1"]),
    ] {
        let folder = folder(&[files, &["camera.json", "notes.json"]].concat());
        let kind = detect_recording_kind(folder.path()).unwrap();
        assert_eq!(kind, RecordingKind::RegisteredImages, "{files:?}");
        let images = open(&folder).unwrap();
        assert_eq!(
            (names(&images), images.n_unpaired()),
            (expected.to_vec(), 0)
        );
        for index in 0..images.n_frames() {
            let points = points(&images, index).unwrap();
            assert!(
                points
                    .iter()
                    .all(|p| p.z == 1.0 && p.color.rgb()[0].abs_diff(100) <= 1)
            );
        }
    }
}

#[test]
fn registered_images_are_paired_by_timestamp() {
    let folder = folder(&[
        "depth/10.900000.png",
        "depth/10.930000.png",
        "depth/11.000000.png",
        "rgb/9.500000.png",
        "rgb/10.895000.png",
        "rgb/10.935000.png",
        "camera.json",
    ]);
    let images = open(&folder).unwrap();
    assert_eq!(names(&images), ["10.900000", "10.930000"]);
    assert_eq!(images.n_unpaired(), 2);
    fs::remove_file(folder.path().join("rgb/10.895000.png")).unwrap();
    fs::remove_file(folder.path().join("rgb/10.935000.png")).unwrap();
    assert!(matches!(open(&folder), Err(Error::NoPairs(_))));
}

#[test]
fn other_recordings_keep_their_kind() {
    for (files, kind) in [
        (
            &["a.pcd", "a-color.png", "a-depth.png"][..],
            RecordingKind::PcdScenes,
        ),
        (
            &[
                "frame-1.color.png",
                "frame-1.depth.png",
                "camera-intrinsics.txt",
                "camera.json",
            ],
            RecordingKind::RgbdSequence,
        ),
        (
            &[
                "frame-1.color.png",
                "frame-1.depth.png",
                "frame-1.pose.txt",
                "camera.json",
            ],
            RecordingKind::RgbdSequence,
        ),
        (
            &["frame-1.color.png", "frame-1.depth.png"],
            RecordingKind::RgbdSequence,
        ),
    ] {
        assert_eq!(
            detect_recording_kind(folder(files).path()).unwrap(),
            kind,
            "{files:?}"
        );
    }
}

#[test]
fn preferred_intrinsics_are_read() {
    let folder = folder(&["a-color.png", "a-depth.png"]);
    let mut found = Vec::new();
    for (name, content) in [
        ("camera-intrinsics.txt", "20 0 7 0 20 4 0 0 1"),
        (
            "camera_intrinsic.json",
            r#"{"intrinsic_matrix": [21, 0, 0, 0, 22, 0, 7, 4, 1]}"#,
        ),
        (
            "camera_info.json",
            r#"{"K": [23, 0, 7, 0, 24, 4, 0, 0, 1], "D": [0.1]}"#,
        ),
        (
            "camera.json",
            r#"{"fx": 25, "fy": 25, "cx": 7, "cy": 4, "depth_scale": 0.5}"#,
        ),
        ("camera_params.json", JSON),
    ] {
        fs::write(folder.path().join(name), content).unwrap();
        let images = open(&folder).unwrap();
        let camera = images.camera();
        assert_eq!((camera.width, camera.height), SIZE);
        found.push((camera.fx_px, camera.cx_px, points(&images, 0).unwrap()[0].z));
    }
    let expected = [
        (20.0, 7.0, 1.0),
        (21.0, 7.0, 1.0),
        (23.0, 7.0, 1.0),
        (25.0, 7.0, 0.5),
        (16.0, 7.5, 1.0),
    ];
    assert_eq!(found, expected);
}

#[test]
fn unusable_intrinsics_are_explained() {
    for (content, reason) in [
        ("", "not JSON"),
        ("[16", "not JSON"),
        ("[]", "has no fx"),
        (r#"{"fx": "16"}"#, "not JSON"),
        (r#"{"fx": 16, "fy": 16, "cx": 7}"#, "has no cy"),
        ("{}", "has no fx"),
        (r#"{"K": [16, 1, 7, 0, 16, 4, 0, 0, 1]}"#, "row by row"),
        (
            r#"{"intrinsic_matrix": [16, 0, 7, 0, 16, 4, 0, 0, 1]}"#,
            "column by column",
        ),
        (
            r#"{"fx": -16, "fy": 16, "cx": 7, "cy": 4}"#,
            "focal lengths",
        ),
        (
            r#"{"fx": 16, "fy": 16, "cx": 7, "cy": 4, "depth_scale": 1000}"#,
            "millimetres a unit",
        ),
        (
            r#"{"fx": 16, "fy": 16, "cx": 7, "cy": 4, "depth_scale": 0.001}"#,
            "depth_scale 0.001",
        ),
        (
            r#"{"fx": 16, "fy": 16, "cx": 7, "cy": 4, "width": 32}"#,
            "32 x 8 pixels, and the images have 16 x 8",
        ),
    ] {
        let folder = folder(&["a-color.png", "a-depth.png"]);
        fs::write(folder.path().join("camera.json"), content).unwrap();
        let error = open(&folder).unwrap_err();
        assert_sentence(&error);
        let text = error.to_string();
        assert!(
            text.contains(reason) && text.contains("camera.json"),
            "{text} / {reason}"
        );
    }
}

#[test]
fn unusable_folders_are_explained() {
    for (files, reason) in [
        (
            &["a-color.png", "a-depth.png"][..],
            "for example {\"width\": 16, \"height\": 8,",
        ),
        (
            &["a-color.png", "camera.json"],
            "a-color.png has no companion a-depth.png",
        ),
        (
            &["a-depth.png", "camera.json"],
            "a-depth.png has no companion a-color.png or .jpg",
        ),
        (
            &["rgb/1.png", "rgb/2.png", "depth/1.png"],
            "has no companion depth/2.png",
        ),
        (
            &["rgb/1.png", "depth/1.png", "depth/2.png"],
            "has no companion rgb/2.png",
        ),
        (&["rgb/1.bmp", "depth/1.exr"], "holds no pair of images"),
        (
            &["a-depth.png", "a-rgb.png", "a-color.jpg"],
            "are the same image",
        ),
        (
            &["rgb/1.png", "color/1.png", "depth/1.png"],
            "are the same image",
        ),
        (
            &["rgb/1.png", "depth/1.png", "1-depth.png", "1-rgb.png"],
            "give each recording",
        ),
    ] {
        let folder = folder(files);
        assert_eq!(
            detect_recording_kind(folder.path()).unwrap(),
            RecordingKind::RegisteredImages
        );
        let error = open(&folder).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error} / {reason}");
    }
}

#[test]
fn unusable_frames_are_explained() {
    let grey = png(PixelKind::Silhouette, SIZE, &[0; N_PIXELS]);
    for (name, content, reason) in [
        ("b-depth.png", grey, "16 bits a pixel"),
        ("b-depth.png", depth_png((8, 8), 1000), "has 8x8 pixels"),
        ("b-depth.png", depth_png(SIZE, 1)[..60].to_vec(), "damaged"),
        ("b-color.png", depth_png(SIZE, 1), "24 bits a pixel"),
        (
            "b-color.png",
            test_flat_jpeg::encode(1, 1, &[[0; 3]]),
            "has 8x8 pixels",
        ),
        ("b-color.png", Vec::new(), "damaged"),
    ] {
        let folder = folder(&[
            "a-color.png",
            "a-depth.png",
            "b-color.png",
            "b-depth.png",
            "camera.json",
        ]);
        fs::write(folder.path().join(name), content).unwrap();
        let images = open(&folder).unwrap();
        assert!(points(&images, 0).is_ok());
        let error = points(&images, 1).unwrap_err();
        assert_sentence(&error);
        let text = error.to_string();
        assert!(
            text.contains(reason) && text.contains(name),
            "{text} / {reason}"
        );
    }
}

#[test]
fn an_unusable_first_frame_hides_no_other() {
    let folder = folder(&[
        "a-color.png",
        "a-depth.png",
        "b-color.png",
        "b-depth.png",
        "camera.json",
    ]);
    fs::write(folder.path().join("a-depth.png"), "no image").unwrap();
    let images = open(&folder).unwrap();
    assert!(points(&images, 0).is_err() && points(&images, 1).is_ok());
    fs::write(folder.path().join("b-depth.png"), "no image").unwrap();
    let error = open(&folder).unwrap_err().to_string();
    assert!(error.contains("a-depth.png"), "{error}");
}

#[test]
fn impossible_arguments_are_refused() {
    let images = open(&folder(&["a-color.png", "a-depth.png", "camera.json"])).unwrap();
    let mut scratch = Scratch::default();
    let mut out = vec![Point::default(); N_PIXELS];
    let late = images.fill(1, &mut scratch, &mut out);
    assert!(matches!(late, Err(Error::NoSuch { index: 1, n: 1, .. })));
    let short = images.fill(0, &mut scratch, &mut out[1..]);
    assert!(matches!(
        short,
        Err(Error::OutputLength {
            found: 127,
            needed: 128
        })
    ));
}

/// File names of registered images and others.
fn file_name() -> impl Strategy<Value = String> {
    let select = |pieces: &[&'static str]| prop::sample::select(pieces.to_vec());
    let name = select(&["a", "1.5", "1.51", ".a"]);
    let word = select(&["", "", "-rgb", "_depth", ".color", "-mask"]);
    let extension = select(&[".png", ".png", ".jpg", ".txt"]);
    (name, word, extension).prop_map(|(name, word, extension)| [name, word, extension].concat())
}

proptest! {
    #[test]
    fn damaged_intrinsics_are_read_or_explained(corruption in corruption()) {
        match parse_intrinsics_json(&corruption.apply(JSON.as_bytes()), SIZE) {
            Ok(read) => prop_assert!(read.camera.validated().is_ok()),
            Err(error) => assert_sentence(&error),
        }
    }

    #[test]
    fn arbitrary_intrinsics_are_explained(bytes in any::<Vec<u8>>(), text in "[\\[{\":0-9,fxycK}\\]]{0,99}") {
        assert_sentence(&parse_intrinsics_json(&bytes, SIZE).unwrap_err());
        assert_sentence(&parse_intrinsics_json(text.as_bytes(), SIZE).unwrap_err());
    }

    #[test]
    fn every_image_is_paired_counted_or_reported(
        flat in prop::collection::btree_set(file_name(), 0..5),
        nested in prop::collection::btree_set((prop::sample::select(vec!["rgb", "depth"]), file_name()), 0..6),
    ) {
        let folder = tempfile::tempdir().unwrap();
        for name in ["rgb", "depth"] {
            fs::create_dir_all(folder.path().join(name)).unwrap();
        }
        for name in &flat {
            fs::write(folder.path().join(name), []).unwrap();
        }
        for (subfolder, name) in &nested {
            fs::write(folder.path().join(subfolder).join(name), []).unwrap();
        }
        match list_pairs(folder.path()) {
            Err(error) => assert_sentence(&error),
            Ok(list) => {
                let is_image = |role: &str, name: &str| {
                    let is_color = role == "rgb" && extension(name) == "jpg";
                    !name.starts_with('.') && (is_color || extension(name) == "png")
                };
                let n_flat = flat.iter().filter(|name| image_role(name).is_some()).count();
                let nested = nested.iter();
                let n_nested = nested.filter(|(role, name)| is_image(role, name)).count();
                let n_listed = 2 * list.pairs.len() + list.n_unpaired;
                prop_assert!(n_listed == n_flat || n_listed == n_nested);
                for pair in &list.pairs {
                    prop_assert!(pair.depth.is_file() && pair.color.is_file());
                }
            }
        }
    }
}
