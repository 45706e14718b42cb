//! Renders meshes as a Kinect sees them: rasteriser and sensor error model.
