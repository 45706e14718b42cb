//! Percentiles by nearest rank.

/// The middle and the slow end of durations.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Percentiles {
    /// Half of the durations are not longer.
    pub p50: f64,
    /// 99 of 100 durations are not longer.
    pub p99: f64,
}

impl Percentiles {
    /// Of values of any unit, by nearest rank; `None` without values.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        Some(Self {
            p50: nearest_rank(&values, 0.5)?,
            p99: nearest_rank(&values, 0.99)?,
        })
    }
}

/// The least of sorted values that a share of them, 0 to 1, does not exceed; `None`
/// without values.
pub fn nearest_rank<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_by_nearest_rank() {
        let of = |n: u32| Percentiles::of((1..=n).rev().map(f64::from).collect());
        for (n, p50, p99) in [
            (1, 1.0, 1.0),
            (2, 1.0, 2.0),
            (4, 2.0, 4.0),
            (200, 100.0, 198.0),
        ] {
            assert_eq!(of(n), Some(Percentiles { p50, p99 }), "{n} values");
        }
        assert_eq!(of(0), None);
    }
}
