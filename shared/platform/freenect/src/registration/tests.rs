use super::*;
use crate::{DepthFormula, NO_DEPTH};
use geometry::RigidTransform;
use proptest::prelude::*;

/// Colour image in which each pixel encodes its own position.
fn telling_image() -> Vec<u8> {
    (0..N_PIXELS)
        .flat_map(|i| [(i >> 16) as u8, (i >> 8) as u8, i as u8])
        .collect()
}

/// Position encoded in a colour, as (column, row).
fn place_of(color: Rgba) -> (f64, f64) {
    let [r, g, b] = color.rgb();
    let index = usize::from(r) << 16 | usize::from(g) << 8 | usize::from(b);
    ((index % WIDTH) as f64, (index / WIDTH) as f64)
}

fn fill(calibration: &Calibration, depth_raw: &[u16], rgb: &[u8]) -> (Vec<Point>, FillSummary) {
    let mut cloud = vec![Point::default(); N_PIXELS];
    let builder = CloudBuilder::new(calibration).unwrap();
    let summary = builder.fill(depth_raw, rgb, &mut cloud).unwrap();
    (cloud, summary)
}

/// Compares a cloud with a double-precision reference, pixel by pixel.
fn check_against_plain(calibration: &Calibration, raw: u16) {
    let (cloud, summary) = fill(calibration, &vec![raw; N_PIXELS], &telling_image());
    let z = f64::from(DepthTable::new(calibration.formula).depth_m(raw));
    assert_eq!(summary.n_points, N_PIXELS);
    let mut n_colored = 0;
    for (index, point) in cloud.iter().enumerate() {
        let (column, row) = ((index % WIDTH) as f64, (index / WIDTH) as f64);
        let expected = calibration.depth_camera.back_project(column, row, z);
        assert!((point.position() - expected).norm() < 1e-5 * z);
        let in_color = calibration.color_from_depth * expected;
        let pixel = calibration.color_camera.project(&in_color).unwrap();
        let inside = (-0.49..639.49).contains(&pixel.x) && (-0.49..479.49).contains(&pixel.y);
        if inside {
            let (column, row) = place_of(point.color);
            // Nearest pixel, up to single-precision ties.
            assert!((column - pixel.x).abs() < 0.501 && (row - pixel.y).abs() < 0.501);
            n_colored += 1;
        } else if !(-0.51..639.51).contains(&pixel.x) || !(-0.51..479.51).contains(&pixel.y) {
            assert_eq!(point.color, NEUTRAL_GREY);
        }
    }
    assert!(summary.n_colored >= n_colored && n_colored > N_PIXELS / 2);
}

#[test]
fn the_nominal_kinect_agrees_with_the_plain_computation() {
    for raw in [0, 420, 800, 1000] {
        check_against_plain(&Calibration::nominal(), raw);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn any_kinect_agrees_with_the_plain_computation(
        raw in 300u16..1000,
        shift in prop::array::uniform3(-0.05f64..0.05),
        turn in prop::array::uniform3(-0.03f64..0.03),
    ) {
        let calibration = Calibration {
            color_from_depth: RigidTransform::new(shift.into(), turn.into()),
            formula: DepthFormula::Burrus,
            ..Calibration::nominal()
        };
        check_against_plain(&calibration, raw);
    }

    /// Fuzz test: any depth image gives finite points or points without depth.
    #[test]
    fn any_depth_image_is_taken(seed: u64) {
        let mut state = seed | 1;
        let depth: Vec<u16> = (0..N_PIXELS).map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 48) as u16
        }).collect();
        let (cloud, summary) = fill(&Calibration::nominal(), &depth, &telling_image());
        prop_assert_eq!(cloud.iter().filter(|p| p.is_finite()).count(), summary.n_points);
        prop_assert!(cloud.iter().all(|p| p.is_finite() || (p.x.is_nan() && p.y.is_nan() && p.z.is_nan())));
    }
}

#[test]
fn a_near_object_shifts_left_in_the_colour_image() {
    // The colour camera is to the right, so a near point in the same direction is further left.
    let place = |raw| {
        let (cloud, _) = fill(
            &Calibration::nominal(),
            &vec![raw; N_PIXELS],
            &telling_image(),
        );
        place_of(cloud[240 * WIDTH + 320].color).0
    };
    let (near, far) = (place(420), place(1000));
    // Disparity of a 20 mm baseline at 0.51 m and 3.8 m with a focal length of 529 px.
    assert!(
        (far - near - 529.0 * 0.02 * (1.0 / 0.51 - 1.0 / 3.8)).abs() < 3.0,
        "{near} {far}"
    );
}

#[test]
fn pixels_without_depth_are_grey_points_without_depth() {
    let (cloud, summary) = fill(
        &Calibration::nominal(),
        &vec![NO_DEPTH; N_PIXELS],
        &telling_image(),
    );
    assert_eq!(summary, FillSummary::default());
    assert!(
        cloud
            .iter()
            .all(|point| !point.is_finite() && point.color == NEUTRAL_GREY)
    );
}

#[test]
fn wrong_sizes_are_refused() {
    let builder = CloudBuilder::new(&Calibration::nominal()).unwrap();
    let check = |n_depth: usize, n_rgb: usize, n_cloud: usize, buffer: &str| {
        let mut cloud = vec![Point::default(); n_cloud];
        let error = builder
            .fill(&vec![0; n_depth], &vec![0; n_rgb], &mut cloud)
            .unwrap_err();
        assert!(error.to_string().contains(buffer), "{error}");
    };
    check(1, 3 * N_PIXELS, N_PIXELS, "depth image");
    check(N_PIXELS, N_PIXELS, N_PIXELS, "colour image");
    check(N_PIXELS, 3 * N_PIXELS, N_PIXELS - 1, "cloud");
}
