//! How far views of the same category and of other categories are apart.
//!
//! `cargo run --release -p learning --example restaurant_views` reads the folder
//! `restaurant-views` under `TABULA_DATA` and prints, for 3 and 10 taught views a
//! category, the share of right answers and the distances of the nearest taught
//! view in the own and in the nearest other category. The second row is what an
//! object of a category that was never taught would see, so a threshold for
//! "unknown" must lie between the two.
//!
//! Several categories differ only in print (cans of four brands) or a little in
//! shape (six kinds of cups), so the same is printed for families of shapes.
//!
//! The views have no camera pose. They stand upright (z up) and were taken from
//! above the horizon, so the viewer is looked for where the cloud hides least of
//! itself.
#![expect(clippy::print_stdout, reason = "it is a program that prints a table")]

use description::{Descriptor, Good, ObjectPoints, object_frame, reference_frame};
use learning::Metric;
use nalgebra::{Point3, Vector3};
use point_cloud::Point;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

const N_DRAWS: u64 = 20;
const THRESHOLDS: [f32; 6] = [0.45, 0.55, 0.65, 0.75, 0.85, 0.95];

/// A described view and the number of its category.
type Described = (usize, Vec<f32>);

/// Names of categories, and clouds with the numbers of their categories.
type Clouds = (Vec<String>, Vec<(usize, Vec<Point>)>);

/// Where the descriptor's frame comes from.
#[derive(Debug, Clone, Copy)]
enum Frame {
    Object,
    ObjectSeenFromAbove,
    Reference,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (names, clouds) = read_clouds(&data_folder().join("restaurant-views"))?;
    for frame in [Frame::Object, Frame::ObjectSeenFromAbove, Frame::Reference] {
        let views = describe(&clouds, frame)?;
        let distances = all_distances(&views)?;
        for n_taught in [3, 10] {
            println!("frame {frame:?}, {n_taught} views a category taught, by category:");
            report(&views, &distances, n_taught, |category| category);
            println!("the same by family:");
            report(&views, &distances, n_taught, |category| {
                family(&names[category])
            });
        }
    }
    Ok(())
}

/// Which categories have nearly the same shape.
fn family(name: &str) -> usize {
    match name {
        "cocacola" | "fanta" | "pepsi" | "sprite" => 0,
        "cup" | "fatmug" | "flowermug" | "highmug" | "mixmug" | "mug" => 1,
        "bowl" | "classicBowl" | "soupbowl" => 2,
        "fork" | "knife" | "spoon" => 3,
        "juice" | "milk" | "yogurt" => 4,
        _ => 5,
    }
}

fn data_folder() -> PathBuf {
    std::env::var_os("TABULA_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    )
}

fn sorted_entries(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut entries = std::fs::read_dir(folder)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()?;
    entries.sort();
    Ok(entries)
}

fn read_clouds(folder: &Path) -> Result<Clouds, Box<dyn std::error::Error>> {
    let (mut names, mut clouds) = (Vec::new(), Vec::new());
    for (category, folder) in sorted_entries(folder)?.iter().enumerate() {
        for file in sorted_entries(folder)? {
            clouds.push((category, dataset::pcd::open(&file)?.points));
        }
        names.push(
            folder
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
        );
    }
    Ok((names, clouds))
}

fn describe(
    clouds: &[(usize, Vec<Point>)],
    frame: Frame,
) -> Result<Vec<Described>, Box<dyn std::error::Error>> {
    let mut good = Good::new(15, 0.0015)?;
    let mut views = Vec::new();
    for (category, cloud) in clouds {
        let points = ObjectPoints::all(cloud);
        let frame = match frame {
            Frame::Object => object_frame(points, &viewpoint(cloud)).map(|f| f.descriptor_frame()),
            Frame::ObjectSeenFromAbove => {
                object_frame(points, &Point3::new(0.0, 0.0, 1.0)).map(|f| f.descriptor_frame())
            }
            Frame::Reference => reference_frame(points),
        };
        let mut descriptor = Vec::new();
        good.compute(
            points,
            &frame.ok_or("a view has too few points")?,
            &mut descriptor,
        )?;
        views.push((*category, descriptor));
    }
    Ok(views)
}

/// A place one metre from the object, in the direction from which it hides least.
fn viewpoint(cloud: &[Point]) -> Point3<f64> {
    let directions = (0..36).flat_map(|a| (1..8).map(move |e| (f64::from(a), f64::from(e))));
    let to_viewer = directions
        .map(|(a, e)| {
            let (azimuth, elevation) = ((10.0 * a).to_radians(), (10.0 * e).to_radians());
            let level = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
            level * elevation.cos() + Vector3::z() * elevation.sin()
        })
        .min_by(|a, b| hidden_depth(cloud, a).total_cmp(&hidden_depth(cloud, b)));
    Point3::from(to_viewer.unwrap_or_default())
}

/// Mean spread of depth within pixels of 4 mm, seen from the direction.
fn hidden_depth(cloud: &[Point], to_viewer: &Vector3<f64>) -> f64 {
    let right = Vector3::z().cross(to_viewer).normalize();
    let up = to_viewer.cross(&right);
    let mut pixels: HashMap<(i32, i32), (f64, f64)> = HashMap::new();
    for p in cloud
        .iter()
        .filter(|p| p.is_finite())
        .map(|p| p.position().coords)
    {
        let at = |axis: &Vector3<f64>| (p.dot(axis) / 0.004).floor() as i32;
        let depth = p.dot(to_viewer);
        let range = pixels
            .entry((at(&right), at(&up)))
            .or_insert((depth, depth));
        *range = (range.0.min(depth), range.1.max(depth));
    }
    pixels.values().map(|(near, far)| far - near).sum::<f64>() / pixels.len() as f64
}

fn all_distances(views: &[Described]) -> Result<Vec<Vec<f32>>, learning::Error> {
    let metric = Metric::HalfChiSquaredRoot;
    let row = |a: &Described| views.iter().map(|b| metric.distance(&a.1, &b.1)).collect();
    views.iter().map(row).collect()
}

/// Teaches views drawn at random, several times, and asks all the others.
fn report(
    views: &[Described],
    distances: &[Vec<f32>],
    n_taught: usize,
    label: impl Fn(usize) -> usize,
) {
    let (mut own, mut other, mut n_right) = (Vec::new(), Vec::new(), 0);
    let labels: Vec<usize> = views.iter().map(|view| label(view.0)).collect();
    for draw in 0..N_DRAWS {
        let taught = draw_views(views, n_taught, draw);
        for asked in (0..views.len()).filter(|asked| !taught.contains(asked)) {
            let nearest = |is_own: bool| {
                taught
                    .iter()
                    .filter(|&&view| (labels[view] == labels[asked]) == is_own)
                    .map(|&view| distances[asked][view])
                    .fold(f32::INFINITY, f32::min)
            };
            own.push(nearest(true));
            other.push(nearest(false));
            n_right += u32::from(nearest(true) < nearest(false));
        }
    }
    print_distances(own, other, n_right);
}

fn print_distances(mut own: Vec<f32>, mut other: Vec<f32>, n_right: u32) {
    println!(
        "  right answers: {:.3}",
        f64::from(n_right) / own.len() as f64
    );
    for (name, values) in [("own category  ", &mut own), ("other category", &mut other)] {
        values.sort_by(f32::total_cmp);
        let quantile = |share: f64| values[(share * (values.len() - 1) as f64) as usize];
        let quantiles = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99].map(quantile);
        println!("  nearest in {name}, 1 5 25 50 75 95 99 %: {quantiles:.3?}");
    }
    for threshold in THRESHOLDS {
        let below = |sorted: &[f32]| {
            sorted.partition_point(|&d| d <= threshold) as f64 / sorted.len() as f64
        };
        let (own, other) = (below(&own), below(&other));
        println!("  threshold {threshold}: own {own:.3}, other {other:.3} accepted");
    }
}

/// `n_taught` views of each category, drawn by Knuth's linear congruences.
fn draw_views(views: &[Described], n_taught: usize, seed: u64) -> Vec<usize> {
    let mut state = seed;
    let mut order: Vec<(u64, usize)> = (0..views.len())
        .map(|view| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 32, view)
        })
        .collect();
    order.sort_unstable();
    let mut n_drawn: HashMap<usize, usize> = HashMap::new();
    order.retain(|&(_, view)| {
        let n = n_drawn.entry(views[view].0).or_default();
        *n += 1;
        *n <= n_taught
    });
    order.into_iter().map(|(_, view)| view).collect()
}
