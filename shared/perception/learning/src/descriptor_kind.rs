//! Kind of the descriptors that this version computes, stores and compares.

/// Descriptor kind of this version; only descriptors of equal kind are comparable.
pub const DESCRIPTOR_KIND: &str = "appearance-2-upright";
