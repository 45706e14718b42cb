//! Viewpoint entropy: how evenly the visible area is shared by the objects.

/// Total area `S` of the viewpoint entropy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TotalArea {
    /// All visible area, background included: a view with more of the objects has more entropy.
    #[default]
    Visible,
    /// Area of the objects alone: a pure measure of balance.
    Objects,
}

/// Viewpoint entropy `-sum (A_i / S) log(A_i / S)` over the objects, in units of the logarithm's
/// base (Kasaei et al. 2018, equation 2; after Vazquez et al. 2001). 0 without visible objects; at
/// most the logarithm of the number of objects.
///
/// `areas_m2` are those of the objects, `background_m2` that of the rest; `base` is greater than 1.
pub fn view_entropy(areas_m2: &[f64], background_m2: f64, total: TotalArea, base: f64) -> f64 {
    let objects_m2: f64 = areas_m2.iter().sum();
    let total_m2 = match total {
        TotalArea::Visible => objects_m2 + background_m2,
        TotalArea::Objects => objects_m2,
    };
    let term = |area_m2: &f64| {
        let share = area_m2 / total_m2;
        if share > 0.0 {
            -share * share.ln()
        } else {
            0.0
        }
    };
    // The sum of nothing would be -0.
    let nats = areas_m2.iter().map(term).fold(0.0, |sum, term| sum + term);
    nats / base.ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn equal_areas_have_the_logarithm_of_their_number() {
        for n in [1_usize, 2, 5, 15] {
            let areas = vec![0.01; n];
            let entropy = |base| view_entropy(&areas, 0.0, TotalArea::Visible, base);
            assert!((entropy(2.0) - (n as f64).log2()).abs() < 1e-12);
            assert!((entropy(std::f64::consts::E) - (n as f64).ln()).abs() < 1e-12);
        }
    }

    #[test]
    fn background_takes_its_share_of_the_total_only() {
        // Shares of 1/4 for each of two objects: 2 * 1/4 * 2 bit.
        let areas = [0.01, 0.01];
        assert!((view_entropy(&areas, 0.02, TotalArea::Visible, 2.0) - 1.0).abs() < 1e-12);
        assert!((view_entropy(&areas, 0.02, TotalArea::Objects, 2.0) - 1.0).abs() < 1e-12);
        assert!((view_entropy(&areas, 0.14, TotalArea::Visible, 2.0) - 0.5).abs() < 1e-12);
        assert!((view_entropy(&areas, 0.14, TotalArea::Objects, 2.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_visible_is_zero() {
        for total in [TotalArea::Visible, TotalArea::Objects] {
            let nothing = view_entropy(&[], 0.0, total, 2.0);
            assert!(nothing == 0.0 && nothing.is_sign_positive(), "{nothing}");
            assert_eq!(view_entropy(&[0.0, 0.0], 0.0, total, 2.0), 0.0);
            assert_eq!(view_entropy(&[0.0, 0.0], 1.0, total, 2.0), 0.0);
        }
    }

    proptest! {
        #[test]
        fn entropy_is_between_zero_and_the_logarithm_of_the_number(
            areas in prop::collection::vec(0.0..1.0_f64, 1..30), background in 0.0..10.0_f64,
        ) {
            let n = areas.len() as f64;
            let balance = view_entropy(&areas, background, TotalArea::Objects, 2.0);
            prop_assert!((0.0..=n.log2() + 1e-9).contains(&balance));
            // With background there are in effect n + 1 areas, of which one is not counted.
            let entropy = view_entropy(&areas, background, TotalArea::Visible, 2.0);
            prop_assert!((0.0..=(n + 1.0).log2() + 1e-9).contains(&entropy));
        }
    }
}
