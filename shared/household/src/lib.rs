//! Generated household objects: parametric families whose instances differ.
