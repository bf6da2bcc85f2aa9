//! Primitives to geometry in the scene's coordinates.

use glam::{DMat3, DVec3, Vec3};
use gltf_json::accessor::Type;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;

use super::super::assemble::Geometry;
use super::super::color::WHITE;
use super::super::faces::{self, Shape};
use super::super::positions::Positions;
use super::document::Document;
use super::light::Light;
use super::scene::Placed;
use crate::error::{Error, Result};

/// Which primitives are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Triangles,
    Points,
}

/// All wanted primitives of a scene in one.
pub(super) struct Flattened<'a> {
    document: &'a Document<'a>,
    wanted: Wanted,
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    colors: Vec<[u8; 3]>,
    triangles: Vec<[u32; 3]>,
    light: Light<'a>,
}

impl<'a> Flattened<'a> {
    pub fn new(document: &'a Document<'a>, wanted: Wanted) -> Self {
        let light = Light::new(document);
        let (positions, normals, colors) = (Vec::new(), Vec::new(), Vec::new());
        Self { document, wanted, positions, normals, colors, triangles: Vec::new(), light }
    }

    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    pub fn into_geometry(self) -> Geometry<'static> {
        let triangles = (self.wanted == Wanted::Triangles).then_some(self.triangles);
        let positions = Positions::Stored(self.positions);
        Geometry { positions, normals: self.normals, colors: self.colors, triangles }
    }

    /// Adds the wanted primitives of a mesh.
    pub fn add_mesh(&mut self, placed: &Placed) -> Result<()> {
        let document = self.document;
        let mesh = document.get(placed.mesh, &format!("nodes[{}].mesh", placed.node))?;
        for (n, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{}].primitives[{n}]", placed.mesh.value());
            let Checked::Valid(mode) = primitive.mode else {
                return Err(document.source.at(place, "its mode is unknown; export the file again"));
            };
            let kind = match mode {
                Mode::Points => Some(Wanted::Points),
                Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan => Some(Wanted::Triangles),
                Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
            };
            if kind == Some(self.wanted) {
                self.add(primitive, mode, placed, &place)?;
            }
        }
        Ok(())
    }

    fn add(&mut self, primitive: &Primitive, mode: Mode, placed: &Placed, place: &str) -> Result<()> {
        let document = self.document;
        let before = self.positions.len();
        let Some(part) = self.part(primitive, placed, place)? else { return Ok(()) };
        let corners = corners(document, primitive, part.positions.len(), place)?;
        if mode == Mode::Points {
            self.append(part.pick(&corners, document, place)?);
            return Ok(());
        }
        let first = self.triangles.len();
        document.source.check_triangles(first as u64 + corners.len() as u64 / faces_share(mode))?;
        triangulate(mode, &corners, part.positions.len(), &mut self.triangles)
            .map_err(|what| document.source.at(format!("{place}.indices"), what))?;
        let shift = u32::try_from(before).map_err(|_| Error::Internal("point limit above 32 bits".into()))?;
        for triangle in &mut self.triangles[first..] {
            *triangle = triangle.map(|v| v + shift);
            if part.mirrored {
                triangle.swap(1, 2);
            }
        }
        self.append(part);
        Ok(())
    }

    /// The vertices of a primitive; `None` where it has no positions, which draws nothing
    /// (glTF 2.0, 3.7.2.1).
    fn part(&mut self, primitive: &Primitive, placed: &Placed, place: &str) -> Result<Option<Part>> {
        let document = self.document;
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(accessor) = attribute(Semantic::Positions) else { return Ok(None) };
        let name = format!("{place}.attributes.POSITION");
        let count = document.accessor_count(accessor, &name)?;
        document.source.check_points((self.positions.len() as u64).saturating_add(count))?;
        let mut part = Part::of(document.numbers(accessor, &[Type::Vec3], &name)?, placed);
        if let Some(accessor) = attribute(Semantic::Normals) {
            let normals = document.numbers(accessor, &[Type::Vec3], &format!("{place}.attributes.NORMAL"))?;
            part.normals = turned(&normals, DMat3::from_mat4(placed.world));
        }
        part.colors = self.light.colors(primitive, place)?;
        for length in [part.normals.len(), part.colors.len()] {
            if length != 0 && length != part.positions.len() {
                let what = format!(
                    "an attribute has {length} elements, and POSITION {}; export the file again",
                    part.positions.len()
                );
                return Err(document.source.at(place, what));
            }
        }
        Ok(Some(part))
    }

    /// Joins a part on; what one side lacks is filled with zero normals and white.
    fn append(&mut self, part: Part) {
        let (before, after) = (self.positions.len(), self.positions.len() + part.positions.len());
        join(&mut self.normals, part.normals, (before, after), Vec3::ZERO);
        join(&mut self.colors, part.colors, (before, after), WHITE);
        self.positions.extend(part.positions);
    }
}

fn join<T: Clone>(all: &mut Vec<T>, part: Vec<T>, (before, after): (usize, usize), missing: T) {
    if !all.is_empty() || !part.is_empty() {
        all.resize(before, missing.clone());
        all.extend(part);
        all.resize(after, missing);
    }
}

/// One primitive in the scene's coordinates.
struct Part {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    colors: Vec<[u8; 3]>,
    /// Whether the transform turns the orientation of triangles over.
    mirrored: bool,
}

impl Part {
    fn of(local: Vec<[f64; 3]>, placed: &Placed) -> Self {
        let world = placed.world;
        let positions = local.into_iter().map(|p| world.transform_point3(DVec3::from_array(p))).collect();
        let mirrored = DMat3::from_mat4(world).determinant() < 0.0;
        Self { positions, normals: Vec::new(), colors: Vec::new(), mirrored }
    }

    /// The points that the indices name, in their order.
    fn pick(self, corners: &[f64], document: &Document, place: &str) -> Result<Self> {
        let count = self.positions.len() as u32;
        let mut places = Vec::with_capacity(corners.len());
        for &corner in corners {
            match faces::vertex(corner, count) {
                faces::NO_VERTEX => {
                    let what = faces::out_of_range(corner, count);
                    return Err(document.source.at(format!("{place}.indices"), what));
                }
                index => places.push(index as usize),
            }
        }
        fn picked<T: Copy>(values: &[T], places: &[usize]) -> Vec<T> {
            places.iter().filter_map(|&n| values.get(n).copied()).collect()
        }
        Ok(Self {
            positions: picked(&self.positions, &places),
            normals: picked(&self.normals, &places),
            colors: picked(&self.colors, &places),
            mirrored: self.mirrored,
        })
    }
}

/// Normals under the inverse transpose of the linear part.
///
/// That is the matrix of cofactors over the determinant; only the determinant's sign matters
/// for a direction, so a transform that flattens the mesh needs no special case.
fn turned(normals: &[[f64; 3]], linear: DMat3) -> Vec<Vec3> {
    let (x, y, z) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
    let turn = |&normal: &[f64; 3]| (cofactors * DVec3::from_array(normal)).normalize_or_zero().as_vec3();
    normals.iter().map(turn).collect()
}

/// Vertex numbers as drawn: the indices, or all in order.
fn corners(document: &Document, primitive: &Primitive, vertices: usize, place: &str) -> Result<Vec<f64>> {
    let Some(accessor) = primitive.indices else { return Ok((0..vertices).map(|n| n as f64).collect()) };
    let name = format!("{place}.indices");
    document.source.check_triangles(document.accessor_count(accessor, &name)? / 3)?;
    let indices = document.numbers(accessor, &[Type::Scalar], &name)?;
    Ok(indices.into_iter().map(|[index]| index).collect())
}

/// Corners that bring one more triangle.
fn faces_share(mode: Mode) -> u64 {
    if mode == Mode::Triangles { 3 } else { 1 }
}

fn triangulate(
    mode: Mode,
    corners: &[f64],
    vertices: usize,
    out: &mut Vec<[u32; 3]>,
) -> std::result::Result<(), String> {
    let vertices = vertices as u32;
    match mode {
        Mode::TriangleStrip => faces::triangulate(Shape::Strip, corners, vertices, out),
        Mode::TriangleFan => faces::triangulate(Shape::Fan, corners, vertices, out),
        _ if !corners.len().is_multiple_of(3) => {
            Err(format!("{} indices are no whole triangles; export the file again", corners.len()))
        }
        _ => corners
            .chunks_exact(3)
            .try_for_each(|triangle| faces::triangulate(Shape::Fan, triangle, vertices, out)),
    }
}
