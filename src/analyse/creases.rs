//! Finds the feature edges of a mesh by the angle between its faces.
//!
//! The angle alone also finds the bumps of a noisy scan, so what it finds must go on along
//! the surface the way an edge of a thing does: see [`super::chains`].

use rayon::prelude::*;

use super::chains;
use super::edge_paths::{EdgePaths, STRAIGHT};
use super::edges::{Edges, crease_cosine, face_normals};
use super::weld::Welded;

/// A crease goes on, from where it is sharp enough by itself, along edges at least this
/// share as sharp: hysteresis, after Canny 1986.
const WEAK_SHARE: f64 = 0.4;

/// Cosine of the least angle at which a crease of this angle (degrees) may go on.
#[must_use]
pub fn weak_cosine(degrees: f64) -> f64 {
    libm::cos((WEAK_SHARE * degrees).to_radians())
}

/// Marks the edges whose faces' normals differ by more than an angle in degrees, and those
/// that carry such a crease on, straight and hardly less sharp. Straight runs at least so `long`, model units,
/// are lines by themselves, wherever they lead.
///
/// Edges that do not join two agreeing faces are not marked: they end the surface anyway.
#[must_use]
pub fn creases(welded: &Welded, edges: &Edges, degrees: f64, long: f64) -> Vec<bool> {
    let normals = face_normals(&welded.positions, &welded.triangles);
    let cosines: Vec<Option<f64>> =
        edges.edges.par_iter().map(|edge| crease_cosine(edges, edge, &normals)).collect();
    let sharper = |degrees: f64| {
        let limit = libm::cos(degrees.to_radians());
        cosines.iter().map(move |cosine| cosine.is_some_and(|cosine| cosine < limit))
    };
    let mut marked: Vec<bool> = sharper(degrees).collect();
    let weak: Vec<bool> = sharper(WEAK_SHARE * degrees).collect();
    carry_on(welded, edges, &weak, &mut marked);
    chains::drop_ragged(&welded.positions, edges, long, &mut marked);
    marked
}

/// Marks weak edges that carry a marked one straight on beyond its end, or leave a corner of two.
fn carry_on(welded: &Welded, edges: &Edges, weak: &[bool], marked: &mut [bool]) {
    let paths = EdgePaths::new(welded, edges, |index| weak[index] || marked[index]);
    let ends = edges.edges.iter().zip(0_u32..).filter(|&(_, index)| marked[index as usize]);
    let mut open: Vec<(u32, u32)> =
        ends.flat_map(|(edge, index)| edge.ends.map(|end| (index, end))).collect();
    let vertices = 0..welded.positions.len() as u32;
    let thirds: Vec<(u32, u32)> =
        vertices.filter_map(|vertex| Some((third(&paths, marked, vertex)?, vertex))).collect();
    for (index, vertex) in thirds {
        marked[index as usize] = true;
        open.push((index, paths.beyond(index, vertex)));
    }
    while let Some((edge, vertex)) = open.pop() {
        if paths.around(vertex).iter().filter(|&&index| marked[index as usize]).count() > 1 {
            continue;
        }
        if let Some(index) = paths.onward(edge, vertex) {
            marked[index as usize] = true;
            open.push((index, paths.beyond(index, vertex)));
        }
    }
}

/// The edge that leaves a corner, where two marked ones meet at an angle, as the only third:
/// three faces meet there, and two of them may do so at a lesser angle than they meet the third.
fn third(paths: &EdgePaths, marked: &[bool], vertex: u32) -> Option<u32> {
    let (lines, others): (Vec<u32>, Vec<u32>) =
        paths.around(vertex).iter().partition(|&&index| marked[index as usize]);
    let (&[a, b], &[third]) = (lines.as_slice(), others.as_slice()) else { return None };
    let corner = paths.away(a, vertex).dot(paths.away(b, vertex)) >= -STRAIGHT;
    corner.then_some(third)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    /// Steps from the middle to a side.
    const HALF: i32 = 4;

    /// Places of a row, and of all rows.
    const ROW: i32 = 2 * HALF + 1;

    /// A plane of which the quarter `x > 0 > y` is turned up by `fold` degrees about the line
    /// `x = 0`, and the wall that stands along `y = 0` for it, which begins at the origin.
    fn wedge(fold: f32) -> Welded {
        let slope = fold.to_radians().tan();
        let height = |x: i32, y: i32| if x > 0 && y < 0 { slope * x as f32 } else { 0.0 };
        let steps = || -HALF..=HALF;
        let plane = steps().flat_map(|y| steps().map(move |x| Vec3::new(x as f32, y as f32, height(x, y))));
        let top = (1..=HALF).map(|x| Vec3::new(x as f32, 0.0, slope * x as f32));
        let low = |x: i32, y: i32| ((y + HALF) * ROW + x + HALF) as u32;
        let high = |x: i32| if x > 0 { (ROW * ROW + x - 1) as u32 } else { low(x, 0) };
        let cell = |x: i32, y: i32| {
            let raised = x >= 0 && y == -1;
            let upper = |x: i32| if raised { high(x) } else { low(x, y + 1) };
            let (a, b, c, d) = (low(x, y), low(x + 1, y), upper(x), upper(x + 1));
            [[a, b, c], [b, d, c]]
        };
        let cells = (-HALF..HALF).flat_map(|y| (-HALF..HALF).flat_map(move |x| cell(x, y)));
        let wall = (0..HALF)
            .flat_map(|x| [[low(x, 0), high(x), high(x + 1)], [low(x, 0), high(x + 1), low(x + 1, 0)]]);
        let triangles = cells.chain(wall.skip(1)).collect();
        Welded { positions: plane.chain(top).collect(), triangles, ..Welded::default() }
    }

    /// Marked edges along the fold, of four.
    fn along_the_fold(fold: f32) -> usize {
        let welded = wedge(fold);
        let edges = Edges::of(&welded.triangles);
        let marked = creases(&welded, &edges, 40.0, f64::INFINITY);
        let on_fold = |place: DVec3| place.x == 0.0 && place.y <= 0.0;
        let folds = edges.edges.iter().map(|edge| welded.places(edge.ends).into_iter().all(on_fold));
        folds.zip(marked).filter(|(fold, mark)| *fold && *mark).count()
    }

    #[test]
    fn a_weak_crease_that_leaves_a_corner_is_followed() {
        assert_eq!(along_the_fold(20.0), 4);
        assert_eq!(along_the_fold(10.0), 0, "too weak to go on");
    }
}
