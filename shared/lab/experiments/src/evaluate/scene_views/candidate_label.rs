//! Candidate label: match of a detected candidate with the ground-truth mask.

use point_cloud::Point;

/// Number of pixels with depth of each object of a frame, indexed by object number.
pub(super) fn visible_pixels(mask: &[u16], points: &[Point], n_objects: usize) -> Vec<usize> {
    let mut counts = vec![0; n_objects + 1];
    for (&id, point) in mask.iter().zip(points) {
        if let Some(count) = counts.get_mut(usize::from(id))
            && point.is_finite()
        {
            *count += 1;
        }
    }
    counts
}

/// Ground-truth label of a detected candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CandidateLabel {
    /// Object of this number, from 1: most of the candidate's pixels show it, and at least half of
    /// the object's visible pixels belong to the candidate.
    Object(u16),
    /// Smaller part of the object of this number: most of the candidate's pixels show it.
    Part(u16),
    /// False candidate: it shows no object.
    NoObject,
}

/// Label of the candidate with these pixels, from the object number of each pixel and the objects'
/// visible pixels.
pub(super) fn label(pixels: &[u32], mask: &[u16], visible: &[usize]) -> CandidateLabel {
    let mut counts = vec![0; visible.len()];
    for &pixel in pixels {
        if let Some(count) = counts.get_mut(usize::from(mask[pixel as usize])) {
            *count += 1;
        }
    }
    let objects = counts.iter().enumerate().skip(1);
    match objects.max_by_key(|(_, count)| **count) {
        Some((id, n_common)) if 2 * n_common > pixels.len() => {
            let is_object = 2 * n_common >= visible[id];
            if is_object {
                CandidateLabel::Object(id as u16)
            } else {
                CandidateLabel::Part(id as u16)
            }
        }
        _ => CandidateLabel::NoObject,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn label_needs_most_of_the_candidates_and_half_of_the_objects_pixels() {
        // Two objects of six and of four pixels, two pixels of the table, one of the arm.
        let mask = [1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 0, 0, u16::MAX];
        let points = [Point::default(); 13];
        let visible = visible_pixels(&mask, &points, 2);
        assert_eq!(visible[1..], [6, 4]);
        let check = |pixels: &[u32], expected: CandidateLabel| {
            assert_eq!(label(pixels, &mask, &visible), expected, "{pixels:?}");
        };
        check(&[0, 1, 2, 3], CandidateLabel::Object(1));
        check(&[0, 1, 2], CandidateLabel::Object(1));
        check(&[0, 1], CandidateLabel::Part(1));
        // Half of its own is not most.
        check(&[6, 7, 0, 1], CandidateLabel::NoObject);
        check(&[6, 7, 8, 0, 1], CandidateLabel::Object(2));
        check(&[10, 11, 12, 6], CandidateLabel::NoObject);
        check(&[], CandidateLabel::NoObject);
    }

    #[test]
    fn pixels_without_depth_are_not_visible() {
        let mut points = [Point::default(); 4];
        points[2].z = f32::NAN;
        assert_eq!(visible_pixels(&[1, 1, 1, 0], &points, 1)[1], 2);
    }
}
