//! The steps of the search.

/// A step of the search in an image, in the order in which they are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// The points in range are sampled on a grid.
    Samples,
    /// The plane of the table is found.
    TablePlane,
    /// Its cells and outline.
    TableSurface,
    /// The points over it are listed.
    Prism,
    /// They are joined to clusters, apart from people and robot.
    Clusters,
    /// Clusters of several objects are parted along creases.
    Piles,
    /// Clusters are parted and joined by the expected tracks.
    Regrouping,
    /// Clusters grow down to the table.
    Feet,
    /// Boxes around the clusters.
    Boxes,
    /// Constraints and rule; candidates are written.
    Judging,
}
