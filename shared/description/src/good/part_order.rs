//! The order of the three parts of a descriptor.

/// Indices of the parts: the one of most entropy first, the first of equal ones;
/// then the other two by ascending variance, in their own order when equal.
pub(super) fn order_of_parts(parts: [&[f32]; 3]) -> [usize; 3] {
    let entropies = parts.map(entropy_bits);
    let mut first = 0;
    for part in 1..3 {
        if entropies[part] > entropies[first] {
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

/// Shannon's entropy of a distribution.
fn entropy_bits(shares: &[f32]) -> f32 {
    shares
        .iter()
        .filter(|&&share| share != 0.0)
        .fold(0.0, |sum, share| sum - share * share.log2())
}

/// Variance of the bin's index in the flattened histogram, counted from 1.
fn index_variance(shares: &[f32]) -> f32 {
    let indexed = || (1_u16..).map(f32::from).zip(shares);
    let mean = indexed().fold(0.0, |sum, (i, share)| sum + i * share);
    indexed().fold(0.0, |sum, (i, share)| sum + (i - mean) * (i - mean) * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entropy_leads_and_variance_orders_the_rest() {
        let even = [0.25; 4];
        let narrow = [0.5, 0.5, 0.0, 0.0];
        let wide = [0.5, 0.0, 0.0, 0.5];
        assert_eq!(order_of_parts([&wide, &narrow, &even]), [2, 1, 0]);
        assert_eq!(order_of_parts([&wide, &even, &narrow]), [1, 2, 0]);
        assert_eq!(order_of_parts([&even, &narrow, &wide]), [0, 1, 2]);
    }

    #[test]
    fn equal_parts_keep_their_order() {
        let part = [0.1, 0.2, 0.3, 0.4];
        assert_eq!(order_of_parts([&part, &part, &part]), [0, 1, 2]);
    }
}
