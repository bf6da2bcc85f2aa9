//! The input's surface, ready to be compared with any number of files.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_fit::CloudFit;
use super::samples::{self, MOST};
use super::triangles::Triangles;
use crate::error::{Error, Result};
use crate::model::cloud::Cloud;
use crate::model::discs::Discs;
use crate::model::frame::Frame;
use crate::model::mesh::Mesh;
use crate::render::input::{Model, Style};
use crate::render::mesh_normals::MeshNormals;

/// Points of a cloud, or vertices of a mesh, that are looked at: all but of very large inputs,
/// whose points are then chosen evenly in the order of the file.
const MOST_POINTS: usize = 4 * MOST;

/// The places of an input's surface that are looked at, and a way to the nearest place of it.
pub struct InputSurface<'a> {
    pub(super) frame: Frame,
    pub(super) probes: Vec<Probe>,
    pub(super) shape: Shape<'a>,
}

/// What the surface is made of.
pub(super) enum Shape<'a> {
    Mesh { triangles: Triangles<'a>, area: f64 },
    Cloud(CloudFit<'a>),
}

/// A place of the input's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    pub(super) at: DVec3,
    /// Zero where it is not known.
    pub(super) normal: DVec3,
    /// Whether the normal's sign means anything.
    pub(super) signed: bool,
    pub(super) weight: f64,
}

impl<'a> InputSurface<'a> {
    /// Makes a surface ready.
    ///
    /// # Errors
    /// [`Error::Usage`] for a mesh without any area, and for a cloud without its discs.
    pub fn new(model: Model<'a>) -> Result<Self> {
        let frame = model.cloud().frame;
        let (probes, shape) = match model {
            Model::Mesh(mesh) => of_mesh(mesh)?,
            Model::Surface(cloud, discs) => of_cloud(cloud, discs)?,
            Model::Cloud(_) => {
                return Err(Error::Usage(
                    "points alone are no surface to measure against: give their discs".into(),
                ));
            }
        };
        Ok(Self { frame, probes, shape })
    }
}

fn of_mesh(mesh: &Mesh) -> Result<(Vec<Probe>, Shape<'_>)> {
    let areas = samples::areas(mesh);
    let area: f64 = areas.iter().sum();
    if area.is_nan() || area <= 0.0 {
        return Err(Error::Usage("the mesh to measure against has no area".into()));
    }
    let normals = MeshNormals::new(mesh, Style::default().normals);
    let probe = |at, normal, weight| Probe { at, normal, signed: true, weight };
    let spots = samples::on_mesh(mesh, &areas);
    let inside =
        spots.iter().map(|spot| probe(spot.at, normals.at(spot.triangle as usize, spot.weights), 1.0));
    let mut probes: Vec<Probe> = inside.collect();
    probes.extend(corners(mesh, &areas).into_iter().map(|at| probe(at, DVec3::ZERO, 0.0)));
    Ok((probes, Shape::Mesh { triangles: Triangles::new(mesh), area }))
}

fn of_cloud<'a>(cloud: &'a Cloud, discs: &'a Discs) -> Result<(Vec<Probe>, Shape<'a>)> {
    let fit = CloudFit::new(&cloud.positions, discs)?;
    let points: Vec<u32> = (0..cloud.positions.len() as u32).collect();
    let probe = |point: u32| {
        let given = cloud.normals.get(point as usize).and_then(|normal| normal.as_dvec3().try_normalize());
        Probe {
            at: cloud.positions[point as usize].as_dvec3(),
            normal: given.unwrap_or_else(|| fit.normal(point as usize)),
            signed: given.is_some(),
            weight: 1.0,
        }
    };
    let probes = samples::thinned(&points, MOST_POINTS).into_par_iter().map(probe).collect();
    Ok((probes, Shape::Cloud(fit)))
}

/// Corners of the triangles that have an area.
fn corners(mesh: &Mesh, areas: &[f64]) -> Vec<DVec3> {
    let mut used = vec![false; mesh.vertices.positions.len()];
    for (corners, _) in mesh.triangles.iter().zip(areas).filter(|(_, area)| **area > 0.0) {
        corners.iter().for_each(|&corner| used[corner as usize] = true);
    }
    let positions = mesh.vertices.positions.iter().zip(used);
    let corners: Vec<Vec3> = positions.filter(|(_, used)| *used).map(|(position, _)| *position).collect();
    samples::thinned(&corners, MOST_POINTS).into_iter().map(Vec3::as_dvec3).collect()
}

impl Probe {
    /// Angle to a unit normal, degrees.
    pub(super) fn angle(&self, normal: DVec3) -> f64 {
        let cosine = if self.signed { self.normal.dot(normal) } else { self.normal.dot(normal).abs() };
        libm::atan2(self.normal.cross(normal).length(), cosine).to_degrees()
    }
}
