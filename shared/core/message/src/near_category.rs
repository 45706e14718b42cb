//! Candidate category of an object.

use crate::Text;
use bytemuck::{Pod, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// Maximum number of nearest categories in a message.
pub const MAX_NEAR_CATEGORIES: usize = 4;

/// Candidate category of an object with its distance and probability.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.NearCategory.v4")]
#[repr(C)]
pub struct NearCategory {
    /// Name of the nearby category.
    pub label: Text,
    /// Distance in descriptor space to the category's nearest view; NaN for none.
    pub distance: f32,
    /// Probability that the object belongs to the category, 0 to 1.
    pub probability: f32,
}

const _: () = assert!(size_of::<NearCategory>() == 140);

impl Default for NearCategory {
    fn default() -> Self {
        Self {
            label: Text::default(),
            distance: f32::NAN,
            probability: 0.0,
        }
    }
}

impl NearCategory {
    /// Valid entries among the first `n` categories of a message: name, distance, probability.
    /// Entries without a valid name or number are skipped; nothing is returned when `n` exceeds
    /// the length.
    pub(crate) fn valid_entries(
        categories: &[Self],
        n: u32,
    ) -> impl Iterator<Item = (&str, f32, f32)> {
        let valid_entries = categories.get(..n as usize).unwrap_or_default();
        valid_entries.iter().filter_map(|category| {
            let distance = Some(category.distance).filter(|d| d.is_finite() && *d >= 0.0)?;
            let probability = Some(category.probability).filter(|p| (0.0..=1.0).contains(p))?;
            Some((category.label.as_str()?, distance, probability))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_categories_are_skipped() {
        let near = |distance| NearCategory {
            label: Text::truncated("mug"),
            distance,
            probability: 0.25,
        };
        let given = [near(0.1), near(f32::NAN), near(-1.0), near(0.5)];
        let valid_entries: Vec<_> = NearCategory::valid_entries(&given, 4).collect();
        assert_eq!(valid_entries, [("mug", 0.1, 0.25), ("mug", 0.5, 0.25)]);
        assert_eq!(NearCategory::valid_entries(&given, 1).count(), 1);
        assert_eq!(NearCategory::valid_entries(&given, 5).count(), 0);
        assert_eq!(NearCategory::valid_entries(&given, u32::MAX).count(), 0);
    }
}
