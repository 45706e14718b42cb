//! Golden-vector test: the numbers of the authors' programs are reproduced.

mod reference_vectors;

use description::{Descriptor, DescriptorFrame, Good, ObjectPoints, reference_frame};
use reference_vectors::{ReferenceVector, all_published, all_workspace};

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
    Good::new(vector.n_bins, vector.variant)
        .expect("the parameters are valid")
        .compute(ObjectPoints::all(&vector.cloud), frame, &mut out)
        .expect("the cloud has points");
    out
}

/// Compares descriptors in the recorded frame, and the recomputed frame with the
/// recorded one.
fn check(vectors: &[ReferenceVector]) {
    for vector in vectors {
        let found_again =
            reference_frame(ObjectPoints::all(&vector.cloud)).expect("the cloud has points");
        assert_eq!(found_again, vector.frame, "{}", vector.name);
        let difference = largest_difference(&described(vector, &vector.frame), &vector.descriptor);
        assert!(difference < 1e-6, "{}: {difference}", vector.name);
    }
    assert_eq!(vectors.len(), 76);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn good_equals_the_published_program_in_frames_and_descriptors() {
    check(&all_published());
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn good_equals_the_workspace_program_in_frames_and_descriptors() {
    check(&all_workspace());
}
