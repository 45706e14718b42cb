//! Correlation of paired values: Pearson's, and Spearman's by ranks.

/// Pearson's correlation coefficient of pairs, -1 to 1. `None` for fewer than two pairs, or when
/// the values of one side are all equal.
pub fn pearson(pairs: &[(f64, f64)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let mean = |side: fn(&(f64, f64)) -> f64| pairs.iter().map(side).sum::<f64>() / n;
    let (mean_x, mean_y) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        let (dx, dy) = (x - mean_x, y - mean_y);
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    let scale = (xx * yy).sqrt();
    (pairs.len() > 1 && scale > 0.0).then(|| (xy / scale).clamp(-1.0, 1.0))
}

/// Spearman's rank correlation coefficient of pairs, -1 to 1; equal values share their mean rank.
/// `None` as for [`pearson`].
pub fn spearman(pairs: &[(f64, f64)]) -> Option<f64> {
    let x = ranks(&pairs.iter().map(|pair| pair.0).collect::<Vec<_>>());
    let y = ranks(&pairs.iter().map(|pair| pair.1).collect::<Vec<_>>());
    pearson(&x.into_iter().zip(y).collect::<Vec<_>>())
}

/// Rank of each value, from 0; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equals in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let rank = first as f64 + (equals.len() as f64 - 1.0) / 2.0;
        for &index in equals {
            ranks[index] = rank;
        }
        first += equals.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_match_worked_examples() {
        // Anscombe's first set (1973): r = 0.816.
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [
            8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68,
        ];
        let pairs: Vec<_> = x.into_iter().zip(y).collect();
        assert!((pearson(&pairs).unwrap() - 0.816).abs() < 0.001);
        // Differences of ranks: sum of squares 40, so that rho = 1 - 6 * 40 / (11 * 120).
        assert!((spearman(&pairs).unwrap() - 0.818).abs() < 0.001);
    }

    #[test]
    fn monotone_values_have_full_rank_correlation() {
        let pairs: Vec<_> = (1..30)
            .map(|i| (f64::from(i), f64::from(i).powi(5)))
            .collect();
        assert!((spearman(&pairs).unwrap() - 1.0).abs() < 1e-12);
        assert!(pearson(&pairs).unwrap() < 0.9);
        let falling: Vec<_> = pairs.iter().map(|(x, y)| (*x, -y)).collect();
        assert!((spearman(&falling).unwrap() + 1.0).abs() < 1e-12);
    }

    #[test]
    fn equal_values_share_their_rank_and_constant_ones_have_no_correlation() {
        assert_eq!(ranks(&[2.0, 1.0, 2.0, 3.0]), [1.5, 0.0, 1.5, 3.0]);
        let constant = [(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)];
        assert_eq!((pearson(&constant), spearman(&constant)), (None, None));
        assert_eq!((pearson(&[(1.0, 2.0)]), pearson(&[])), (None, None));
    }
}
