use super::*;
use crate::mesh::MeshView;
use crate::ply::Encoding;
use crate::png_image::{encode, to_big_endian_samples};
use nalgebra::Point3;
use point_cloud::{Point, Rgba};

/// Camera of the written scene.
const CAMERA: &str = r#""cam_K": [550.0, 0.0, 2.5, 0.0, 540.0, 1.5, 0.0, 0.0, 1.0]"#;
/// Quarter turn about z, as a row-major matrix.
const QUARTER_TURN: &str = "[0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]";

/// Scene of two images of 6 by 4 pixels, the second of which has an object.
fn write_scene(folder: &Path) {
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text).unwrap();
    let world = format!(r#""cam_R_w2c": {QUARTER_TURN}, "cam_t_w2c": [0.0, 0.0, 500.0]"#);
    let cameras = format!(
        r#"{{"10": {{{CAMERA}, "depth_scale": 0.1, {world}}}, "2": {{{CAMERA}, "depth_scale": 1.0}}}}"#
    );
    write("scene_camera.json", cameras);
    let pose = format!(r#""cam_R_m2c": {QUARTER_TURN}, "cam_t_m2c": [10.0, 20.0, 700.0]"#);
    write(
        "scene_gt.json",
        format!(r#"{{"10": [{{"obj_id": 3, {pose}}}]}}"#),
    );
    std::fs::create_dir(folder.join("depth")).unwrap();
    std::fs::create_dir(folder.join("mask_visib")).unwrap();
    let depth: Vec<u16> = (0..24).map(|pixel| pixel * 300).collect();
    let mut samples = Vec::new();
    to_big_endian_samples(&depth, &mut samples);
    let mut png = Vec::new();
    encode(PixelKind::Depth, (6, 4), &samples, &mut png).unwrap();
    std::fs::write(folder.join("depth/000010.png"), &png).unwrap();
    let mask: Vec<u8> = (0..24)
        .map(|pixel| if pixel % 6 == 2 { 255 } else { 0 })
        .collect();
    png.clear();
    encode(PixelKind::Silhouette, (6, 4), &mask, &mut png).unwrap();
    std::fs::write(folder.join("mask_visib/000010_000000.png"), png).unwrap();
}

#[test]
fn annotations_depth_and_masks_are_read_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let scene = BopScene::open(folder.path()).unwrap();
    let numbers: Vec<u32> = scene.images().iter().map(|image| image.number).collect();
    assert_eq!(numbers, [2, 10]);
    let [plain, annotated] = scene.images() else {
        panic!("two images");
    };
    assert_eq!((plain.camera_from_world, plain.objects.len()), (None, 0));
    assert_eq!(annotated.focal_px, [550.0, 540.0]);
    assert_eq!(annotated.principal_px, [2.5, 1.5]);
    let in_camera = annotated.objects[0].camera_from_object * Point3::new(0.1, 0.0, 0.0);
    assert!(
        (in_camera - Point3::new(0.01, 0.12, 0.7)).norm() < 1e-9,
        "{in_camera}"
    );
    let world = annotated.camera_from_world.unwrap() * Point3::origin();
    assert!((world - Point3::new(0.0, 0.0, 0.5)).norm() < 1e-9);
    let (mut depth_m, mut mask) = (Vec::new(), Vec::new());
    assert_eq!(scene.read_depth(1, &mut depth_m).unwrap(), (6, 4));
    // A unit is a tenth of a millimetre.
    assert_eq!(depth_m[0], 0.0);
    assert!((depth_m[10] - 0.3).abs() < 1e-6, "{}", depth_m[10]);
    assert_eq!(scene.read_visible_mask(1, 0, &mut mask).unwrap(), (6, 4));
    assert_eq!(mask.iter().filter(|&&is_seen| is_seen).count(), 4);
    assert!(mask[2] && mask[8] && !mask[3]);
}

#[test]
fn models_are_read_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    let color = Rgba::opaque(10, 20, 30);
    let vertices = [[0.0, 0.0, 0.0], [120.0, 0.0, 0.0], [0.0, 40.0, 0.0]].map(|[x, y, z]| Point {
        x,
        y,
        z,
        color,
    });
    let view = MeshView {
        vertices: &vertices,
        triangles: &[[0, 1, 2]],
    };
    let file = ply::write(view, Encoding::Ascii).unwrap();
    std::fs::write(folder.path().join("obj_000003.ply"), file).unwrap();
    let mesh = open_model(folder.path(), 3).unwrap();
    assert!((mesh.vertices[1].x - 0.12).abs() < 1e-6 && mesh.triangles.len() == 1);
    let error = open_model(folder.path(), 4).unwrap_err().to_string();
    assert!(error.contains("obj_000004.ply"), "{error}");
}

#[test]
fn broken_scenes_are_refused_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |cameras: &str, truth: &str| {
        std::fs::write(folder.path().join("scene_camera.json"), cameras).unwrap();
        std::fs::write(folder.path().join("scene_gt.json"), truth).unwrap();
        BopScene::open(folder.path()).unwrap_err().to_string()
    };
    let one = format!(r#"{{"1": {{{CAMERA}}}}}"#);
    let object = |rotation: &str, place: &str| {
        format!(r#"{{"1": [{{"obj_id": 1, "cam_R_m2c": {rotation}, "cam_t_m2c": {place}}}]}}"#)
    };
    for (cameras, truth, expected) in [
        ("{}", "{}".to_owned(), "no images"),
        ("[1]", "{}".to_owned(), "not as in the BOP format"),
        (
            r#"{"1": {"cam_K": [1]}}"#,
            "{}".to_owned(),
            "not as in the BOP format",
        ),
        (
            &one.replace("550.0", "-5.0"),
            "{}".to_owned(),
            "focal lengths",
        ),
        (
            &one.replace("[550.0, 0.0", "[550.0, 3.0"),
            "{}".to_owned(),
            "skew",
        ),
        (
            &one.replace("\"1\"", "\"one\""),
            "{}".to_owned(),
            "must be a number",
        ),
        (&one, object(QUARTER_TURN, "[0.0, 0.0, 1e9]"), "within 1 km"),
        (
            &one,
            object("[1, 0, 0, 0, 1, 0, 0, 0, -1]", "[0, 0, 1]"),
            "orthonormal",
        ),
        (
            &one,
            object("[9, 0, 0, 0, 1, 0, 0, 0, 1]", "[0, 0, 1]"),
            "orthonormal",
        ),
        (
            &one,
            object(QUARTER_TURN, "[0, 0, 1]").replace("\"1\": [", "\"5\": ["),
            "no camera",
        ),
    ] {
        let sentence = refused(cameras, &truth);
        assert!(sentence.contains(expected), "{sentence}");
    }
}

#[test]
fn missing_images_and_objects_are_named() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let scene = BopScene::open(folder.path()).unwrap();
    let (mut depth_m, mut mask) = (Vec::new(), Vec::new());
    let error = scene.read_depth(0, &mut depth_m).unwrap_err().to_string();
    assert!(error.contains("000002.png"), "{error}");
    let error = scene.read_depth(2, &mut depth_m).unwrap_err().to_string();
    assert!(error.contains("no image 2"), "{error}");
    let error = scene
        .read_visible_mask(1, 1, &mut mask)
        .unwrap_err()
        .to_string();
    assert!(error.contains("no object 1"), "{error}");
    std::fs::write(folder.path().join("depth/000010.png"), b"nonsense").unwrap();
    let error = scene.read_depth(1, &mut depth_m).unwrap_err().to_string();
    assert!(error.contains("000010.png is unusable"), "{error}");
    let nowhere = BopScene::open(&folder.path().join("none"))
        .unwrap_err()
        .to_string();
    assert!(nowhere.contains("scene_camera.json"), "{nowhere}");
}

#[test]
fn depth_as_tiff_and_odd_visible_shares_are_refused_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path());
    let depth = folder.path().join("depth");
    std::fs::rename(depth.join("000010.png"), depth.join("000010.tif")).unwrap();
    let scene = BopScene::open(folder.path()).unwrap();
    assert_eq!(scene.images()[1].objects[0].visible_share, None);
    let error = scene
        .read_depth(1, &mut Vec::new())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("000010.tif is a TIFF; convert it to a grey PNG"),
        "{error}"
    );
    let refused = |info: &str| {
        std::fs::write(folder.path().join("scene_gt_info.json"), info).unwrap();
        BopScene::open(folder.path()).unwrap_err().to_string()
    };
    let error = refused(r#"{"10": [{"visib_fract": 1.5}]}"#);
    assert!(error.contains("visib_fract"), "{error}");
    let error = refused(r#"{"10": []}"#);
    assert!(error.contains("as many objects"), "{error}");
}
