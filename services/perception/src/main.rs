//! The frame loop, the track table and the object actors.

fn main() {}
