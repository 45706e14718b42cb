//! The sensor: a Kinect, a fakenect folder, a recorded sequence, a folder of scenes or a synthetic table.

fn main() {}
