//! Parametric object families, grouped by their place in a household.
//!
//! Each generator is a function from random parameters to a solid that stands or lies on a table
//! with z up, with an arbitrary origin.

pub(crate) mod containers;
pub(crate) mod cookware;
pub(crate) mod crockery;
pub(crate) mod cutlery;
pub(crate) mod devices;
pub(crate) mod food;
pub(crate) mod fruit;
pub(crate) mod hardware;
pub(crate) mod leisure;
pub(crate) mod packaging;
pub(crate) mod packets;
pub(crate) mod stationery;
pub(crate) mod tools;
pub(crate) mod toys;
pub(crate) mod vegetables;
