//! Detection buffers, reused from frame to frame.

use crate::organized::OrganizedBuffers;
use crate::unorganized::UnorganizedBuffers;

/// Detection buffers, reused from frame to frame.
#[derive(Debug, Default)]
pub struct Workspace {
    pub(crate) organized: OrganizedBuffers,
    /// Buffers for clouds without an image grid; boxed because most users never need
    /// them.
    pub(crate) unorganized: Option<Box<UnorganizedBuffers>>,
}
