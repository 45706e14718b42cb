//! Memory-bandwidth floor: the cost of reading a cloud once.

use point_cloud::Point;

/// Sum of the bytes of a cloud, eight at a time: the minimum work of reading a cloud once.
pub fn sum_of_words(points: &[Point]) -> u64 {
    let word = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
    points.iter().fold(0, |sum: u64, point| {
        sum.wrapping_add(word(point.x.to_bits(), point.y.to_bits()))
            .wrapping_add(word(point.z.to_bits(), point.color.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    #[test]
    fn checksum_depends_on_every_byte() {
        let point = Point {
            x: 1.0,
            y: 2.0,
            z: 3.0,
            color: Rgba(4),
        };
        let sum = sum_of_words(&[point, point]);
        for changed in [
            Point { x: 1.5, ..point },
            Point { y: 1.5, ..point },
            Point { z: 1.5, ..point },
            Point {
                color: Rgba(5),
                ..point
            },
        ] {
            assert_ne!(sum_of_words(&[point, changed]), sum);
        }
    }
}
