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

impl Cloud {
    /// The cloud without some of its points, which are numbered ascending. `dropped` stays: it
    /// tells of the file.
    #[must_use]
    pub fn without(&self, left_out: &[u32]) -> Self {
        let kept = |n: usize| left_out.binary_search(&(n as u32)).is_err();
        Self {
            frame: self.frame,
            positions: only(&self.positions, kept),
            normals: only(&self.normals, kept),
            colors: only(&self.colors, kept),
            dropped: self.dropped,
        }
    }
}

/// Those of some values whose numbers are kept.
fn only<T: Copy>(values: &[T], kept: impl Fn(usize) -> bool) -> Vec<T> {
    values.iter().enumerate().filter(|&(n, _)| kept(n)).map(|(_, value)| *value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_takes_its_attributes_along() {
        let cloud = Cloud {
            positions: vec![Vec3::X, Vec3::Y, Vec3::Z],
            colors: vec![[1; 3], [2; 3], [3; 3]],
            dropped: 4,
            ..Cloud::default()
        };
        let kept = cloud.without(&[1]);
        assert_eq!((kept.positions, kept.colors), (vec![Vec3::X, Vec3::Z], vec![[1; 3], [3; 3]]));
        assert_eq!((kept.normals.len(), kept.dropped), (0, 4));
        assert_eq!(cloud.without(&[]).positions, cloud.positions);
    }
}
