//! Object descriptors: GOOD and the frame it is computed in.
