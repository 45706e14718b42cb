use super::*;
use crate::Error;
use mutation_fuzzing::{assert_sentence, corruption, flipped_bits, truncations};
use point_cloud::Point;
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

fn view() -> impl Strategy<Value = CroppedView> {
    let place = (0..600_u32, 0..400_u32);
    ((1..20_u32, 1..20_u32), place).prop_flat_map(|(size, top_left)| {
        let n_pixels = (size.0 * size.1) as usize;
        let depth = prop_oneof![Just(0), 500..3000_u16, any::<u16>()];
        (
            prop::collection::vec(any::<u8>(), 3 * n_pixels),
            prop::collection::vec(depth, n_pixels),
            prop::collection::vec(prop_oneof![Just(0_u8), Just(255)], n_pixels),
        )
            .prop_map(move |(color, depth_mm, mask)| CroppedView {
                size,
                top_left,
                color,
                depth_mm,
                mask,
            })
    })
}

/// Crop of 3 x 2 pixels: the last pixel has no depth, the first one is background.
fn small() -> CroppedView {
    CroppedView {
        size: (3, 2),
        top_left: (317, 239),
        color: (0..18).collect(),
        depth_mm: vec![1000, 1000, 2000, 1000, 1500, 0],
        mask: vec![0, 255, 255, 255, 255, 255],
    }
}

fn name(text: &str) -> ViewName {
    ViewName::parse(text).unwrap()
}

/// Files of a folder tree, by name.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn round_trip_returns_what_was_written(view in view(), category in "[a-z_]{1,8}", n in any::<[u32; 3]>()) {
        let root = tempfile::tempdir().unwrap();
        let name = ViewName::new(&category, n[0], n[1], n[2]).unwrap();
        write_view(root.path(), &name, &view, Some(&CAMERA)).unwrap();
        let dataset = ObjectDataset::open(root.path()).unwrap();
        prop_assert_eq!(dataset.names().collect::<Vec<_>>(), vec![&name]);
        prop_assert_eq!(dataset.load(0).unwrap(), view.clone());
        prop_assert_eq!(dataset.load_cloud(0).unwrap(), view.points(&CAMERA).unwrap());
    }

    #[test]
    fn a_point_projects_to_its_pixel_of_the_whole_image(view in view()) {
        let points = view.points(&CAMERA).unwrap();
        let n_expected = view.depth_mm.iter().zip(&view.mask).filter(|(d, m)| **d != 0 && **m != 0);
        prop_assert_eq!(points.len(), n_expected.count());
        let (left, top) = (f64::from(view.top_left.0), f64::from(view.top_left.1));
        for point in points {
            let pixel = CAMERA.project(&point.position()).unwrap();
            let (column, row) = ((pixel.x - left).round(), (pixel.y - top).round());
            let near = |value: f64, whole: f64| (value - whole).abs() < 1e-3;
            prop_assert!(near(pixel.x - left, column) && near(pixel.y - top, row));
            let idx = row as usize * view.size.0 as usize + column as usize;
            prop_assert_ne!(view.mask[idx], 0);
            prop_assert!((f64::from(point.z) * 1000.0 - f64::from(view.depth_mm[idx])).abs() < 0.01);
            prop_assert_eq!(&point.color.rgb()[..], &view.color[3 * idx..3 * idx + 3]);
        }
    }

    #[test]
    fn a_place_is_read_as_written(column in 0..8192_u32, row in 0..8192_u32, corruption in corruption()) {
        let text = format_location((column, row));
        prop_assert_eq!(parse_location(text.as_bytes()).unwrap(), (column, row));
        if let Err(error) = parse_location(&corruption.apply(text.as_bytes())) {
            assert_sentence(&error);
        }
    }

    #[test]
    fn arbitrary_bytes_are_explained(bytes in any::<Vec<u8>>()) {
        assert_sentence(&parse_location(&bytes).unwrap_err());
        assert_sentence(&read_cloud(&bytes).unwrap_err());
    }
}

#[test]
fn a_place_counts_from_one_in_its_file() {
    assert_eq!(parse_location(b"272,183").unwrap(), (271, 182));
    assert_eq!(parse_location(b" 1 , 1 \r\n").unwrap(), (0, 0));
    for text in [
        "", "1", "0,1", "1,0", "1,2,3", "1.5,2", "-1,2", "9000,1", "1 2",
    ] {
        assert_sentence(&parse_location(text.as_bytes()).unwrap_err());
    }
}

#[test]
fn the_files_are_those_of_the_data_set() {
    let root = tempfile::tempdir().unwrap();
    let view = name("cell_phone_1_2_100");
    write_view(root.path(), &view, &small(), Some(&CAMERA)).unwrap();
    let folder = root.path().join("cell_phone/cell_phone_1");
    let endings = [
        ".pcd",
        "_crop.png",
        "_depthcrop.png",
        "_loc.txt",
        "_maskcrop.png",
    ];
    let expected = endings.map(|ending| folder.join(format!("cell_phone_1_2_100{ending}")));
    assert_eq!(files(root.path()), expected);
    assert_eq!(fs::read(&expected[3]).unwrap(), b"318,240\n");
    let cloud = fs::read(&expected[0]).unwrap();
    let header = String::from_utf8_lossy(&cloud[..200]).into_owned();
    assert!(header.contains("FIELDS x y z rgb imX imY\n"), "{header}");
    // The object's second pixel is the principal point of the camera, whose
    // axis is the file's y; its next line is below the axis.
    let floats: Vec<f32> = cloud[cloud.len() - 4 * 24..]
        .as_chunks()
        .0
        .iter()
        .map(|bytes| f32::from_le_bytes(*bytes))
        .collect();
    let place = |idx: usize| (floats[6 * idx + 4], floats[6 * idx + 5]);
    assert_eq!(
        [0, 1, 2, 3].map(place),
        [
            (319.0, 240.0),
            (320.0, 240.0),
            (318.0, 241.0),
            (319.0, 241.0)
        ]
    );
    assert_eq!(floats[6..9], [0.0, 2.0, 0.0]);
    assert!(floats[12] < 0.0 && floats[13] == 1.0 && floats[14] < 0.0);
    assert_eq!(floats[3].to_bits(), 0x0003_0405);
}

#[test]
fn views_come_in_order_of_category_instance_sequence_and_frame() {
    let root = tempfile::tempdir().unwrap();
    for text in [
        "mug_10_1_1",
        "mug_2_1_10",
        "mug_2_1_9",
        "apple_1_4_1",
        "apple_1_2_7",
        "apple2_1_1_1",
    ] {
        write_view(root.path(), &name(text), &small(), None).unwrap();
    }
    fs::write(root.path().join("readme.txt"), "not part of it").unwrap();
    let dataset = ObjectDataset::open(root.path()).unwrap();
    let names: Vec<String> = dataset.names().map(ToString::to_string).collect();
    assert_eq!(
        names,
        [
            "apple_1_2_7",
            "apple_1_4_1",
            "apple2_1_1_1",
            "mug_2_1_9",
            "mug_2_1_10",
            "mug_10_1_1"
        ]
    );
    assert_eq!(dataset.categories(), ["apple", "apple2", "mug"]);
    assert_eq!(dataset.instances("mug"), [2, 10]);
    assert!(dataset.instances("fork").is_empty());
    assert_eq!(dataset.name(6), None);
    assert!(dataset.has_images(0) && !dataset.has_cloud(0) && !dataset.has_images(6));
}

#[test]
fn a_flat_folder_is_read_like_a_tree() {
    let (tree, flat) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for text in ["mug_1_1_1", "apple_1_1_1"] {
        write_view(tree.path(), &name(text), &small(), Some(&CAMERA)).unwrap();
    }
    for file in files(tree.path()) {
        fs::copy(&file, flat.path().join(file.file_name().unwrap())).unwrap();
    }
    for folder in [
        flat.path(),
        &tree.path().join("mug"),
        &tree.path().join("mug/mug_1"),
    ] {
        let dataset = ObjectDataset::open(folder).unwrap();
        let last = dataset.n_views() - 1;
        assert_eq!(dataset.name(last), Some(&name("mug_1_1_1")));
        assert_eq!(dataset.load(last).unwrap(), small());
        assert_eq!(dataset.load_cloud(last).unwrap().len(), 4);
    }
}

#[test]
fn views_with_images_or_points_only_are_listed_and_others_counted() {
    let root = tempfile::tempdir().unwrap();
    for text in ["a_1_1_1", "a_1_1_2", "a_1_1_3"] {
        write_view(root.path(), &name(text), &small(), Some(&CAMERA)).unwrap();
    }
    let folder = root.path().join("a/a_1");
    fs::remove_file(folder.join("a_1_1_1.pcd")).unwrap();
    fs::remove_file(folder.join("a_1_1_2_maskcrop.png")).unwrap();
    fs::remove_file(folder.join("a_1_1_3.pcd")).unwrap();
    fs::remove_file(folder.join("a_1_1_3_loc.txt")).unwrap();
    let dataset = ObjectDataset::open(root.path()).unwrap();
    assert_eq!((dataset.n_views(), dataset.n_incomplete()), (2, 1));
    assert!(dataset.load(0).is_ok() && dataset.load_cloud(1).is_ok());
    for error in [
        dataset.load(1).unwrap_err(),
        dataset.load_cloud(0).unwrap_err(),
        dataset.load(2).unwrap_err(),
    ] {
        assert_sentence(&error);
    }
}

#[test]
fn a_view_is_not_overwritten_but_an_interrupted_one_is_completed() {
    let root = tempfile::tempdir().unwrap();
    let view = name("a_1_1_1");
    write_view(root.path(), &view, &small(), None).unwrap();
    let error = write_view(root.path(), &view, &small(), None).unwrap_err();
    assert!(matches!(error, Error::ViewExists(_)), "{error}");
    assert_sentence(&error);
    fs::remove_file(root.path().join("a/a_1/a_1_1_1_crop.png")).unwrap();
    assert!(matches!(
        ObjectDataset::open(root.path()),
        Err(Error::NoCrops(_))
    ));
    write_view(root.path(), &view, &small(), None).unwrap();
    assert_eq!(
        ObjectDataset::open(root.path()).unwrap().load(0).unwrap(),
        small()
    );
}

#[test]
fn invalid_content_is_not_written() {
    let root = tempfile::tempdir().unwrap();
    let mut cases = vec![small(); 5];
    cases[0].color.pop();
    cases[1].depth_mm.push(1);
    cases[2].mask.clear();
    cases[3].top_left.0 = 8192;
    cases[4].size = (0, 0);
    for case in cases {
        assert_sentence(&write_view(root.path(), &name("a_1_1_1"), &case, None).unwrap_err());
        assert_sentence(&case.points(&CAMERA).unwrap_err());
        assert_sentence(&write_cloud(&case, &CAMERA).unwrap_err());
    }
    assert!(files(root.path()).is_empty());
}

#[test]
fn a_wrong_folder_is_refused_with_its_reason() {
    let root = tempfile::tempdir().unwrap();
    assert_sentence(&ObjectDataset::open(root.path()).unwrap_err());
    assert_sentence(&ObjectDataset::open(&root.path().join("missing")).unwrap_err());
    write_view(root.path(), &name("a_1_1_1"), &small(), None).unwrap();
    let copied = "a_1_1_1_depthcrop.png";
    fs::copy(
        root.path().join("a/a_1").join(copied),
        root.path().join(copied),
    )
    .unwrap();
    let error = ObjectDataset::open(root.path()).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(copied), "{error}");
}

#[test]
fn a_damaged_file_is_named() {
    let root = tempfile::tempdir().unwrap();
    write_view(root.path(), &name("a_1_1_1"), &small(), Some(&CAMERA)).unwrap();
    let dataset = ObjectDataset::open(root.path()).unwrap();
    for path in files(root.path()) {
        let whole = fs::read(&path).unwrap();
        for damaged in truncations(&whole)
            .step_by(7)
            .chain(flipped_bits(&whole).step_by(61))
        {
            fs::write(&path, damaged).unwrap();
            let errors = [dataset.load(0).err(), dataset.load_cloud(0).err()];
            for error in errors.iter().flatten() {
                assert_sentence_about(error, &path);
            }
        }
        fs::write(&path, b"").unwrap();
        assert!(dataset.load(0).is_err() || dataset.load_cloud(0).is_err());
        fs::write(&path, whole).unwrap();
    }
    fs::write(
        root.path().join("a/a_1/a_1_1_1_maskcrop.png"),
        one_bit(4, 2, &[0, 0]),
    )
    .unwrap();
    let error = dataset.load(0).unwrap_err();
    assert!(error.to_string().contains("4x2 pixels"), "{error}");
}

#[track_caller]
fn assert_sentence_about(error: &Error, path: &Path) {
    assert_sentence(error);
    let name = path.file_name().unwrap().to_string_lossy();
    assert!(error.to_string().contains(&*name), "{error} / {name}");
}

fn one_bit(width: u32, height: u32, rows: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(rows).unwrap();
    writer.finish().unwrap();
    file
}

#[test]
fn a_mask_may_have_one_bit_a_pixel() {
    let file = one_bit(11, 2, &[0b1000_0001, 0b0010_0000, 0b0111_1110, 0b1101_1111]);
    let mut mask = Vec::new();
    decode_mask(&file, (11, 2), &mut mask).unwrap();
    let bits: String = mask
        .iter()
        .map(|value| if *value == 255 { '1' } else { '0' })
        .collect();
    assert_eq!(bits, "1000000100101111110110");
}

#[test]
fn clouds_of_the_data_set_are_read() {
    let file = "VERSION .7\nFIELDS x y z rgb imX imY\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n\
        COUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n\
        0.1 0.8 -0.2 9.2e-39 318 240\nnan nan nan 0 1 1\n";
    let points = read_cloud(file.as_bytes()).unwrap();
    let color = point_cloud::Rgba(9.2e-39_f32.to_bits() | 0xff00_0000);
    assert_eq!(
        points,
        [Point {
            x: 0.1,
            y: 0.2,
            z: 0.8,
            color
        }]
    );
}
