//! The published implementation's numbers are reproduced.

mod reference_vectors;

use description::{Descriptor, DescriptorFrame, Good, ObjectPoints, reference_frame};
use reference_vectors::{ReferenceVector, all_published};

/// Largest difference between the values of two descriptors.
fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

fn described(vector: &ReferenceVector, frame: &DescriptorFrame) -> Vec<f32> {
    let mut out = Vec::new();
    Good::new(vector.n_bins, vector.sign_threshold_m)
        .expect("the parameters are valid")
        .compute(ObjectPoints::all(&vector.cloud), frame, &mut out)
        .expect("the cloud has points");
    out
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn with_the_published_frame_every_descriptor_is_the_published_one() {
    let vectors = all_published();
    for vector in &vectors {
        let out = described(vector, &vector.frame);
        let difference = largest_difference(&out, &vector.descriptor);
        assert!(difference < 1e-6, "{}: {difference}", vector.name);
    }
    assert_eq!(vectors.len(), 76);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn the_ported_solver_finds_every_published_frame_to_the_last_bit() {
    for vector in all_published() {
        let frame = reference_frame(ObjectPoints::all(&vector.cloud)).unwrap();
        assert_eq!(frame, vector.frame, "{}", vector.name);
        let difference = largest_difference(&described(&vector, &frame), &vector.descriptor);
        assert!(difference < 1e-6, "{}: {difference}", vector.name);
    }
}
