//! Finds objects: table plane, prism above it, clusters, candidates.
