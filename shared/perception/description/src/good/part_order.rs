//! Order of the three parts of a GOOD descriptor.

/// Criterion that selects the first part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FirstPartCriterion {
    /// Part with the largest Shannon entropy first, as published.
    MostEntropy,
    /// Largest number of non-empty bins. The workspace's program calls it entropy,
    /// taking every non-empty bin as equally full.
    MostOccupiedBins,
}

impl FirstPartCriterion {
    fn score(self, shares: &[f32]) -> f32 {
        match self {
            Self::MostEntropy => entropy_bits(shares),
            Self::MostOccupiedBins => shares
                .iter()
                .map(|&s| u16::from(s != 0.0))
                .sum::<u16>()
                .into(),
        }
    }
}

/// Indices of the parts: the one with the highest criterion first, then the other two by
/// ascending variance. Ties keep the original order.
pub(super) fn order_of_parts(
    parts: [&[f32]; 3],
    first_part_criterion: FirstPartCriterion,
) -> [usize; 3] {
    let scores = parts.map(|shares| first_part_criterion.score(shares));
    let mut first = 0;
    for part in 1..3 {
        if scores[part] > scores[first] {
            first = part;
        }
    }
    let (a, b) = match first {
        0 => (1, 2),
        1 => (0, 2),
        _ => (0, 1),
    };
    if index_variance(parts[a]) <= index_variance(parts[b]) {
        [first, a, b]
    } else {
        [first, b, a]
    }
}

/// Shannon entropy of a distribution, bits.
fn entropy_bits(shares: &[f32]) -> f32 {
    shares
        .iter()
        .filter(|&&share| share != 0.0)
        .fold(0.0, |sum, share| sum - share * share.log2())
}

/// Variance of the one-based bin index in the flattened histogram.
fn index_variance(shares: &[f32]) -> f32 {
    let indexed = || (1_u16..).map(f32::from).zip(shares);
    let mean = indexed().fold(0.0, |sum, (i, share)| sum + i * share);
    indexed().fold(0.0, |sum, (i, share)| sum + (i - mean) * (i - mean) * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(parts: [&[f32]; 3]) -> [usize; 3] {
        order_of_parts(parts, FirstPartCriterion::MostEntropy)
    }

    #[test]
    fn entropy_leads_and_variance_orders_the_rest() {
        let even = [0.25; 4];
        let narrow = [0.5, 0.5, 0.0, 0.0];
        let wide = [0.5, 0.0, 0.0, 0.5];
        assert_eq!(order([&wide, &narrow, &even]), [2, 1, 0]);
        assert_eq!(order([&wide, &even, &narrow]), [1, 2, 0]);
        assert_eq!(order([&even, &narrow, &wide]), [0, 1, 2]);
    }

    #[test]
    fn occupied_bins_lead_where_entropy_does_not() {
        let even = [0.5, 0.0, 0.0, 0.5];
        let spread = [0.96, 0.02, 0.02, 0.0];
        let single = [0.0, 1.0, 0.0, 0.0];
        let parts: [&[f32]; 3] = [&even, &spread, &single];
        assert_eq!(order(parts), [0, 2, 1]);
        assert_eq!(
            order_of_parts(parts, FirstPartCriterion::MostOccupiedBins),
            [1, 2, 0]
        );
    }

    #[test]
    fn equal_parts_keep_their_order() {
        let part = [0.1, 0.2, 0.3, 0.4];
        for first_part_criterion in [
            FirstPartCriterion::MostEntropy,
            FirstPartCriterion::MostOccupiedBins,
        ] {
            assert_eq!(
                order_of_parts([&part, &part, &part], first_part_criterion),
                [0, 1, 2]
            );
        }
    }
}
