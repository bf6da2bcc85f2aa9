//! Draws the input, a mesh or a cloud, as an asset is drawn: same camera, light and shading.

use std::borrow::Cow;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::camera::Camera;
use super::constants::{self, MATTE};
use super::cpu;
use super::disc_scene::{DiscScene, Extent};
use super::eye::Eye;
use super::facets::Facets;
use super::mesh_normals::MeshNormals;
use super::picture::{Picture, Survey, Visibility};
use super::settings::Settings;
use super::shade;
use super::tiles::Mix;
use crate::error::Result;
use crate::model::cloud::Cloud;
use crate::model::discs::{Disc, Discs};
use crate::model::mesh::Mesh;

/// What can be drawn besides an asset.
#[derive(Clone, Copy, Debug)]
pub enum Model<'a> {
    /// Triangles, drawn exactly.
    Mesh(&'a Mesh),
    /// Points, drawn as small discs of one size.
    Cloud(&'a Cloud),
    /// The surface that points tell of, a disc for each, drawn as these.
    Surface(&'a Cloud, &'a Discs),
}

/// How the input is drawn where it leaves a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Where a mesh's normals come from.
    pub normals: Normals,
    /// Radius of the discs of a [`Model::Cloud`] in input units; `None` takes [`disc_radius`].
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
            Self::Cloud(cloud) | Self::Surface(cloud, _) => cloud,
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
    Cloud(&'a Cloud, Cow<'a, Discs>),
}

/// What rays surely meet of a model, and may meet. Rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Met {
    /// How deep what each pixel's ray surely meets first lies at most, model units; infinite where it may
    /// meet nothing.
    pub surely: Vec<f64>,
    /// Whether the ray may meet anything, or the pixel shows a part of a mesh that slips between all rays near.
    pub perhaps: Vec<bool>,
}

impl<'a> Prepared<'a> {
    /// Makes a model ready.
    #[must_use]
    pub fn new(model: Model<'a>, style: &Style) -> Self {
        let diagonal = model.diagonal();
        let kind = match model {
            Model::Mesh(mesh) => Kind::Mesh(mesh, MeshNormals::new(mesh, style.normals)),
            Model::Cloud(cloud) => Kind::Cloud(cloud, Cow::Owned(even(cloud, style, diagonal))),
            Model::Surface(cloud, discs) => Kind::Cloud(cloud, Cow::Borrowed(discs)),
        };
        Self { kind, radius: 0.5 * diagonal }
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
            Kind::Cloud(cloud, discs) => {
                let scene = DiscScene::new(cloud, discs, &eye, Extent::Margin);
                cpu::picture(&scene, &eye, mix, settings, radius)
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
            Kind::Cloud(cloud, discs) => {
                cpu::nearest(&DiscScene::new(cloud, discs, &eye, Extent::Margin), &eye)
            }
        })
    }

    /// Whether rays surely meet all that they may.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        matches!(self.kind, Kind::Mesh(..))
    }

    /// As [`Self::all_met`], before one camera.
    ///
    /// # Errors
    /// As [`cpu::render`].
    pub fn met(&self, camera: &Camera, size: [u32; 2]) -> Result<Met> {
        Ok(self.all_met(std::slice::from_ref(camera), size)?.swap_remove(0))
    }

    /// What rays meet, surely or perhaps, before each of some cameras.
    ///
    /// Of a mesh they surely meet all that they may. Where it is thinner than a pixel, it may touch pixels whose
    /// rays miss it, as do those of the eight around: its outline runs there all the same.
    ///
    /// A cloud tells its surface no better than its discs do. Across one that is seen so flat that the
    /// surface may turn away from the eye over it, the outline runs: somewhere, and the discs stand out
    /// there. So rays may meet such a disc, but not surely; nor do they one that is open beyond its margin,
    /// or any where it reaches out into a gap between the points.
    /// What they surely meet lies as deep as it may, off the disc's plane.
    ///
    /// # Errors
    /// As [`cpu::render`].
    pub fn all_met(&self, cameras: &[Camera], size: [u32; 2]) -> Result<Vec<Met>> {
        let eyes = cameras.iter().map(|camera| self.eye(camera, &Settings::plain(size)));
        let eyes: Vec<Eye> = eyes.collect::<Result<_>>()?;
        Ok(match &self.kind {
            Kind::Mesh(mesh, normals) => {
                eyes.par_iter().map(|eye| Facets::new(mesh, eye, normals).met()).collect()
            }
            Kind::Cloud(cloud, discs) => DiscScene::all_met(cloud, discs, &eyes),
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
            Kind::Cloud(cloud, discs) => {
                cpu::survey_of(&DiscScene::new(cloud, discs, &eye, Extent::Margin), &eye, mix, radius)
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
        match &self.kind {
            Kind::Mesh(..) => Mix::Nearest,
            Kind::Cloud(_, discs) => Mix::Band { band: mean_margin(discs), agree: constants::agree_cosine() },
        }
    }
}

/// Mean radius of discs, model units.
fn mean_margin(discs: &Discs) -> f64 {
    let sum: f64 = discs.all().iter().map(|disc| f64::from(disc.margin)).sum();
    sum / discs.all().len().max(1) as f64
}

/// Discs of one size around all points, at right angles to sound normals, else facing the eye.
fn even(cloud: &Cloud, style: &Style, diagonal: f64) -> Discs {
    let count = cloud.positions.len();
    let given = style.point_radius.map(|radius| radius / cloud.frame.scale());
    let radius = given.unwrap_or_else(|| disc_radius(diagonal, count));
    // A single point has no diagonal: any radius that shows it will do.
    let margin = if radius > 0.0 { radius as f32 } else { 0.1 };
    let disc = |point| {
        let normal = given_normal(cloud, point).unwrap_or(DVec3::ZERO).as_vec3();
        Disc { normal, margin, ..Disc::default() }
    };
    Discs::new((0..count).map(disc).collect(), &[])
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
