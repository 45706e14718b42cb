//! Borrowed points of one object.

use crate::{Error, WhiteBalance};
use point_cloud::{Point, Rgba};

/// View of one object's points: a whole cloud, or a selection by index. Nothing is
/// copied.
#[derive(Debug, Clone, Copy)]
pub struct ObjectPoints<'a> {
    cloud: &'a [Point],
    indices: Option<&'a [u32]>,
    /// Every `step`-th point counts.
    step: usize,
    white_balance: WhiteBalance,
}

impl<'a> ObjectPoints<'a> {
    /// Object that consists of all points of a cloud.
    pub fn all(cloud: &'a [Point]) -> Self {
        Self {
            cloud,
            indices: None,
            step: 1,
            white_balance: WhiteBalance::NEUTRAL,
        }
    }

    /// Points of `cloud` at `indices`, in the order of the indices.
    ///
    /// # Errors
    /// When an index lies outside the cloud.
    pub fn selected(cloud: &'a [Point], indices: &'a [u32]) -> Result<Self, Error> {
        match indices.iter().max() {
            Some(&index) if index as usize >= cloud.len() => Err(Error::IndexOutsideCloud {
                index,
                n_points: cloud.len(),
            }),
            _ => Ok(Self {
                cloud,
                indices: Some(indices),
                step: 1,
                white_balance: WhiteBalance::NEUTRAL,
            }),
        }
    }

    /// Same points, whose colours count after a white balance.
    #[must_use]
    pub fn balanced(self, white_balance: WhiteBalance) -> Self {
        Self {
            white_balance,
            ..self
        }
    }

    /// White balance of the colours.
    pub(crate) fn white_balance(&self) -> &WhiteBalance {
        &self.white_balance
    }

    /// Evenly thinned points, at most `n_max` of them: every second, every third, and so
    /// on.
    #[must_use]
    pub fn thinned(self, n_max: usize) -> Self {
        let step = self.step * self.len().div_ceil(n_max.max(1)).max(1);
        Self { step, ..self }
    }

    /// Number of points, including those without depth.
    pub fn len(&self) -> usize {
        let n_points = self.indices.map_or(self.cloud.len(), <[u32]>::len);
        n_points.div_ceil(self.step)
    }

    /// True if the object has no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Visits the points in order. The representation is tested once, outside the loop.
    #[inline]
    pub fn for_each(&self, mut visit: impl FnMut(&Point)) {
        let point = |&i: &u32| &self.cloud[i as usize];
        match (self.indices, self.step) {
            (None, 1) => self.cloud.iter().for_each(visit),
            (None, step) => self.cloud.iter().step_by(step).for_each(visit),
            (Some(indices), step) => indices.iter().step_by(step).for_each(|i| visit(point(i))),
        }
    }

    /// Visits the points in order, in blocks of `N`; the last block is padded with
    /// points without depth.
    #[inline]
    pub(crate) fn for_each_block<const N: usize>(&self, mut visit: impl FnMut(&[Point; N])) {
        let nothing = [Point::without_depth(Rgba(0)); N];
        let (mut block, mut n) = (nothing, 0);
        self.for_each(|point| {
            block[n] = *point;
            n += 1;
            if n == N {
                visit(&block);
                n = 0;
            }
        });
        if n > 0 {
            block[n..].copy_from_slice(&nothing[n..]);
            visit(&block);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_selection_visits_its_points_in_order() {
        let cloud: Vec<Point> = (0..9)
            .map(|i| Point {
                x: i as f32,
                color: Rgba(i),
                ..Point::default()
            })
            .collect();
        let seen = |points: ObjectPoints<'_>| {
            let mut seen = Vec::new();
            points.for_each(|p| seen.push(p.color.0));
            seen
        };
        let seen_in_blocks = |points: ObjectPoints<'_>| {
            let mut seen = Vec::new();
            points.for_each_block(|block: &[Point; 4]| seen.extend(*block));
            let behind = seen.split_off(points.len());
            assert_eq!(
                behind.len(),
                points.len().next_multiple_of(4) - points.len()
            );
            assert!(behind.iter().all(|p| !p.is_finite()));
            seen.iter().map(|p| p.color.0).collect::<Vec<_>>()
        };
        for n in 0..=9 {
            let indices: Vec<u32> = (0..n).rev().collect();
            let selection = ObjectPoints::selected(&cloud, &indices).unwrap();
            assert_eq!(seen_in_blocks(selection), indices);
            let whole = ObjectPoints::all(&cloud[..n as usize]);
            assert_eq!(seen_in_blocks(whole), seen(whole));
        }
        let selection = ObjectPoints::selected(&cloud, &[8, 0, 3, 3]).unwrap();
        assert_eq!(seen(selection), [8, 0, 3, 3]);
        assert_eq!(selection.len(), 4);
        assert_eq!(seen(ObjectPoints::all(&cloud)).len(), 9);
        assert!(ObjectPoints::selected(&[], &[]).unwrap().is_empty());
        let thinned = ObjectPoints::all(&cloud).thinned(4);
        assert_eq!((thinned.len(), seen(thinned)), (3, vec![0, 3, 6]));
        assert_eq!(seen_in_blocks(selection.thinned(2)), [8, 3]);
        assert_eq!(ObjectPoints::all(&cloud).thinned(9).len(), 9);
    }

    #[test]
    fn an_index_outside_the_cloud_is_rejected() {
        let cloud = [Point::default(); 3];
        let error = ObjectPoints::selected(&cloud, &[0, 7, 3]).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("index 7, but its cloud has 3 points"),
            "{error}"
        );
    }
}
