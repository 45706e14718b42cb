//! Motion filter, association and key-view rule.
