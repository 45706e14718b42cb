//! Perceptual memory over rusty-leveldb with a durable environment.
