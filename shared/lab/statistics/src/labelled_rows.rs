//! Labelled rows: training examples of two classes.

/// Rows of features with their class.
#[derive(Debug, Clone, Copy)]
pub struct LabelledRows<'a> {
    /// Features, row by row.
    pub features: &'a [f32],
    /// Number of features of a row.
    pub n_features: usize,
    /// Class of each row.
    pub labels: &'a [bool],
}
