//! The camera as the kernels see it: model units, an orthonormal basis, a ray per sample.

use glam::{DVec2, DVec3};

use super::camera::{Camera, NEAR_FRACTION, Projection};
use crate::error::Result;
use crate::model::frame::Frame;

/// A camera in model units for a picture of a given size.
///
/// *View coordinates* are `(right, up, forward)`; the third is the *view depth*. Depths, the
/// near plane and the rays are all measured by it, for both projections.
#[derive(Clone, Debug)]
pub struct Eye {
    /// The eye, model units.
    pub position: DVec3,
    /// Unit direction to the right of the picture.
    pub right: DVec3,
    /// Unit direction up the picture.
    pub up: DVec3,
    /// Unit viewing direction.
    pub forward: DVec3,
    /// Least view depth that is drawn.
    pub near: f64,
    /// Half the picture's height: at view depth 1 under perspective, anywhere otherwise.
    pub half_height: f64,
    /// Whether rays leave the eye's point (perspective) or its plane.
    pub perspective: bool,
    /// Width and height in samples.
    pub size: [u32; 2],
}

/// A ray in view coordinates: at view depth `z` it passes `offset + z * slope`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it leaves the eye's plane; zero under perspective.
    pub offset: DVec2,
    /// Sideways motion for each unit of view depth; zero for an orthographic camera.
    pub slope: DVec2,
}

impl Ray {
    /// The sideways place at a view depth.
    #[must_use]
    pub fn at(&self, depth: f64) -> DVec2 {
        self.offset + depth * self.slope
    }

    /// The direction, with a view depth of 1.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.slope.extend(1.0)
    }
}

impl Eye {
    /// Places a camera over a model.
    ///
    /// # Errors
    /// As [`Camera::check`].
    pub fn new(camera: &Camera, frame: &Frame, size: [u32; 2]) -> Result<Self> {
        camera.check()?;
        let (ahead, up) = camera.directions();
        let (distance, forward) = (ahead.length(), ahead.normalize());
        let right = forward.cross(up.normalize()).normalize();
        let scale = frame.scale();
        let (perspective, half_height) = match camera.projection {
            Projection::Perspective { fov_degrees } => (true, libm::tan(0.5 * fov_degrees.to_radians())),
            Projection::Orthographic { height } => (false, 0.5 * height / scale),
        };
        Ok(Self {
            position: frame.to_model(camera.eye.into()),
            right,
            up: right.cross(forward),
            forward,
            near: camera.near.unwrap_or(NEAR_FRACTION * distance) / scale,
            half_height,
            perspective,
            size,
        })
    }

    /// A point of the model in view coordinates.
    #[must_use]
    pub fn to_view(&self, point: DVec3) -> DVec3 {
        self.turn(point - self.position)
    }

    /// A direction of the model in view coordinates.
    #[must_use]
    pub fn turn(&self, direction: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(direction), self.up.dot(direction), self.forward.dot(direction))
    }

    /// A direction of view coordinates in the model's.
    #[must_use]
    pub fn turn_back(&self, direction: DVec3) -> DVec3 {
        direction.x * self.right + direction.y * self.up + direction.z * self.forward
    }

    /// Samples for each unit of the plane at depth 1 (perspective) or any depth.
    #[must_use]
    pub fn samples_per_unit(&self) -> f64 {
        0.5 * f64::from(self.size[1]) / self.half_height
    }

    /// The middle of the picture in samples.
    #[must_use]
    pub fn middle(&self) -> DVec2 {
        0.5 * DVec2::new(f64::from(self.size[0]), f64::from(self.size[1]))
    }

    /// The ray through a place of the picture, in samples from its upper left corner.
    #[must_use]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let plane = (DVec2::new(x, y) - self.middle()) * DVec2::new(1.0, -1.0) / self.samples_per_unit();
        if self.perspective {
            Ray { offset: DVec2::ZERO, slope: plane }
        } else {
            Ray { offset: plane, slope: DVec2::ZERO }
        }
    }

    /// The ray through the middle of a sample.
    #[must_use]
    pub fn ray_through(&self, [x, y]: [u32; 2]) -> Ray {
        self.ray(f64::from(x) + 0.5, f64::from(y) + 0.5)
    }

    /// The place of the model that the ray through the middle of a pixel passes at a view depth.
    #[must_use]
    pub fn place(&self, pixel: [u32; 2], depth: f64) -> DVec3 {
        let across = self.ray_through(pixel).at(depth);
        self.position + self.turn_back(across.extend(depth))
    }

    /// The least and greatest view depth of a sphere around the model's origin, in front of
    /// the near plane and never empty.
    #[must_use]
    pub fn depth_range(&self, radius: f64) -> [f64; 2] {
        let middle = self.to_view(DVec3::ZERO).z;
        let near = (middle - radius).max(self.near);
        [near, (middle + radius).max(near + radius.max(f64::MIN_POSITIVE))]
    }
}
