//! Publishes the frames of a source at their instants.
