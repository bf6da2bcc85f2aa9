//! Cuts a mesh open along its feature edges, so that each side has points of its own.

use glam::{DVec3, Vec3};

use super::edges::{Edges, face_normals};
use super::sets::Sets;
use super::surface::{Cells, NONE, Rows, Surface, inverse};
use super::weld::Welded;

/// The surface of a mesh, cut along marked edges, borders and edges where the faces do not
/// make a surface (more than two, or two that disagree on their outside).
#[must_use]
pub fn split(welded: &Welded, marked: &[bool]) -> Surface {
    let edges = Edges::of(&welded.triangles);
    let joined = |(edge, &mark): (&super::edges::Edge, &bool)| if mark { None } else { edges.pair(edge) };
    let mut corners = Sets::new(3 * welded.triangles.len());
    for (a, b) in edges.edges.iter().zip(marked).filter_map(joined) {
        // Side a runs from its corner to the next; side b runs the other way.
        let corner =
            |half: super::edges::Half, step: u32| 3 * half.face + (u32::from(half.corner) + step) % 3;
        corners.merge(corner(a, 0), corner(b, 1));
        corners.merge(corner(a, 1), corner(b, 0));
    }
    let (point_of, vertex_of) = number_points(welded, &mut corners);
    let mut border_next = vec![NONE; vertex_of.len()];
    for half in edges.cut(marked).flat_map(|edge| edges.halves(edge)) {
        let corner = |step: u32| 3 * half.face + (u32::from(half.corner) + step) % 3;
        border_next[point_of[corner(0) as usize] as usize] = point_of[corner(1) as usize];
    }
    assemble(welded, &point_of, &vertex_of, border_next)
}

/// Gives each set of corners a point; points of one vertex follow each other.
fn number_points(welded: &Welded, corners: &mut Sets) -> (Vec<u32>, Vec<u32>) {
    let all = welded.triangles.as_flattened();
    let mut roots: Vec<(u32, u32)> =
        (0..all.len() as u32).filter(|&c| corners.root(c) == c).map(|c| (all[c as usize], c)).collect();
    roots.sort_unstable();
    let mut point_of = vec![NONE; all.len()];
    for (point, &(_, root)) in roots.iter().enumerate() {
        point_of[root as usize] = point as u32;
    }
    for c in 0..all.len() as u32 {
        point_of[c as usize] = point_of[corners.root(c) as usize];
    }
    (point_of, roots.into_iter().map(|(vertex, _)| vertex).collect())
}

fn assemble(welded: &Welded, point_of: &[u32], vertex_of: &[u32], border_next: Vec<u32>) -> Surface {
    let pieces: Vec<[u32; 3]> = point_of.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let neighbours =
        pieces.iter().flat_map(|&[a, b, c]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)]).collect();
    let pieces_of = pieces
        .iter()
        .enumerate()
        .flat_map(|(piece, corners)| corners.map(|point| (point, piece as u32)))
        .collect();
    Surface {
        points: vertex_of.iter().map(|&v| welded.positions[v as usize]).collect(),
        places: vertex_of.to_vec(),
        normals: point_normals(welded, &pieces, vertex_of.len()),
        colors: match welded.colors.is_empty() {
            true => Vec::new(),
            false => vertex_of.iter().map(|&v| welded.colors[v as usize]).collect(),
        },
        neighbours: Rows::from_pairs(vertex_of.len(), neighbours),
        pieces_of: Rows::from_pairs(vertex_of.len(), pieces_of),
        spots: Vec::new(),
        cells: Cells::default(),
        pieces,
        margin: vec![0.0; vertex_of.len()],
        border_prev: inverse(&border_next),
        border_next,
        carried: Vec::new(),
    }
}

/// Normals of the points, the faces weighted by their angles (Thürmer and Wüthrich 1998),
/// which does not depend on how a flat part is cut into triangles.
fn point_normals(welded: &Welded, pieces: &[[u32; 3]], points: usize) -> Vec<Vec3> {
    let faces = face_normals(&welded.positions, &welded.triangles);
    let mut sums = vec![DVec3::ZERO; points];
    for ((triangle, piece), &normal) in welded.triangles.iter().zip(pieces).zip(&faces) {
        let at = welded.places(*triangle);
        for n in 0..3 {
            let (to, from) = (at[(n + 1) % 3] - at[n], at[(n + 2) % 3] - at[n]);
            let angle = libm::atan2(to.cross(from).length(), to.dot(from));
            sums[piece[n] as usize] += angle * normal;
        }
    }
    sums.iter().map(|sum| sum.normalize_or(DVec3::Z).as_vec3()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::creases::creases;

    /// A cube of two triangles a face, corners at ±0.5.
    fn cube() -> Welded {
        let positions =
            (0..8).map(|n| Vec3::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2) as f32) - 0.5).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        Welded { positions, triangles, ..Welded::default() }
    }

    #[test]
    fn a_cube_falls_into_six_squares() {
        let cube = cube();
        let found = Edges::of(&cube.triangles);
        let marked = creases(&cube, &found, 40.0, f64::INFINITY);
        assert_eq!(marked.iter().filter(|m| **m).count(), 12);
        let surface = split(&cube, &marked);
        assert_eq!(surface.points.len(), 24);
        for point in 0..24 {
            let next = surface.border_next[point];
            assert_ne!(next, NONE);
            assert_eq!(surface.border_prev[next as usize], point as u32);
            assert_eq!(surface.normals[point], surface.normals[next as usize]);
            // The surface lies to the left of its border.
            let along = surface.points[next as usize] - surface.points[point];
            let inward = -surface.points[point] - 0.5 * along;
            assert!(surface.normals[point].cross(along).dot(inward) > 0.0);
        }
    }

    #[test]
    fn an_unmarked_cube_stays_whole() {
        let surface = split(&cube(), &[false; 18]);
        assert_eq!(surface.points.len(), 8);
        assert!(surface.border_next.iter().all(|&next| next == NONE));
    }

    #[test]
    fn a_line_that_ends_inside_splits_only_its_inner_points() {
        // A fan of eight triangles around the origin with one marked spoke.
        let rim = (0..8).map(|n| {
            let (sin, cos) = libm::sincos(f64::from(n) * std::f64::consts::FRAC_PI_4);
            Vec3::new(cos as f32, sin as f32, 0.0)
        });
        let positions = std::iter::once(Vec3::ZERO).chain(rim).collect();
        let triangles = (0..8).map(|n| [0, 1 + n, 1 + (n + 1) % 8]).collect();
        let fan = Welded { positions, triangles, ..Welded::default() };
        let found = Edges::of(&fan.triangles);
        let marked: Vec<bool> = found.edges.iter().map(|edge| edge.ends == [0, 1]).collect();
        let surface = split(&fan, &marked);
        // The centre stays one point, the rim's end of the spoke becomes two.
        assert_eq!(surface.points.len(), 10);
        assert!(surface.on_border(0));
    }
}
