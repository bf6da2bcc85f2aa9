//! Base colour of vertices: material factor, vertex colours and texture multiplied as light.

use std::collections::BTreeMap;

use gltf_json::Index;
use gltf_json::accessor::Type;
use gltf_json::material::Material;
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::texture::Info;
use gltf_json::validation::Checked;
use rayon::prelude::*;

use super::super::color;
use super::document::Document;
use super::texture::Texture;
use crate::error::{Error, Result};

/// Works out base colours.
pub(super) struct Light<'a> {
    document: &'a Document<'a>,
    /// Textures in use, by number, as many as the limit on pixels allows.
    textures: BTreeMap<usize, Texture>,
}

impl<'a> Light<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, textures: BTreeMap::new() }
    }

    /// A colour for each vertex; empty where the primitive and its material say nothing of it.
    pub fn colors(&mut self, primitive: &Primitive, place: &str) -> Result<Vec<[u8; 3]>> {
        let document = self.document;
        let material: Option<&Material> = match primitive.material {
            Some(index) => Some(document.get(index, &format!("{place}.material"))?),
            None => None,
        };
        let pbr = material.map(|material| &material.pbr_metallic_roughness);
        let factor = pbr.map_or([1.0; 3], |pbr| {
            let [r, g, b, _] = pbr.base_color_factor.0;
            [r, g, b].map(f64::from)
        });
        let vertex_light = self.vertex_light(primitive, place)?;
        let texture_light = match pbr.and_then(|pbr| pbr.base_color_texture.as_ref()) {
            Some(info) => self.texture_light(info, primitive, place)?,
            None => Vec::new(),
        };
        let count = match (vertex_light.len(), texture_light.len()) {
            (0, 0) if factor.map(f64::to_bits) == [1.0_f64.to_bits(); 3] => return Ok(Vec::new()),
            (0, 0) => self.vertices(primitive, place)?,
            (0, count) | (count, 0) => count,
            (a, b) => a.min(b),
        };
        let part = |light: &[[f64; 3]], n: usize| light.get(n).copied().unwrap_or([1.0; 3]);
        let color = |n: usize| {
            let (vertex, texel) = (part(&vertex_light, n), part(&texture_light, n));
            std::array::from_fn(|c| color::from_linear(factor[c] * vertex[c] * texel[c]))
        };
        Ok((0..count).into_par_iter().map(color).collect())
    }

    fn vertices(&self, primitive: &Primitive, place: &str) -> Result<usize> {
        let accessor = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let count = match accessor {
            Some(&accessor) => self.document.accessor_count(accessor, place)?,
            None => 0,
        };
        // Read before, so it fits.
        Ok(usize::try_from(count).unwrap_or(0))
    }

    fn vertex_light(&self, primitive: &Primitive, place: &str) -> Result<Vec<[f64; 3]>> {
        match primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) {
            Some(&accessor) => {
                let name = format!("{place}.attributes.COLOR_0");
                self.document.numbers(accessor, &[Type::Vec3, Type::Vec4], &name)
            }
            None => Ok(Vec::new()),
        }
    }

    /// The texture at each vertex; empty where the vertices have no coordinates for it.
    fn texture_light(&mut self, info: &Info, primitive: &Primitive, place: &str) -> Result<Vec<[f64; 3]>> {
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        let set = transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord);
        let Some(&accessor) = primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(set))) else {
            return Ok(Vec::new());
        };
        let name = format!("{place}.attributes.TEXCOORD_{set}");
        let coordinates: Vec<[f64; 2]> = self.document.numbers(accessor, &[Type::Vec2], &name)?;
        let texture = self.texture(info.index)?;
        let (offset, turn, scale) = transform.map_or(([0.0; 2], 0.0, [1.0; 2]), |t| {
            (t.offset.0.map(f64::from), f64::from(t.rotation.0), t.scale.0.map(f64::from))
        });
        let (sin, cos) = libm::sincos(turn);
        // KHR_texture_transform: counter-clockwise as seen, with v down, after scaling.
        let at = |&[u, v]: &[f64; 2]| {
            let [u, v] = [u * scale[0], v * scale[1]];
            texture.sample([cos * u + sin * v + offset[0], cos * v - sin * u + offset[1]])
        };
        Ok(coordinates.par_iter().map(at).collect())
    }

    /// The texture, loaded when it is not yet; all others go when the sum of pixels is too large.
    fn texture(&mut self, index: Index<gltf_json::Texture>) -> Result<&Texture> {
        let number = index.value();
        if !self.textures.contains_key(&number) {
            let texture = Texture::load(self.document, index)?;
            let held: u64 = self.textures.values().map(Texture::pixels).sum();
            if held + texture.pixels() > self.document.source.limits.texture_pixels {
                self.textures.clear();
            }
            self.textures.insert(number, texture);
        }
        self.textures.get(&number).ok_or_else(|| Error::Internal("a texture was not kept".into()))
    }
}
