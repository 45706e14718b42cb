//! Golden-value test of the metrics against the authors' evaluation workspace: equal
//! where the definitions agree, different as documented where they do not.

use learning::Metric;
use std::collections::HashMap;
use std::path::Path;

/// Golden distances of all pairs of clouds.
struct Reference {
    /// Reference descriptors, by cloud name.
    descriptors: HashMap<String, Vec<f32>>,
    distances: Vec<ReferenceDistance>,
}

/// Golden distance of one pair of clouds.
struct ReferenceDistance {
    /// Name of the function in the authors' program.
    function: String,
    /// Names of the two compared clouds.
    clouds: [String; 2],
    value: f64,
}

impl Reference {
    fn read() -> Self {
        let folder = test_data::path("../reference/good/vectors");
        let table = std::fs::read_to_string(folder.join("ws_distances_bins15_adaptive.csv"))
            .expect("the golden distances");
        let distances: Vec<_> = table.lines().skip(1).map(distance).collect();
        let mut descriptors = HashMap::new();
        for cloud in distances.iter().flat_map(|distance| &distance.clouds) {
            descriptors
                .entry(cloud.clone())
                .or_insert_with(|| descriptor(&folder, cloud));
        }
        Self {
            descriptors,
            distances,
        }
    }

    /// Compares all pairs of a function with the expected distance, computed from the
    /// golden one and both descriptors.
    fn check(&self, function: &str, metric: Metric, expected: impl Fn(f64, &[f32], &[f32]) -> f64) {
        let pairs = self.distances.iter().filter(|d| d.function == function);
        assert_eq!(pairs.clone().count(), 19 * 19, "{function}");
        for pair in pairs {
            let [p, q] = pair.clouds.each_ref().map(|cloud| &self.descriptors[cloud]);
            let ours = f64::from(metric.distance(p, q).expect("equal lengths"));
            let expected = expected(pair.value, p, q);
            // The reference sums sequentially in single precision.
            let tolerance = 2e-5 * expected.abs() + 3e-6;
            let clouds = &pair.clouds;
            assert!(
                (ours - expected).abs() <= tolerance,
                "{metric} {clouds:?}: {ours}, {expected}"
            );
        }
    }
}

fn distance(row: &str) -> ReferenceDistance {
    let columns: Vec<&str> = row.split(',').collect();
    ReferenceDistance {
        function: columns[0].to_owned(),
        clouds: [columns[1].to_owned(), columns[2].to_owned()],
        value: columns[3].parse().expect("a distance is a number"),
    }
}

fn descriptor(folder: &Path, cloud: &str) -> Vec<f32> {
    let path = folder.join(format!("ws_{cloud}_bins15_adaptive.csv"));
    let text = std::fs::read_to_string(path).expect("a golden vector is text");
    let row = text.lines().find_map(|row| row.strip_prefix("descriptor,"));
    let values = row.expect("there is a descriptor").split(',');
    let values = values.filter(|value| !value.is_empty());
    values
        .map(|v| v.parse().expect("a value is a number"))
        .collect()
}

fn sum(a: &[f32], b: &[f32], term: impl Fn(f64, f64) -> f64) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(&p, &q)| term(p.into(), q.into())).sum()
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn metric_equals_the_workspace_where_definitions_agree() {
    let reference = Reference::read();
    for (function, metric) in [
        ("chiSquared", Metric::ChiSquared),
        ("manhattan", Metric::Manhattan),
        ("euclidean", Metric::Euclidean),
        ("gower", Metric::Gower),
        ("canberra", Metric::Canberra),
        ("pearson", Metric::Pearson),
        ("neyman", Metric::Neyman),
        ("motyka", Metric::Motyka),
        ("sorensen", Metric::Sorensen),
        ("dice", Metric::Dice),
    ] {
        reference.check(function, metric, |theirs, _, _| theirs);
    }
    let root = Metric::HalfChiSquaredRoot;
    reference.check("chiSquared", root, |theirs, _, _| theirs.sqrt());
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn divergence_skips_bins_empty_in_both() {
    Reference::read().check("divergence", Metric::Divergence, |theirs, p, q| {
        assert!(theirs.is_nan());
        2.0 * sum(p, q, |p, q| ((p - q) / (p + q).max(1e-30)).powi(2))
    });
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn cosine_is_normalised() {
    Reference::read().check("cosine", Metric::Cosine, |theirs, p, q| {
        let norms = (sum(p, p, |p, _| p * p) * sum(q, q, |q, _| q * q)).sqrt();
        1.0 - (1.0 - theirs) / norms
    });
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn intersection_is_a_distance() {
    Reference::read().check("intersection", Metric::Intersection, |theirs, p, q| {
        1.0 - theirs / sum(p, p, |p, _| p).max(sum(q, q, |q, _| q))
    });
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn bhattacharyya_of_equal_histograms_is_zero() {
    Reference::read().check("bhattacharyya", Metric::Bhattacharyya, |theirs, p, q| {
        theirs + 0.5 * (sum(p, p, |p, _| p) * sum(q, q, |q, _| q)).ln()
    });
}

/// Terms of the bins empty in exactly one descriptor, which the authors' program skips;
/// values below 1e-6 are clamped.
fn left_out(p: &[f32], q: &[f32], term: impl Fn(f64, f64) -> f64) -> f64 {
    sum(p, q, |p, q| {
        if p * q > 0.0 {
            0.0
        } else {
            term(p.max(1e-6), q.max(1e-6))
        }
    })
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn kullback_leibler_is_natural_and_counts_bins_empty_in_one() {
    let reference = Reference::read();
    let natural = std::f64::consts::LN_10;
    reference.check("KLDivergance", Metric::KullbackLeibler, |theirs, p, q| {
        let surplus = sum(p, q, |p, q| if p * q > 0.0 { p - q } else { 0.0 });
        let left_out = left_out(p, q, |p, q| p * (p / q).ln() - p + q);
        natural * theirs - surplus + left_out
    });
    let symmetric = Metric::SymmetricKullbackLeibler;
    reference.check("symmetricKL", symmetric, |theirs, p, q| {
        natural * theirs + left_out(p, q, |p, q| 0.5 * (p - q) * (p / q).ln())
    });
}
