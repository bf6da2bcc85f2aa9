//! Draws the input, a mesh or a cloud, as an asset is drawn: same camera, light and shading.

use glam::{DVec2, DVec3, Vec3};

use super::camera::Camera;
use super::constants::{self, MATTE};
use super::cpu;
use super::eye::{Eye, Ray};
use super::intersect::{self, LocalRay};
use super::mesh_normals::MeshNormals;
use super::picture::{Picture, Visibility};
use super::project::{self, Bound, Prism};
use super::settings::Settings;
use super::shade;
use super::tiles::{Hit, Look, Mix, Scene};
use crate::error::Result;
use crate::model::cloud::Cloud;
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
    let eye = Eye::new(camera, &model.cloud().frame, settings.samples()?)?;
    let radius = 0.5 * model.diagonal();
    match model {
        Model::Mesh(mesh) => {
            cpu::picture(&Facets::new(mesh, &eye, style.normals), &eye, Mix::Nearest, settings, radius)
        }
        Model::Cloud(cloud) => {
            let discs = Discs::new(cloud, &eye, style, model.diagonal());
            // Discs of one surface overlap by less than their radius along the normal.
            let mix = Mix::Band { band: discs.radius, agree: constants::agree_cosine() };
            cpu::picture(&discs, &eye, mix, settings, radius)
        }
    }
}

/// What each pixel's ray meets first.
///
/// # Errors
/// As [`cpu::render`].
pub fn visibility(model: Model<'_>, camera: &Camera, size: [u32; 2], style: &Style) -> Result<Visibility> {
    let eye = Eye::new(camera, &model.cloud().frame, Settings::plain(size).samples()?)?;
    Ok(match model {
        Model::Mesh(mesh) => cpu::nearest(&Facets::new(mesh, &eye, style.normals), &eye),
        Model::Cloud(cloud) => cpu::nearest(&Discs::new(cloud, &eye, style, model.diagonal()), &eye),
    })
}

/// Discs that just cover a surface of area `diagonal²`, about that of a cube or a ball, if
/// `count` points lie on it evenly: half the diagonal of the square that each point owns.
#[must_use]
pub fn disc_radius(diagonal: f64, count: usize) -> f64 {
    diagonal * std::f64::consts::FRAC_1_SQRT_2 / (count.max(1) as f64).sqrt()
}

/// A point's linear colour.
fn color(cloud: &Cloud, point: usize) -> Vec3 {
    let given = cloud.colors.get(point).map(|rgb| Vec3::from(rgb.map(shade::linear_from_byte)));
    given.unwrap_or(DVec3::from(MATTE).as_vec3())
}

/// A point's unit normal, if the file gives a sound one.
pub(super) fn given_normal(cloud: &Cloud, point: usize) -> Option<DVec3> {
    cloud.normals.get(point)?.as_dvec3().try_normalize()
}

/// A mesh before a camera.
struct Facets<'a> {
    mesh: &'a Mesh,
    eye: &'a Eye,
    /// Vertices in view coordinates.
    places: Vec<DVec3>,
    normals: MeshNormals<'a>,
}

impl<'a> Facets<'a> {
    fn new(mesh: &'a Mesh, eye: &'a Eye, normals: Normals) -> Self {
        let places = mesh.vertices.positions.iter().map(|p| eye.to_view(p.as_dvec3())).collect();
        Self { mesh, eye, places, normals: MeshNormals::new(mesh, normals) }
    }

    fn corners(&self, item: usize) -> [DVec3; 3] {
        self.mesh.triangles[item].map(|vertex| self.places[vertex as usize])
    }

    /// The smooth normals of a triangle's corners, in view coordinates.
    fn smooth(&self, item: usize) -> Option<[DVec3; 3]> {
        Some(self.normals.corners(item)?.map(|normal| self.eye.turn(normal)))
    }
}

impl Scene for Facets<'_> {
    fn len(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn bound(&self, item: usize) -> Option<Bound> {
        project::triangle_bound(self.corners(item), self.eye)
    }

    /// Woop, Benthin and Wald 2013: in the plane across the ray an edge's area is the same
    /// number, but for its sign, for both triangles beside it, so no ray slips between them.
    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit> {
        let corners = self.corners(item);
        let [a, b, c] = corners.map(|p| p.truncate() - ray.at(p.z));
        let (wa, wb, wc) = (c.perp_dot(b), a.perp_dot(c), b.perp_dot(a));
        let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
        let total = wa + wb + wc;
        if !inside || total == 0.0 {
            return None;
        }
        let at = DVec2::new(wb, wc) / total;
        let depth =
            corners[0].z + at.x * (corners[1].z - corners[0].z) + at.y * (corners[2].z - corners[0].z);
        (depth >= self.eye.near).then_some(Hit { depth, at, ellipse: 0.0 })
    }

    fn look(&self, item: usize, at: DVec2) -> Look {
        let weights = [1.0 - at.x - at.y, at.x, at.y];
        let [a, b, c] = self.corners(item);
        let flat = (b - a).cross(c - a).normalize_or_zero();
        let blend =
            |n: [DVec3; 3]| (weights[0] * n[0] + weights[1] * n[1] + weights[2] * n[2]).try_normalize();
        let normal = self.smooth(item).and_then(blend).unwrap_or(flat);
        let colors = self.mesh.triangles[item].map(|vertex| color(&self.mesh.vertices, vertex as usize));
        let color = (0..3).map(|n| weights[n] as f32 * colors[n]).sum();
        Look { normal, color }
    }
}

/// A cloud before a camera.
struct Discs<'a> {
    cloud: &'a Cloud,
    eye: &'a Eye,
    radius: f64,
}

impl<'a> Discs<'a> {
    fn new(cloud: &'a Cloud, eye: &'a Eye, style: &Style, diagonal: f64) -> Self {
        let given = style.point_radius.map(|radius| radius / cloud.frame.scale());
        let radius = given.unwrap_or_else(|| disc_radius(diagonal, cloud.positions.len()));
        // A single point has no diagonal: any radius that shows it will do.
        Self { cloud, eye, radius: if radius > 0.0 { radius } else { 0.1 } }
    }

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
        (ellipse <= 1.0 && depth >= self.eye.near).then_some(Hit { depth, at: DVec2::ZERO, ellipse })
    }

    fn look(&self, item: usize, _at: DVec2) -> Look {
        Look { normal: self.normal(item), color: color(self.cloud, item) }
    }
}
