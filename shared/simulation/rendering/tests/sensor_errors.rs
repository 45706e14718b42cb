//! Tests of the simulated Kinect against published measurements of the real one.

#![expect(clippy::unwrap_used, reason = "a failing set-up must fail the test")]

mod synthetic;

use geometry::PinholeCamera;
use nalgebra::UnitQuaternion;
use nalgebra::Vector3;
use point_cloud::Point;
use rendering::kinect::{
    AxialNoise, BorderSpeckle, ColorResponse, DepthRange, DisparityQuantisation, EdgeFattening,
    FrameSeed, KinectSensor, LateralNoise, ProjectorShadow, SensorModel, WeakSignal,
};
use rendering::{Error, Image, Instance, PreparedMesh, Rasterizer};
use synthetic::{TableScene, at, ball, cuboid, rectangle, with_surface};

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
const FOCAL_BASELINE: f64 = 585.0 * 0.075;

fn sense(image: &Image, model: SensorModel, frame_index: u64) -> Vec<Point> {
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let shot = FrameSeed {
        seed: 5,
        frame_index,
    };
    KinectSensor::new(CAMERA, model)
        .unwrap()
        .sense(image, shot, &mut points)
        .unwrap();
    points
}

/// Image of a plane through (0, 0, z), rotated about the vertical.
fn plane(z_m: f64, angle_rad: f64) -> Image {
    let mesh = PreparedMesh::new(&rectangle(40.0, 40.0, 1, [200; 3]));
    let mut pose = at(0.0, 0.0, z_m);
    pose.rotation =
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI - angle_rad);
    Rasterizer::new(CAMERA)
        .unwrap()
        .render(&[Instance::new(&mesh, pose, 1)])
        .clone()
}

fn table() -> Image {
    let scene = TableScene::new(8);
    let mut rasterizer = scene.prepared_rasterizer(CAMERA);
    rasterizer.render(&scene.objects()).clone()
}

/// Bit patterns of points, so that NaN equals NaN.
fn bytes(points: &[Point]) -> Vec<u32> {
    points
        .iter()
        .flat_map(|p| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.color.0])
        .collect()
}

/// Standard deviation of the depth error around the image centre, metres.
fn sigma_m(image: &Image, model: SensorModel) -> f64 {
    let mut sensor = KinectSensor::new(CAMERA, model).unwrap();
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for frame_index in 0..12 {
        let shot = FrameSeed {
            seed: 3,
            frame_index,
        };
        sensor.sense(image, shot, &mut points).unwrap();
        for pixel in (216..264).flat_map(|row| (296..344).map(move |column| row * 640 + column)) {
            let error = f64::from(points[pixel].z - image.depth_m()[pixel]);
            n += 1.0;
            sum += error;
            squares += error * error;
        }
    }
    (squares / n - (sum / n) * (sum / n)).sqrt()
}

#[test]
fn axial_noise_follows_the_published_law() {
    let model = SensorModel {
        weak_signal: None,
        ..SensorModel::KINECT_V1
    };
    let facing = [0.6, 0.8, 1.0, 1.3, 1.7, 2.1, 2.6, 3.0, 3.5].map(|z| (z, 0.0_f64));
    let inclined = [15.0, 30.0, 45.0, 55.0, 62.0, 70.0].map(|angle| (1.0, angle));
    for (z_m, angle_deg) in facing.into_iter().chain(inclined) {
        let image = plane(z_m, angle_deg.to_radians());
        let published =
            AxialNoise::KINECT_V1.sigma_m(z_m as f32, angle_deg.to_radians() as f32) as f64;
        let ratio = sigma_m(&image, model) / published;
        assert!((ratio - 1.0).abs() < 0.15, "{z_m} m, {angle_deg}°: {ratio}");
    }
}

#[test]
fn axial_noise_is_shared_by_neighbours_but_not_by_frames() {
    let image = plane(1.0, 0.0);
    let model = SensorModel {
        quantisation: None,
        ..SensorModel::KINECT_V1
    };
    let frames: Vec<Vec<Point>> = (0..2).map(|frame| sense(&image, model, frame)).collect();
    let error = |frame: usize, pixel: usize| f64::from(frames[frame][pixel].z) - 1.0;
    let correlation = |other: &dyn Fn(usize) -> f64| {
        let pixels = (100..380).flat_map(|row| (100..500).map(move |column| row * 640 + column));
        let (mut products, mut squares) = (0.0, 0.0);
        for pixel in pixels {
            products += error(0, pixel) * other(pixel);
            squares += error(0, pixel) * error(0, pixel);
        }
        products / squares
    };
    let beside = correlation(&|pixel| error(0, pixel + 1));
    assert!((0.25..0.45).contains(&beside), "{beside}");
    let later = correlation(&|pixel| error(1, pixel));
    assert!(later.abs() < 0.05, "{later}");
}

#[test]
fn quantisation_without_noise_gives_allowed_steps_only() {
    let image = plane(1.5, 0.9);
    let model = SensorModel {
        quantisation: Some(DisparityQuantisation::KINECT_V1),
        ..SensorModel::PERFECT
    };
    for (point, &exact) in sense(&image, model, 0).iter().zip(image.depth_m()) {
        if !exact.is_finite() || exact > 20.0 {
            continue;
        }
        let eighths = FOCAL_BASELINE / f64::from(point.z) * 8.0;
        assert!((eighths - eighths.round()).abs() < 1e-3, "{eighths}");
        let exact_eighths = FOCAL_BASELINE / f64::from(exact) * 8.0;
        assert!((eighths - exact_eighths).abs() < 0.501);
    }
}

#[test]
fn perfect_sensor_measures_exactly() {
    let image = table();
    for (pixel, point) in sense(&image, SensorModel::PERFECT, 0).iter().enumerate() {
        let exact = image.depth_m()[pixel];
        assert!((point.z - exact).abs() <= 1e-6 * exact);
        let ray = CAMERA.ray((pixel % 640) as f64, (pixel / 640) as f64);
        assert!((f64::from(point.x) - ray.x * f64::from(exact)).abs() < 1e-5);
        assert!((f64::from(point.y) - ray.y * f64::from(exact)).abs() < 1e-5);
    }
}

/// Test modification of a sensor model.
type ModelChange = fn(&mut SensorModel);

/// Error terms: name, model with this term alone, and model with the term at strength 0.
const TERMS: [(&str, ModelChange, ModelChange); 9] = [
    (
        "quantisation",
        |m| m.quantisation = Some(DisparityQuantisation::KINECT_V1),
        |m| m.quantisation = None,
    ),
    (
        "axial noise",
        |m| m.axial_noise = Some(AxialNoise::KINECT_V1),
        |m| {
            m.axial_noise = Some(AxialNoise {
                strength: 0.0,
                ..AxialNoise::KINECT_V1
            });
        },
    ),
    (
        "lateral noise",
        |m| m.lateral_noise = Some(LateralNoise::KINECT_V1),
        |m| m.lateral_noise = Some(LateralNoise { strength: 0.0 }),
    ),
    (
        "edge fattening",
        |m| m.edge_fattening = Some(EdgeFattening::KINECT_V1),
        |m| {
            m.edge_fattening = Some(EdgeFattening {
                mean_px: 0.0,
                sigma_px: 0.0,
            });
        },
    ),
    (
        "projector shadow",
        |m| m.projector_shadow = Some(ProjectorShadow::KINECT_V1),
        |m| m.projector_shadow = None,
    ),
    (
        "weak signal",
        |m| m.weak_signal = Some(WeakSignal::KINECT_V1),
        |m| {
            m.weak_signal = Some(WeakSignal {
                none_below: 0.0,
                all_above: 0.0,
                grazing_none_cos: 0.0,
                grazing_all_cos: 0.0,
                mirror: 0.0,
            });
        },
    ),
    (
        "border speckle",
        |m| m.border_speckle = Some(BorderSpeckle::KINECT_V1),
        |m| {
            m.border_speckle = Some(BorderSpeckle { missing_share: 0.0 });
        },
    ),
    (
        "range",
        |m| {
            m.range = Some(DepthRange {
                min_m: 0.9,
                ..DepthRange::KINECT_V1
            });
        },
        |m| {
            m.range = Some(DepthRange {
                min_m: 0.0,
                max_m: 20.0,
            });
        },
    ),
    (
        "blind columns",
        |m| m.n_blind_columns = 8,
        |m| m.n_blind_columns = 0,
    ),
];

#[test]
fn error_terms_change_depth_only_when_switched_on() {
    let image = table();
    let perfect = bytes(&sense(&image, SensorModel::PERFECT, 0));
    for (name, on, off) in TERMS {
        let (mut with, mut without) = (SensorModel::PERFECT, SensorModel::PERFECT);
        on(&mut with);
        off(&mut without);
        assert!(
            bytes(&sense(&image, with, 0)) != perfect,
            "{name} has no effect"
        );
        assert!(
            bytes(&sense(&image, without, 0)) == perfect,
            "{name} is never off"
        );
    }
    let colored = SensorModel {
        color: ColorResponse::KINECT_V1,
        ..SensorModel::PERFECT
    };
    let points = sense(&image, colored, 0);
    let same_depth = bytes(&points)
        .chunks(4)
        .zip(perfect.chunks(4))
        .all(|(a, b)| a[..3] == b[..3]);
    assert!(same_depth && bytes(&points) != perfect);
}

#[test]
fn noise_repeats_for_a_shot_and_differs_for_another_frame_or_seed() {
    let image = table();
    let model = SensorModel::KINECT_V1;
    let first = bytes(&sense(&image, model, 4));
    assert!(first == bytes(&sense(&image, model, 4)));
    assert!(first != bytes(&sense(&image, model, 5)));
    let mut sensor = KinectSensor::new(CAMERA, model).unwrap();
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut take = |seed| {
        let shot = FrameSeed {
            seed,
            frame_index: 4,
        };
        sensor.sense(&image, shot, &mut points).unwrap();
        bytes(&points)
    };
    // The buffers of another image leave no trace.
    assert!(take(6) != first && take(5) == first);
}

#[test]
fn noise_of_a_pixel_does_not_depend_on_the_rest_of_the_image() {
    let mesh = PreparedMesh::new(&rectangle(40.0, 40.0, 1, [200; 3]));
    let box_mesh = PreparedMesh::new(&cuboid([0.1; 3], 2, [90, 10, 10]));
    let wall = Instance::new(
        &mesh,
        synthetic::turned(0.0, 0.0, 1.2, [0.0, std::f64::consts::PI, 0.0]),
        1,
    );
    let mut rasterizer = Rasterizer::new(CAMERA).unwrap();
    let alone = rasterizer.render(&[wall]).clone();
    let object = Instance::new(&box_mesh, at(-0.4, 0.0, 1.0), 2);
    let with = rasterizer.render(&[object, wall]).clone();
    let model = SensorModel {
        color: ColorResponse::PERFECT,
        ..SensorModel::KINECT_V1
    };
    let (a, b) = (sense(&alone, model, 1), sense(&with, model, 1));
    let right_half = (0..CAMERA.n_pixels()).filter(|pixel| pixel % 640 > 320);
    for pixel in right_half {
        assert_eq!(a[pixel].z.to_bits(), b[pixel].z.to_bits());
    }
}

#[test]
fn projector_shadow_is_left_of_a_box_and_has_the_computed_width() {
    let wall = PreparedMesh::new(&rectangle(40.0, 40.0, 1, [200; 3]));
    let mesh = PreparedMesh::new(&cuboid([0.3, 0.3, 0.02], 2, [90, 10, 10]));
    let (z_wall, z_box) = (1.6, 0.91);
    let instances = [
        Instance::new(
            &wall,
            synthetic::turned(0.0, 0.0, z_wall, [0.0, std::f64::consts::PI, 0.0]),
            1,
        ),
        Instance::new(&mesh, at(0.05, 0.0, z_box), 2),
    ];
    let image = Rasterizer::new(CAMERA).unwrap().render(&instances).clone();
    let model = SensorModel {
        projector_shadow: Some(ProjectorShadow::KINECT_V1),
        ..SensorModel::PERFECT
    };
    let points = sense(&image, model, 0);
    let width_px = FOCAL_BASELINE * (1.0 / (z_box - 0.01) - 1.0 / z_wall);
    for row in [180, 240, 300] {
        let ids = &image.instance()[row * 640..(row + 1) * 640];
        let first = ids.iter().position(|&id| id == 2).unwrap();
        let missing: Vec<usize> = (0..640)
            .filter(|column| points[row * 640 + column].z.is_nan())
            .collect();
        assert!(missing.iter().all(|&column| column < first));
        assert_eq!(missing.last(), Some(&(first - 1)));
        assert!(
            (missing.len() as f64 - width_px).abs() < 1.5,
            "{} {width_px}",
            missing.len()
        );
    }
}

#[test]
fn edge_fattening_grows_objects_by_one_to_three_pixels() {
    let mesh = PreparedMesh::new(&cuboid([0.3, 0.3, 0.02], 2, [90, 10, 10]));
    let image = Rasterizer::new(CAMERA)
        .unwrap()
        .render(&[Instance::new(&mesh, at(0.0, 0.0, 1.01), 2)])
        .clone();
    let model = SensorModel {
        edge_fattening: Some(EdgeFattening::KINECT_V1),
        ..SensorModel::PERFECT
    };
    let n_exact = image.instance().iter().filter(|&&id| id == 2).count() as f64;
    let points = sense(&image, model, 0);
    let n_seen = points.iter().filter(|point| point.is_finite()).count() as f64;
    let growth_px = (n_seen.sqrt() - n_exact.sqrt()) / 2.0;
    assert!((0.8..2.0).contains(&growth_px), "{growth_px}");
}

#[test]
fn lateral_noise_of_borders_follows_the_published_law() {
    let mesh = PreparedMesh::new(&cuboid([0.3, 0.5, 0.02], 2, [90, 10, 10]));
    let image = Rasterizer::new(CAMERA)
        .unwrap()
        .render(&[Instance::new(&mesh, at(0.0, 0.0, 1.01), 2)])
        .clone();
    let model = SensorModel {
        lateral_noise: Some(LateralNoise::KINECT_V1),
        ..SensorModel::PERFECT
    };
    let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
    for frame in 0..10 {
        let points = sense(&image, model, frame);
        for row in 140..340 {
            let columns = &points[row * 640..(row + 1) * 640];
            let first = columns.iter().position(Point::is_finite).unwrap() as f64;
            sum += first;
            squares += first * first;
            n += 1.0;
        }
    }
    let sigma_px: f64 = (squares / n - (sum / n) * (sum / n)).sqrt();
    // Rounding to whole pixels adds a twelfth to the variance.
    let expected = (0.8_f64 * 0.8 + 1.0 / 12.0).sqrt();
    assert!(
        (sigma_px / expected - 1.0).abs() < 0.15,
        "{sigma_px} {expected}"
    );
}

#[test]
fn missing_depth_increases_with_inclination() {
    let shares = [0.0, 60.0, 76.0, 80.0, 84.0].map(|angle_deg: f64| {
        let image = plane(1.0, angle_deg.to_radians());
        let points = sense(&image, SensorModel::KINECT_V1, 0);
        let middle = (180..300).flat_map(|row| (300..340).map(move |column| row * 640 + column));
        middle.filter(|&pixel| !points[pixel].is_finite()).count() as f64 / 4800.0
    });
    assert!(shares[0] == 0.0 && shares[1] < 0.01, "{shares:?}");
    assert!(
        shares.windows(2).all(|pair| pair[0] <= pair[1]),
        "{shares:?}"
    );
    assert!(shares[4] > 0.5, "{shares:?}");
}

#[test]
fn missing_depth_appears_on_polished_and_black_spheres() {
    let share = |specular: f32, infrared: f32| {
        let mesh = PreparedMesh::new(&with_surface(ball(0.1, 40, [128; 3]), specular, infrared));
        let image = Rasterizer::new(CAMERA)
            .unwrap()
            .render(&[Instance::new(&mesh, at(0.0, 0.0, 1.0), 1)])
            .clone();
        let points = sense(&image, SensorModel::KINECT_V1, 0);
        let seen: Vec<usize> = (0..points.len())
            .filter(|&pixel| {
                image.instance()[pixel] == 1 && image.reflection()[pixel].cos_incidence > 90
            })
            .collect();
        seen.iter()
            .filter(|&&pixel| !points[pixel].is_finite())
            .count() as f64
            / seen.len() as f64
    };
    let (usual, polished, black) = (share(0.0, 1.0), share(0.9, 1.0), share(0.0, 0.03));
    assert!(
        usual < 0.02 && polished > 0.15 && black > 0.15,
        "{usual} {polished} {black}"
    );
}

#[test]
fn sensor_rejects_foreign_images_and_buffers() {
    let other = PinholeCamera {
        fx_px: 500.0,
        ..CAMERA
    };
    let mut sensor = KinectSensor::new(other, SensorModel::PERFECT).unwrap();
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let image = plane(1.0, 0.0);
    assert_eq!(
        sensor.sense(&image, FrameSeed::default(), &mut points),
        Err(Error::ForeignImage)
    );
    let mut sensor = KinectSensor::new(CAMERA, SensorModel::PERFECT).unwrap();
    assert_eq!(
        sensor.sense(&image, FrameSeed::default(), &mut points[1..]),
        Err(Error::CloudSize {
            n_points: CAMERA.n_pixels() - 1,
            n_pixels: CAMERA.n_pixels()
        })
    );
}

#[test]
fn sensor_measures_images_of_any_size() {
    let mesh = PreparedMesh::new(&cuboid([0.1; 3], 2, [90, 10, 10]));
    for (width, height) in [(1, 1), (1, 9), (9, 1), (5, 3), (70, 2)] {
        let camera = PinholeCamera {
            fx_px: f64::from(width.max(height)),
            fy_px: f64::from(width.max(height)),
            cx_px: f64::from(width) / 2.0,
            cy_px: f64::from(height) / 2.0,
            width,
            height,
        };
        let mut rasterizer = Rasterizer::new(camera).unwrap();
        let mut sensor = KinectSensor::new(camera, SensorModel::KINECT_V1).unwrap();
        let mut points = vec![Point::default(); camera.n_pixels()];
        for frame_index in 0..20 {
            let place = at(0.05 * (frame_index as f64 - 10.0), 0.0, 0.6);
            let image = rasterizer.render(&[Instance::new(&mesh, place, 1)]);
            let shot = FrameSeed {
                seed: 1,
                frame_index,
            };
            sensor.sense(image, shot, &mut points).unwrap();
        }
    }
}

#[test]
fn edge_fattening_stays_within_its_row() {
    // The box ends two columns before the image does.
    let mesh = PreparedMesh::new(&cuboid([0.2, 0.2, 0.02], 2, [90, 10, 10]));
    let x = (637.5 - CAMERA.cx_px) / CAMERA.fx_px - 0.1;
    let image = Rasterizer::new(CAMERA)
        .unwrap()
        .render(&[Instance::new(&mesh, at(x, 0.0, 1.01), 1)])
        .clone();
    let model = SensorModel {
        edge_fattening: Some(EdgeFattening {
            mean_px: 3.0,
            sigma_px: 0.0,
        }),
        ..SensorModel::PERFECT
    };
    let points = sense(&image, model, 0);
    assert!(points[240 * 640 + 639].is_finite());
    assert!((0..480).all(|row| !points[row * 640].is_finite()));
}
