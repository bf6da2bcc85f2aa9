//! Accessors: typed numbers in the buffers.
//!
//! Read with our own bounds, in bulk: the iterators of the crate `gltf` compute offsets
//! unchecked and go number by number.

use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Index, buffer};

use super::super::scalar::{Column, Endian, Rows, Scalar};
use super::document::{Document, span};
use crate::error::Result;

impl Document<'_> {
    /// How many elements an accessor claims.
    pub fn accessor_count(&self, index: Index<Accessor>, place: &str) -> Result<u64> {
        Ok(self.get(index, place)?.count.0)
    }

    /// The first `N` components of each element, normalised where the accessor says so.
    pub fn numbers<const N: usize>(
        &self,
        index: Index<Accessor>,
        types: &[Type],
        place: &str,
    ) -> Result<Vec<[f64; N]>> {
        let accessor = self.get(index, place)?;
        let place = format!("accessors[{}]", index.value());
        let (Checked::Valid(kind), Checked::Valid(GenericComponentType(component))) =
            (accessor.type_, accessor.component_type)
        else {
            return Err(self.source.at(place, "type or componentType is unknown; export the file again"));
        };
        if !types.contains(&kind) {
            let what = format!("has the type {kind:?}, and needs one of {types:?}; export the file again");
            return Err(self.source.at(place, what));
        }
        let scalar = scalar(component);
        let full = if accessor.normalized { full(scalar) } else { None };
        let element = Element { scalar, full, size: scalar.size() * kind.multiplicity() };
        let mut out = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                element.gather(&self.rows(view, offset, accessor.count.0, element.size, &place)?)
            }
            None => vec![[0.0; N]; self.zeros(accessor.count.0, &place)?],
        };
        if let Some(sparse) = &accessor.sparse {
            self.substitute(sparse, &element, &mut out, &place)?;
        }
        Ok(out)
    }

    /// The length of an accessor of zeros, which has no bytes to be held against: it may have
    /// as many elements as the document has bytes.
    fn zeros(&self, count: u64, place: &str) -> Result<usize> {
        let bytes = self.bytes();
        let length = usize::try_from(count).ok().filter(|_| count <= bytes);
        length.ok_or_else(|| {
            let what = format!(
                "claims {count} zeros without a bufferView, in a document of {bytes} bytes; export the file again"
            );
            self.source.at(place, what)
        })
    }

    /// Puts the values of a sparse accessor in place.
    fn substitute<const N: usize>(
        &self,
        sparse: &Sparse,
        element: &Element,
        out: &mut [[f64; N]],
        place: &str,
    ) -> Result<()> {
        let (indices, values, count) = (&sparse.indices, &sparse.values, sparse.count.0);
        let Checked::Valid(IndexComponentType(component)) = indices.component_type else {
            let what = "the componentType of its sparse indices is unknown; export the file again";
            return Err(self.source.at(place, what));
        };
        let scalar = scalar(component);
        let slots = self.rows(indices.buffer_view, indices.byte_offset.0, count, scalar.size(), place)?;
        let slots = slots.gather(&[Column { scalar, offset: 0 }], |[slot]| slot);
        let values = self.rows(values.buffer_view, values.byte_offset.0, count, element.size, place)?;
        let known = out.len();
        for (slot, value) in slots.into_iter().zip(element.gather(&values)) {
            let Some(out) = out.get_mut(slot as usize) else {
                let what = format!("sparse index {slot} is not below {known}; export the file again");
                return Err(self.source.at(place, what));
            };
            *out = value;
        }
        Ok(())
    }

    /// `count` elements in a buffer view, all of which are there.
    fn rows(
        &self,
        view: Index<buffer::View>,
        offset: u64,
        count: u64,
        element: usize,
        place: &str,
    ) -> Result<Rows<'_>> {
        let (bytes, stride) = self.view(view, place)?;
        let stride = stride.unwrap_or(element);
        if stride < element {
            let what = format!("byteStride {stride} is less than an element's {element} bytes; export again");
            return Err(self.source.at(place, what));
        }
        let gaps = count.saturating_sub(1).saturating_mul(stride as u64);
        let need = if count == 0 { 0 } else { gaps.saturating_add(element as u64) };
        let rows = span(bytes, offset, need).zip(usize::try_from(count).ok());
        let Some((rows, count)) = rows else {
            let what = format!(
                "{count} elements need {need} bytes from byte {offset} of bufferViews[{}], which has {}; \
                 export the file again",
                view.value(),
                bytes.len()
            );
            return Err(self.source.at(place, what));
        };
        Ok(Rows { bytes: rows, stride, count, endian: Endian::Little })
    }
}

/// What an element of an accessor is.
struct Element {
    scalar: Scalar,
    /// What stands for 1 in a normalised component.
    full: Option<f64>,
    size: usize,
}

impl Element {
    /// The first `N` components of each row.
    fn gather<const N: usize>(&self, rows: &Rows) -> Vec<[f64; N]> {
        let size = self.scalar.size();
        let columns = std::array::from_fn(|n| Column { scalar: self.scalar, offset: n * size });
        // A normalised signed number may pass -1 by one step (glTF 2.0, 3.11).
        let widen =
            |values: [f64; N]| self.full.map_or(values, |full| values.map(|value| (value / full).max(-1.0)));
        rows.gather(&columns, widen)
    }
}

fn scalar(component: ComponentType) -> Scalar {
    match component {
        ComponentType::I8 => Scalar::I8,
        ComponentType::U8 => Scalar::U8,
        ComponentType::I16 => Scalar::I16,
        ComponentType::U16 => Scalar::U16,
        ComponentType::U32 => Scalar::U32,
        ComponentType::F32 => Scalar::F32,
    }
}

/// What stands for 1 in a normalised integer; floating-point numbers are as they are.
fn full(scalar: Scalar) -> Option<f64> {
    match scalar {
        Scalar::I8 => Some(127.0),
        Scalar::U8 => Some(255.0),
        Scalar::I16 => Some(32_767.0),
        Scalar::U16 => Some(65_535.0),
        Scalar::I32 | Scalar::U32 | Scalar::F32 | Scalar::F64 => None,
    }
}
