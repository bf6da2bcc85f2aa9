//! The corners of faces and polylines: `v`, `v/vt`, `v//vn`, `v/vt/vn`.

use super::super::text;

/// What the three numbers of a corner index, in this order.
const NAMES: [&str; 3] = ["vertex", "texture", "normal"];

/// Indices stay below this, so that marks are left above them.
const INDEX_LIMIT: u64 = u32::MAX as u64 - 2;

/// How many vertices, texture coordinates and normals there are.
pub(super) type Counts = [u64; 3];

/// Vertex and normal of a corner, from 0 on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub vertex: u32,
    pub normal: Option<u32>,
}

/// Resolves indices and remembers how far they reach.
///
/// A positive index may name a record that comes later, so its range is known only when the
/// file was read once.
pub(super) struct Indices {
    /// What is in the whole file, where that is known.
    total: Option<Counts>,
    /// One more than the greatest index of each kind.
    reach: Counts,
}

impl Indices {
    pub fn new(total: Option<Counts>) -> Self {
        Self { total, reach: [0; 3] }
    }

    /// Whether all indices so far name one of so many records.
    pub fn within(&self, counts: Counts) -> bool {
        self.reach.iter().zip(counts).all(|(&reach, count)| reach <= count)
    }

    /// A corner, with `so_far` records before it.
    ///
    /// # Errors
    /// What is wrong, without the place.
    pub fn corner(&mut self, word: &[u8], so_far: Counts) -> Result<Corner, String> {
        let mut found = [None; 3];
        for (kind, field) in word.split(|&byte| byte == b'/').enumerate() {
            if kind >= found.len() {
                return Err(format!("{} has more than 3 indices", text::quote(word)));
            }
            if !field.is_empty() {
                found[kind] = Some(self.index(kind, field, so_far[kind])?);
            }
        }
        match found {
            [Some(vertex), _, normal] => Ok(Corner { vertex, normal }),
            _ => Err(format!("{} has no vertex index", text::quote(word))),
        }
    }

    /// An index from 0 on, out of one from 1 on or, where negative, from the end so far.
    fn index(&mut self, kind: usize, field: &[u8], so_far: u64) -> Result<u32, String> {
        let stored = text::integer(field).ok_or_else(|| format!("{} is no index", text::quote(field)))?;
        let count = self.total.map_or(so_far, |total| total[kind]);
        let limit = self.total.map_or(INDEX_LIMIT, |total| total[kind].min(INDEX_LIMIT));
        let index = match stored {
            1.. => Some(stored.unsigned_abs() - 1),
            0 => None,
            _ => so_far.checked_sub(stored.unsigned_abs()),
        };
        let known = index.filter(|&index| index < limit).and_then(|index| u32::try_from(index).ok());
        let Some(index) = known else {
            return Err(format!("{} index {stored} names none of the {count} records", NAMES[kind]));
        };
        self.reach[kind] = self.reach[kind].max(u64::from(index) + 1);
        Ok(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_in_every_spelling() {
        let mut indices = Indices::new(Some([8, 4, 2]));
        let mut corner = |word: &str| indices.corner(word.as_bytes(), [8, 4, 2]);
        let with_normal = Ok(Corner { vertex: 7, normal: Some(1) });
        assert_eq!(corner("8"), Ok(Corner { vertex: 7, normal: None }));
        assert_eq!(corner("8/4"), Ok(Corner { vertex: 7, normal: None }));
        assert_eq!(corner("8//2"), with_normal);
        assert_eq!(corner("-1/-4/-1"), with_normal);
        for word in ["9", "0", "-9", "1/5", "1//3", "/1", "1/1/1/1", "x", "99999999999999999999"] {
            assert!(corner(word).is_err(), "{word}");
        }
    }

    #[test]
    fn reach_tells_of_records_that_never_come() {
        let mut indices = Indices::new(None);
        assert!(indices.corner(b"5/2/3", [0; 3]).is_ok());
        assert!(indices.within([5, 2, 3]) && !indices.within([5, 2, 2]) && !indices.within([4, 2, 3]));
    }
}
