//! Sign disambiguation of the axes by point majority.

use crate::projected_points::{Block, LANES, ProjectedPoints};

/// Majority rule that reverses an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct SignRule {
    /// Half width of the ignored band around the middle, metres.
    pub(super) band_m: f32,
    /// Majority of points below the band that reverses the axis.
    pub(super) margin_points: usize,
}

impl SignRule {
    /// Common sign of both axes, +1 or -1: the product of the signs along x and y.
    pub(super) fn shared_sign(self, points: &ProjectedPoints) -> f32 {
        self.axis_sign(points.blocks(), |block| &block.x)
            * self.axis_sign(points.blocks(), |block| &block.y)
    }

    /// Sign of one axis: -1 when the points below the band outnumber those above it by
    /// the margin or more, else +1.
    fn axis_sign(self, blocks: &[Block], axis: impl Fn(&Block) -> &[f32; LANES]) -> f32 {
        let (mut above, mut below) = ([0_u32; LANES], [0_u32; LANES]);
        for block in blocks {
            let coordinates_m = axis(block);
            for i in 0..LANES {
                above[i] += u32::from(coordinates_m[i] > self.band_m);
                below[i] += u32::from(coordinates_m[i] < -self.band_m);
            }
        }
        let total = |lanes: [u32; LANES]| lanes.iter().map(|&n| n as usize).sum::<usize>();
        let (above, below) = (total(above), total(below));
        if above < below && below - above >= self.margin_points {
            -1.0
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(rule: SignRule, below: usize, above: usize, expected: f32) {
        let values = [vec![-0.02; below], vec![0.02; above], vec![-0.001; 5]].concat();
        let blocks: Vec<Block> = values
            .chunks(LANES)
            .map(|chunk| {
                let mut block = Block::EMPTY;
                block.x[..chunk.len()].copy_from_slice(chunk);
                block
            })
            .collect();
        let sign = rule.axis_sign(&blocks, |block| &block.x);
        assert_eq!(sign, expected, "{below} {above} {rule:?}");
    }

    #[test]
    fn a_majority_of_the_margin_turns_an_axis() {
        let rule = |margin_points| SignRule {
            band_m: 0.0015,
            margin_points,
        };
        check(rule(1), 10, 9, -1.0);
        check(rule(2), 10, 9, 1.0);
        check(rule(2), 11, 9, -1.0);
        check(rule(3), 11, 9, 1.0);
        check(rule(0), 9, 10, 1.0);
        check(rule(0), 5, 5, 1.0);
    }

    #[test]
    fn points_within_the_band_are_ignored() {
        for (band_m, expected) in [(0.019, -1.0), (0.02, 1.0)] {
            let margin_points = 1;
            check(
                SignRule {
                    band_m,
                    margin_points,
                },
                10,
                0,
                expected,
            );
        }
    }
}
