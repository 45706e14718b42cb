//! What an object is most like.

use crate::Text;
use bytemuck::{Pod, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// Most categories that an object is compared with in a message.
pub const MAX_NEAR_CATEGORIES: usize = 4;

/// A category and how far the object is from it.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.NearCategory.v3")]
#[repr(C)]
pub struct NearCategory {
    /// The category.
    pub label: Text,
    /// Dissimilarity to its nearest view; NaN for none.
    pub distance: f32,
}

const _: () = assert!(size_of::<NearCategory>() == 136);

impl Default for NearCategory {
    fn default() -> Self {
        Self {
            label: Text::default(),
            distance: f32::NAN,
        }
    }
}

impl NearCategory {
    /// The first `n` of a message's categories. What is no name or no distance is
    /// left out, and so is everything when there are fewer than `n`.
    pub(crate) fn meant(categories: &[Self], n: u32) -> impl Iterator<Item = (&str, f32)> {
        let meant = categories.get(..n as usize).unwrap_or_default();
        meant.iter().filter_map(|category| {
            let distance = Some(category.distance).filter(|d| d.is_finite() && *d >= 0.0)?;
            Some((category.label.as_str()?, distance))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_category_is_left_out() {
        let near = |distance| NearCategory {
            label: Text::truncated("mug"),
            distance,
        };
        let given = [near(0.1), near(f32::NAN), near(-1.0), near(0.5)];
        let meant: Vec<_> = NearCategory::meant(&given, 4).collect();
        assert_eq!(meant, [("mug", 0.1), ("mug", 0.5)]);
        assert_eq!(NearCategory::meant(&given, 1).count(), 1);
        assert_eq!(NearCategory::meant(&given, 5).count(), 0);
        assert_eq!(NearCategory::meant(&given, u32::MAX).count(), 0);
    }
}
