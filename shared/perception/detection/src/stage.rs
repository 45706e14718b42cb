//! Detection stages, for timing.

/// Detection stage of an organised cloud, in the order of execution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Subsampling of the cloud.
    Samples,
    /// Table plane search.
    TablePlane,
    /// Table surface cells and outline.
    TableSurface,
    /// Prism filter: pixels above the table.
    Prism,
    /// Connected components, with people and robot masked.
    Clusters,
    /// Concavity split of clusters of several objects.
    Piles,
    /// Track-guided splitting and merging of clusters.
    Regrouping,
    /// Growth of the clusters down to the support plane.
    Feet,
    /// Bounding boxes and support relations.
    Boxes,
    /// Constraint evaluation and output of the candidates.
    Judging,
}
