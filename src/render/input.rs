//! Draws the input, a mesh or a cloud, as an asset is drawn: same camera, light and shading.

use glam::{DVec2, DVec3, Vec3};

use super::camera::Camera;
use super::constants::{self, MATTE};
use super::cpu;
use super::eye::{Eye, Ray};
use super::facets::Facets;
use super::mesh_normals::MeshNormals;
use super::picture::{Picture, Survey, Visibility};
use super::project::{self, Bound, Prism};
use super::settings::Settings;
use super::shade;
use super::tiles::{self, Hit, Look, Mix, Scene};
use crate::error::Result;
use crate::model::cloud::Cloud;
use crate::model::intersect::{self, LocalRay};
use crate::model::mesh::Mesh;

/// What can be drawn besides an asset.
#[derive(Clone, Copy, Debug)]
pub enum Model<'a> {
    /// Triangles, drawn exactly.
    Mesh(&'a Mesh),
    /// Points, drawn as small discs.
    Cloud(&'a Cloud),
}

/// How the input is drawn where it leaves a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Where a mesh's normals come from.
    pub normals: Normals,
    /// Radius of a cloud's discs in input units; `None` takes [`disc_radius`].
    pub point_radius: Option<f64>,
}

/// Where a mesh's normals come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normals {
    /// The file's where a triangle has three sound ones, else as [`Normals::Crease`] at
    /// [`DEFAULT_EDGE_ANGLE`](crate::tolerance::DEFAULT_EDGE_ANGLE).
    Given,
    /// The mean over the faces around a corner that turn from this one by at most so many
    /// degrees, weighted by their angle there.
    Crease(f64),
    /// Each triangle's own.
    Flat,
}

impl Default for Style {
    fn default() -> Self {
        Self { normals: Normals::Given, point_radius: None }
    }
}

impl Model<'_> {
    /// The points.
    #[must_use]
    pub fn cloud(&self) -> &Cloud {
        match self {
            Self::Mesh(mesh) => &mesh.vertices,
            Self::Cloud(cloud) => cloud,
        }
    }

    /// Diagonal of the bounding box in model units, 0 without points.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let Some(&first) = self.cloud().positions.first() else { return 0.0 };
        let (min, max) =
            self.cloud().positions.iter().fold((first, first), |(min, max), p| (min.min(*p), max.max(*p)));
        max.as_dvec3().distance(min.as_dvec3())
    }
}

/// Draws a mesh or a cloud on the CPU. The same bytes come out for any number of threads.
///
/// # Errors
/// As [`cpu::render`].
pub fn render(model: Model<'_>, camera: &Camera, settings: &Settings, style: &Style) -> Result<Picture> {
    Prepared::new(model, style).render(camera, settings)
}

/// What each pixel's ray meets first.
///
/// # Errors
/// As [`cpu::render`].
pub fn visibility(model: Model<'_>, camera: &Camera, size: [u32; 2], style: &Style) -> Result<Visibility> {
    Prepared::new(model, style).visibility(camera, size)
}

/// A model with all that does not change from camera to camera.
pub struct Prepared<'a> {
    kind: Kind<'a>,
    /// Half the diagonal, model units.
    radius: f64,
}

enum Kind<'a> {
    Mesh(&'a Mesh, MeshNormals<'a>),
    /// With the radius of its discs, model units.
    Cloud(&'a Cloud, f64),
}

impl<'a> Prepared<'a> {
    /// Makes a model ready.
    #[must_use]
    pub fn new(model: Model<'a>, style: &Style) -> Self {
        let diagonal = model.diagonal();
        let kind = match model {
            Model::Mesh(mesh) => Kind::Mesh(mesh, MeshNormals::new(mesh, style.normals)),
            Model::Cloud(cloud) => Kind::Cloud(cloud, disc(cloud, style, diagonal)),
        };
        Self { kind, radius: 0.5 * diagonal }
    }

    /// Radius of the discs that a cloud is drawn as, model units; 0 for a mesh.
    #[must_use]
    pub fn disc(&self) -> f64 {
        match self.kind {
            Kind::Mesh(..) => 0.0,
            Kind::Cloud(_, radius) => radius,
        }
    }

    /// As [`render`].
    ///
    /// # Errors
    /// As [`cpu::render`].
    pub fn render(&self, camera: &Camera, settings: &Settings) -> Result<Picture> {
        let eye = self.eye(camera, settings)?;
        let (mix, radius) = (self.mix(), self.radius);
        match &self.kind {
            Kind::Mesh(mesh, normals) => {
                cpu::picture(&Facets::new(mesh, &eye, normals), &eye, mix, settings, radius)
            }
            Kind::Cloud(cloud, disc) => {
                cpu::picture(&Discs { cloud, eye: &eye, radius: *disc }, &eye, mix, settings, radius)
            }
        }
    }

    /// As [`visibility`].
    ///
    /// # Errors
    /// As [`cpu::render`].
    pub fn visibility(&self, camera: &Camera, size: [u32; 2]) -> Result<Visibility> {
        let eye = self.eye(camera, &Settings::plain(size))?;
        Ok(match &self.kind {
            Kind::Mesh(mesh, normals) => cpu::nearest(&Facets::new(mesh, &eye, normals), &eye),
            Kind::Cloud(cloud, disc) => cpu::nearest(&Discs { cloud, eye: &eye, radius: *disc }, &eye),
        })
    }

    /// How deep what each pixel's ray meets first lies, rows from the top; infinite where it meets nothing.
    ///
    /// # Errors
    /// As [`cpu::render`].
    pub fn depths(&self, camera: &Camera, size: [u32; 2]) -> Result<Vec<f64>> {
        let eye = self.eye(camera, &Settings::plain(size))?;
        Ok(match &self.kind {
            Kind::Mesh(mesh, normals) => tiles::depths(&Facets::new(mesh, &eye, normals), &eye),
            Kind::Cloud(cloud, disc) => tiles::depths(&Discs { cloud, eye: &eye, radius: *disc }, &eye),
        })
    }

    /// As [`cpu::survey`].
    ///
    /// # Errors
    /// As [`cpu::render`].
    pub fn survey(&self, camera: &Camera, size: [u32; 2]) -> Result<Survey> {
        let eye = self.eye(camera, &Settings::plain(size))?;
        let (mix, radius) = (self.mix(), self.radius);
        match &self.kind {
            Kind::Mesh(mesh, normals) => cpu::survey_of(&Facets::new(mesh, &eye, normals), &eye, mix, radius),
            Kind::Cloud(cloud, disc) => {
                cpu::survey_of(&Discs { cloud, eye: &eye, radius: *disc }, &eye, mix, radius)
            }
        }
    }

    fn eye(&self, camera: &Camera, settings: &Settings) -> Result<Eye> {
        let frame = match self.kind {
            Kind::Mesh(mesh, _) => &mesh.vertices.frame,
            Kind::Cloud(cloud, _) => &cloud.frame,
        };
        Eye::new(camera, frame, settings.samples()?)
    }

    /// Triangles are drawn as they are. Discs of one surface overlap by less than their radius
    /// along the normal.
    fn mix(&self) -> Mix {
        match self.kind {
            Kind::Mesh(..) => Mix::Nearest,
            Kind::Cloud(_, radius) => Mix::Band { band: radius, agree: constants::agree_cosine() },
        }
    }
}

/// Radius of a cloud's discs, model units.
fn disc(cloud: &Cloud, style: &Style, diagonal: f64) -> f64 {
    let given = style.point_radius.map(|radius| radius / cloud.frame.scale());
    let radius = given.unwrap_or_else(|| disc_radius(diagonal, cloud.positions.len()));
    // A single point has no diagonal: any radius that shows it will do.
    if radius > 0.0 { radius } else { 0.1 }
}

/// Discs that just cover a surface of area `diagonal²`, about that of a cube or a ball, if
/// `count` points lie on it evenly: half the diagonal of the square that each point owns.
#[must_use]
pub fn disc_radius(diagonal: f64, count: usize) -> f64 {
    diagonal * std::f64::consts::FRAC_1_SQRT_2 / (count.max(1) as f64).sqrt()
}

/// A point's linear colour.
pub(super) fn color(cloud: &Cloud, point: usize) -> Vec3 {
    let given = cloud.colors.get(point).map(|rgb| Vec3::from(rgb.map(shade::linear_from_byte)));
    given.unwrap_or(DVec3::from(MATTE).as_vec3())
}

/// A point's unit normal, if the file gives a sound one.
pub(super) fn given_normal(cloud: &Cloud, point: usize) -> Option<DVec3> {
    cloud.normals.get(point)?.as_dvec3().try_normalize()
}

/// A cloud before a camera.
struct Discs<'a> {
    cloud: &'a Cloud,
    eye: &'a Eye,
    radius: f64,
}

impl Discs<'_> {
    fn center(&self, item: usize) -> DVec3 {
        self.eye.to_view(self.cloud.positions[item].as_dvec3())
    }

    /// The point's normal in view coordinates; without one the disc faces the eye.
    fn normal(&self, item: usize) -> DVec3 {
        given_normal(self.cloud, item).map_or(-DVec3::Z, |normal| self.eye.turn(normal))
    }
}

impl Scene for Discs<'_> {
    fn len(&self) -> usize {
        self.cloud.positions.len()
    }

    fn bound(&self, item: usize) -> Option<Bound> {
        let normal = self.normal(item);
        let (u, v) = normal.any_orthonormal_pair();
        let half_axes = [self.radius * u, self.radius * v];
        project::bound(&Prism { center: self.center(item), half_axes, normal, low: 0.0, high: 0.0 }, self.eye)
    }

    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit> {
        let (center, normal) = (self.center(item), self.normal(item));
        let lateral = (ray.at(center.z) - center.truncate()).extend(0.0);
        let local = LocalRay {
            origin: DVec3::new(0.0, 0.0, lateral.dot(normal)),
            direction: DVec3::new(0.0, 0.0, ray.direction().dot(normal)),
        };
        let s = intersect::plane_root(&local, self.radius);
        if s > self.radius {
            return None;
        }
        let ellipse = (lateral + s * ray.direction()).length_squared() / (self.radius * self.radius);
        let depth = center.z + s;
        (ellipse <= 1.0 && depth >= self.eye.near).then_some(Hit {
            depth,
            at: DVec2::ZERO,
            ellipse,
            gives_way: 0.0,
        })
    }

    fn look(&self, item: usize, _at: DVec2) -> Look {
        Look { normal: self.normal(item), color: color(self.cloud, item) }
    }
}
