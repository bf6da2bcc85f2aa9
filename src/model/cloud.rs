//! A point cloud as it was read.

use glam::Vec3;

use super::frame::Frame;

/// Points in model units, with what the file says of each.
///
/// Every attribute vector is either empty (the input has none) or as long as `positions`.
#[derive(Clone, Debug, Default)]
pub struct Cloud {
    /// Where the model lies in the input's coordinates.
    pub frame: Frame,
    /// Positions in model units, each within `[-1, 1]`, all finite.
    pub positions: Vec<Vec3>,
    /// Normals as the file gives them: perhaps not unit, perhaps zero, perhaps not finite.
    pub normals: Vec<Vec3>,
    /// Colours, sRGB, 8 bits a channel.
    pub colors: Vec<[u8; 3]>,
    /// Points left out on reading, because a coordinate was NaN or infinite.
    pub dropped: usize,
}
