//! Detection stages, for timing.

/// Detection stage of an organised cloud, in the order of execution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DetectionStage {
    /// Subsampling of the point cloud.
    Subsampling,
    /// Search for the table plane.
    TablePlane,
    /// Construction of table surface cells and outline.
    TableSurface,
    /// Prism filter: selects the pixels above the table.
    PrismFilter,
    /// Connected components, with people and robot masked.
    Clustering,
    /// Segmentation of the clusters into objects.
    Segmentation,
    /// Splitting and merging of clusters, guided by tracks.
    TrackRegrouping,
    /// Growth of the clusters down to the support plane.
    SupportPlaneGrowth,
    /// Fitting of bounding boxes and support relations.
    BoundingBoxes,
    /// Constraint evaluation and output of the candidates.
    ConstraintEvaluation,
}
