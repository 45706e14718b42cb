use super::*;
use crate::NEUTRAL_GREY;
use mutation_fuzzing::{assert_sentence, corruption};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use point_cloud::Rgba;
use proptest::prelude::*;

const ENCODINGS: [Encoding; 3] = [
    Encoding::Ascii,
    Encoding::Binary,
    Encoding::BinaryCompressed,
];

/// Coordinates of arbitrary bits, often equal as in a real image.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        Just(f32::NAN),
        Just(0.5_f32),
        -3.0_f32..3.0,
        any::<u32>().prop_map(f32::from_bits)
    ]
}

fn cloud() -> impl Strategy<Value = PcdCloud> {
    let pose = (any::<[i8; 3]>(), any::<[i8; 3]>()).prop_map(|(t, r)| {
        let [t, r] = [t, r].map(|v| Vector3::from(v).map(|c| f64::from(c) / 37.0));
        RigidTransform::from_parts(Translation3::from(t), UnitQuaternion::from_scaled_axis(r))
    });
    (0_usize..9, 0_usize..9, any::<bool>(), pose).prop_flat_map(|(width, height, labels, pose)| {
        let point = (coordinate(), coordinate(), coordinate(), any::<u32>()).prop_map(
            |(x, y, z, color)| Point {
                x,
                y,
                z,
                color: Rgba(color),
            },
        );
        let n_points = width * height;
        let points = prop::collection::vec(point, n_points);
        (points, prop::collection::vec(any::<u32>(), n_points)).prop_map(move |(points, all)| {
            let labels = labels.then_some(all);
            PcdCloud {
                points,
                labels,
                width,
                height,
                viewpoint: pose,
            }
        })
    })
}

/// Bits of a point; points without depth are equal.
fn bits(point: &Point) -> [u32; 4] {
    let Point { x, y, z, color } =
        point_value::finite_or_nan(point.x, point.y, point.z, point.color);
    [x.to_bits(), y.to_bits(), z.to_bits(), color.0]
}

fn assert_same(read: &PcdCloud, written: &PcdCloud) {
    let [left, right] = [read, written].map(|c| c.points.iter().map(bits).collect::<Vec<_>>());
    assert_eq!(left, right);
    assert_eq!(read.labels, written.labels);
    assert_eq!((read.width, read.height), (written.width, written.height));
    let difference = read.viewpoint.inv_mul(&written.viewpoint);
    assert!(difference.translation.vector.norm() < 1e-12 && difference.rotation.angle() < 1e-7);
}

proptest! {
    #[test]
    fn round_trip_returns_what_was_written(cloud in cloud()) {
        for encoding in ENCODINGS {
            let file = write(cloud.view(), encoding).unwrap();
            assert_same(&read(&file).unwrap(), &cloud);
        }
    }

    #[test]
    fn a_damaged_file_is_read_or_explained(cloud in cloud(), corruptions in [corruption(), corruption(), corruption()]) {
        for (encoding, corruption) in ENCODINGS.into_iter().zip(corruptions) {
            let file = corruption.apply(&write(cloud.view(), encoding).unwrap());
            match read(&file) {
                Ok(cloud) => prop_assert_eq!(cloud.points.len(), cloud.width * cloud.height),
                Err(error) => assert_sentence(&error),
            }
        }
    }

    #[test]
    fn a_file_cut_anywhere_is_explained(cloud in cloud(), at in any::<prop::sample::Index>()) {
        prop_assume!(!cloud.points.is_empty());
        for encoding in [Encoding::Binary, Encoding::BinaryCompressed] {
            let file = write(cloud.view(), encoding).unwrap();
            assert_sentence(&read(&file[..at.index(file.len())]).unwrap_err());
        }
    }

    #[test]
    fn arbitrary_bytes_are_explained(bytes in any::<Vec<u8>>()) {
        assert_sentence(&read(&bytes).unwrap_err());
    }

    #[test]
    fn data_of_another_file_is_explained(cloud in cloud(), bytes in any::<Vec<u8>>()) {
        for encoding in ENCODINGS {
            let header = Header::parse(&write(cloud.view(), encoding).unwrap()).unwrap();
            let mut points = vec![Point::default(); header.n_points()];
            if let Err(error) = Decoder::new().decode_into(&bytes, &header, &mut points, None) {
                assert_sentence(&error);
            }
        }
    }
}

/// Header for two points with variable lines.
fn header(fields: &str, sizes: &str, types: &str, rest: &str) -> String {
    format!("VERSION .7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\nWIDTH 2\nHEIGHT 1\n{rest}")
}

/// Two points with values of all types, between foreign fields.
fn foreign(encoding: &str) -> Vec<u8> {
    let text = header(
        "normal_x label y _ x z rgb",
        "4 2 8 1 4 8 4",
        "F I F U F F F",
        "",
    ) + &format!("COUNT 1 1 1 3 1 1 1\nPOINTS 2\n# a comment\n\nDATA {encoding}\r\n");
    let columns: [[Vec<u8>; 2]; 7] = [
        [9_f32, 9.0].map(|v| v.to_le_bytes().to_vec()),
        [7_i16, 0].map(|v| v.to_le_bytes().to_vec()),
        [2_f64, -2.5].map(|v| v.to_le_bytes().to_vec()),
        [[1_u8, 2, 3], [4, 5, 6]].map(|v| v.to_vec()),
        [1_f32, -1.5].map(|v| v.to_le_bytes().to_vec()),
        [3_f64, f64::INFINITY].map(|v| v.to_le_bytes().to_vec()),
        [0x0010_2030_u32, 0x00ff_0000].map(|v| v.to_le_bytes().to_vec()),
    ];
    let rows = (0..2).flat_map(|row| columns.iter().flat_map(move |column| column[row].clone()));
    let mut file = text.into_bytes();
    if encoding == "binary" {
        file.extend(rows);
    } else {
        let planes: Vec<u8> = columns.iter().flatten().flatten().copied().collect();
        let compressed = crate::lzf::compress(&planes);
        file.extend((compressed.len() as u32).to_le_bytes());
        file.extend((planes.len() as u32).to_le_bytes());
        file.extend(compressed);
    }
    file
}

fn check_foreign(file: &[u8]) {
    let cloud = read(file).unwrap();
    assert_eq!(cloud.labels, Some(vec![7, 0]));
    let red = Rgba::opaque(0xff, 0, 0);
    let expected = [
        Point {
            x: 1.0,
            y: 2.0,
            z: 3.0,
            color: Rgba::opaque(0x10, 0x20, 0x30),
        },
        Point::without_depth(red),
    ];
    assert_eq!(cloud.points[0], expected[0]);
    assert_eq!(bits(&cloud.points[1]), bits(&expected[1]));
    assert_eq!((cloud.width, cloud.height), (2, 1));
    assert_eq!(cloud.viewpoint, RigidTransform::identity());
}

#[test]
fn foreign_fields_are_skipped_in_binary() {
    check_foreign(&foreign("binary"));
    check_foreign(&foreign("binary_compressed"));
}

#[test]
fn bytes_behind_binary_data_are_ignored() {
    for encoding in ["binary", "binary_compressed"] {
        let mut file = foreign(encoding);
        file.extend([0; 4096]);
        check_foreign(&file);
    }
}

#[test]
fn foreign_fields_are_skipped_in_text() {
    let text = header(
        "normal_x label y _ x z rgb",
        "4 2 8 1 4 8 4",
        "F I F U F F F",
        "",
    ) + "COUNT 1 1 1 3 1 1 1\nPOINTS 2\nDATA ascii\n";
    // 0x00102030 and 0x00ff0000 as the floats of these bits.
    let packed = [0x0010_2030, 0x00ff_0000].map(f32::from_bits);
    let points = format!(
        "9 7 2 1 2 3 1.0 3e0 {}\r\n\n nan 0 -2.5 4 5 6 -1.5 inf {}\n\n",
        packed[0], packed[1]
    );
    check_foreign((text + &points).as_bytes());
}

#[test]
fn points_without_colour_are_grey() {
    let text = header(
        "x y z",
        "4 4 4",
        "F F F",
        "POINTS 2\nDATA ascii\n1 2 3\nnan 2 3",
    );
    let cloud = read(text.as_bytes()).unwrap();
    assert_eq!(
        cloud.points[0],
        Point {
            x: 1.0,
            y: 2.0,
            z: 3.0,
            color: NEUTRAL_GREY
        }
    );
    assert!(cloud.points[1].y.is_nan());
    assert_eq!(cloud.labels, None);
}

#[test]
fn a_wrong_header_is_refused_with_its_reason() {
    let end = "POINTS 2\nDATA ascii\n1 2 3\n1 2 3\n";
    let xyz = |rest: &str| header("x y z", "4 4 4", "F F F", rest) + end;
    let huge = |size: &str, count: &str| {
        format!("COUNT 1 1 1 {count}\nWIDTH {size}\nHEIGHT 1\nPOINTS {size}\nDATA binary\n")
    };
    let large = "VERSION 0.7\nFIELDS x y z f\nSIZE 4 4 4 8\nTYPE F F F F\n".to_owned();
    for (file, reason) in [
        (xyz("VERSION 0.7\n"), "twice"),
        (xyz("").replace(".7", ".6"), "0.7"),
        (xyz("COLOUR yes\n"), "COLOUR"),
        (xyz("COUNT 1 1\n"), "one entry for each"),
        (xyz("COUNT 1 1 2\n"), "COUNT 1"),
        (xyz("VIEWPOINT 0 0 0 1 0 0\n"), "seven"),
        (xyz("VIEWPOINT 0 0 0 2 0 0 0\n"), "length 1"),
        (xyz("VIEWPOINT 0 nan 0 1 0 0 0\n"), "seven"),
        (xyz("").replace("HEIGHT 1\n", ""), "HEIGHT"),
        (xyz("").replace("WIDTH 2", "WIDTH -2"), "not a count"),
        (xyz("").replace("WIDTH 2", "WIDTH 3"), "WIDTH times HEIGHT"),
        (xyz("").replace("ascii", "text"), "ascii, binary"),
        (xyz("").replace("x y z", "x y w"), "x, y and z"),
        (xyz("").replace("x y z", "x x z"), "once"),
        (xyz("").replace("F F F", "F F U"), "TYPE F"),
        (xyz("").replace("4 4 4", "4 4 3"), "SIZE 1, 2, 4 or 8"),
        (xyz("").replace("1 2 3\n", "1 2\n"), "cut off"),
        (xyz("").replace("1 2 3\n", "1 2 3 4\n"), "3 values"),
        (xyz("") + "1 2 3\n", "more points"),
        (xyz("").replace("1 2 3\n1", "1.0000\n"), "3 values"),
        (
            xyz("").replace("1 2 3\n1 2 3\n", "1 2 3.0000000\n"),
            "after 1 of 2",
        ),
        (xyz("").replace("1 2 3\n1", "1 2 z\n1"), "\"z\""),
        (large.clone() + &huge("16777217", "1"), "16777216 points"),
        (large.clone() + &huge("16000000", "4"), "bytes"),
        (
            large.clone() + &huge("1", "18446744073709551615"),
            "too large",
        ),
        (
            large.clone() + &huge("18446744073709551615", "1"),
            "16777216 points",
        ),
        (large + &huge("18446744073709551616", "1"), "not a count"),
        (header("x y z rgb", "4 4 4 8", "F F F F", end), "SIZE 4"),
        ("solid stl".to_owned(), "not a PCD file"),
    ] {
        let error = read(file.as_bytes()).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(reason), "{error} / {reason}");
    }
}

#[test]
fn labels_must_be_whole_numbers() {
    for label in ["-1", "0.5", "4294967296", "nan"] {
        let end = format!("POINTS 2\nDATA ascii\n0 0 0 1\n0 0 0 {label}\n");
        let file = header("x y z label", "4 4 4 8", "F F F F", &end);
        let error = read(file.as_bytes()).unwrap_err();
        assert!(
            matches!(error, Error::Label { point_idx: 1, .. }),
            "{error}"
        );
    }
}

#[test]
fn a_small_file_cannot_ask_for_much_memory() {
    let header = header("x y z", "4 4 4", "F F F", "").replace("WIDTH 2", "WIDTH 16000000");
    let mut file = (header + "POINTS 16000000\nDATA binary_compressed\n").into_bytes();
    file.extend([8_u32.to_le_bytes(), 192_000_000_u32.to_le_bytes()].concat());
    file.extend([0xff; 8]);
    assert!(matches!(read(&file), Err(Error::Truncated { .. })));
}

#[test]
fn slices_of_the_wrong_length_are_refused() {
    let file = foreign("binary");
    let header = Header::parse(&file).unwrap();
    let mut decoder = Decoder::new();
    let mut points = [Point::default(); 3];
    let few = decoder.decode_into(&file, &header, &mut points[..1], None);
    assert!(matches!(
        few,
        Err(Error::SizeMismatch {
            what: "points",
            given: 1,
            needed: 2
        })
    ));
    let labels = decoder.decode_into(&file, &header, &mut points[..2], Some(&mut [0; 3]));
    assert!(matches!(
        labels,
        Err(Error::SizeMismatch { what: "labels", .. })
    ));
}

#[test]
fn a_view_that_does_not_fill_its_grid_is_not_written() {
    let points = [Point::default(); 6];
    let view = PcdView {
        points: &points,
        labels: None,
        width: 3,
        height: 2,
        viewpoint: RigidTransform::identity(),
    };
    let nowhere = RigidTransform::translation(0.0, f64::NAN, 0.0);
    assert!(write(view, Encoding::Binary).is_ok());
    for wrong in [
        PcdView { width: 4, ..view },
        PcdView {
            width: usize::MAX,
            ..view
        },
        PcdView {
            labels: Some(&[0; 5]),
            ..view
        },
        PcdView {
            viewpoint: nowhere,
            ..view
        },
    ] {
        assert_sentence(&write(wrong, Encoding::Binary).unwrap_err());
    }
}

#[test]
fn a_missing_file_is_named() {
    let error = open(Path::new("/nowhere/at/all.pcd")).unwrap_err();
    assert!(error.to_string().contains("/nowhere/at/all.pcd"), "{error}");
}
