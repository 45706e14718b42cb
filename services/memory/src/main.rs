//! Owns the perceptual memory and answers teach, correct and forget.

fn main() {}
