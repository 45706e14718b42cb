//! Categories and instance-based recognition with unknowns.
