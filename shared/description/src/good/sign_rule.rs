//! The published rule for the direction of the projections.

use super::projected_points::ProjectedPoints;

/// One sign for both axes of the plane, +1 or -1: the product of the signs along
/// x and y. `n_points` counts the points without depth too.
pub(super) fn shared_sign(points: &ProjectedPoints, n_points: usize, threshold_m: f32) -> f32 {
    axis_sign(&points.x, n_points, threshold_m) * axis_sign(&points.y, n_points, threshold_m)
}

/// -1 when the points below `-threshold_m` outnumber those above `threshold_m`
/// by a tenth of all points or more, else +1.
fn axis_sign(coordinates_m: &[f32], n_points: usize, threshold_m: f32) -> f32 {
    let count = |outside: fn(f32, f32) -> bool| {
        coordinates_m
            .iter()
            .map(|&a| u32::from(outside(a, threshold_m)))
            .sum::<u32>() as usize
    };
    let above = count(|a, t| a > t);
    let below = count(|a, t| a < -t);
    if above < below && below - above >= n_points / 10 {
        -1.0
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_majority_of_a_tenth_turns_an_axis() {
        let check = |below: usize, above: usize, n_points: usize, expected: f32| {
            let values = [vec![-0.01; below], vec![0.01; above], vec![-0.001; 5]].concat();
            assert_eq!(
                axis_sign(&values, n_points, 0.0015),
                expected,
                "{below} {above}"
            );
        };
        check(10, 9, 10, -1.0);
        check(10, 9, 20, 1.0);
        check(11, 9, 20, -1.0);
        check(11, 9, 30, 1.0);
        check(9, 10, 9, 1.0);
        check(5, 5, 5, 1.0);
    }
}
