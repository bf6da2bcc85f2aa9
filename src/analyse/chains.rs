//! Chains of marked mesh edges, and which of them are the noise of a scan.

use glam::{DVec3, Vec3};

use super::edges::Edges;
use super::sets::Sets;

/// A chain is ragged if at every other vertex its bend changes by more than this (sine of
/// 20°): the edges of things bend steadily, even where a mesh makes a circle a hexagon, and
/// noise zigzags.
const RAGGED: f64 = 0.34;

/// A chain of fewer edges than this that ends inside the surface, or closes on itself
/// without meeting another, says nothing.
const SHORTEST: usize = 4;

/// Rounds of dropping chains; each may join others or leave them with a loose end.
const ROUNDS: usize = 8;

/// A path of marked edges between vertices where not exactly two of them meet.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Its edges, in order.
    pub edges: Vec<u32>,
    vertices: Vec<u32>,
    /// Whether an end meets no other marked edge.
    loose: bool,
}

/// Unmarks chains that zigzag, and short ones that lead nowhere.
pub fn drop_ragged(positions: &[Vec3], edges: &Edges, marked: &mut [bool]) {
    for _ in 0..ROUNDS {
        let bad: Vec<Chain> = chains(positions.len(), edges, marked)
            .into_iter()
            .filter(|chain| {
                let closed = chain.vertices.first() == chain.vertices.last();
                let lost = chain.edges.len() < SHORTEST && (chain.loose || closed);
                lost || is_ragged(positions, chain)
            })
            .collect();
        if bad.is_empty() {
            break;
        }
        for edge in bad.iter().flat_map(|chain| &chain.edges) {
            marked[*edge as usize] = false;
        }
    }
}

/// Unmarks connected lines whose edges together are shorter than `least`.
///
/// Lines that small bound nothing that could be told from its surroundings.
pub fn drop_short(positions: &[Vec3], edges: &Edges, least: f64, marked: &mut [bool]) {
    let mut sets = Sets::new(positions.len());
    let marked_edges: Vec<usize> = (0..marked.len()).filter(|&index| marked[index]).collect();
    for &index in &marked_edges {
        let [a, b] = edges.edges[index].ends;
        sets.merge(a, b);
    }
    let mut lengths = vec![0.0; positions.len()];
    for &index in &marked_edges {
        let [a, b] = edges.edges[index].ends;
        let length = positions[a as usize].as_dvec3().distance(positions[b as usize].as_dvec3());
        lengths[sets.root(a) as usize] += length;
    }
    for index in marked_edges {
        marked[index] = lengths[sets.root(edges.edges[index].ends[0]) as usize] >= least;
    }
}

/// Whether the bend changes much at more than half of the vertices.
fn is_ragged(positions: &[Vec3], chain: &Chain) -> bool {
    let at = |vertex: u32| positions[vertex as usize].as_dvec3();
    let sides: Vec<DVec3> =
        chain.vertices.windows(2).map(|pair| (at(pair[1]) - at(pair[0])).normalize_or_zero()).collect();
    let bends: Vec<DVec3> = sides.windows(2).map(|pair| pair[0].cross(pair[1])).collect();
    let ragged = bends.windows(2).filter(|pair| pair[0].distance(pair[1]) > RAGGED).count();
    2 * ragged > bends.len().saturating_sub(1)
}

/// All chains of marked edges, each once, in the order of their first edge.
#[must_use]
pub fn chains(vertices: usize, edges: &Edges, marked: &[bool]) -> Vec<Chain> {
    let mut around: Vec<(u32, u32)> = (edges.edges.iter().zip(marked).enumerate())
        .filter(|(_, (_, mark))| **mark)
        .flat_map(|(index, (edge, _))| edge.ends.map(|end| (end, index as u32)))
        .collect();
    around.sort_unstable();
    let mut degree = vec![0_u32; vertices];
    for &(vertex, _) in &around {
        degree[vertex as usize] += 1;
    }
    let mut used = vec![false; edges.edges.len()];
    let mut found = Vec::new();
    // First from the ends and joints, then whatever closes on itself.
    for joints in [true, false] {
        for &(vertex, edge) in &around {
            if (degree[vertex as usize] == 2) != joints && !used[edge as usize] {
                found.push(walk(edges, &around, &degree, &mut used, vertex, edge));
            }
        }
    }
    found
}

fn walk(
    edges: &Edges,
    around: &[(u32, u32)],
    degree: &[u32],
    used: &mut [bool],
    start: u32,
    first: u32,
) -> Chain {
    let mut chain = Chain { edges: Vec::new(), vertices: vec![start], loose: degree[start as usize] == 1 };
    let (mut vertex, mut edge) = (start, first);
    loop {
        used[edge as usize] = true;
        chain.edges.push(edge);
        let [a, b] = edges.edges[edge as usize].ends;
        vertex = if a == vertex { b } else { a };
        chain.vertices.push(vertex);
        if degree[vertex as usize] != 2 {
            chain.loose |= degree[vertex as usize] == 1;
            return chain;
        }
        let from = around.partition_point(|entry| entry.0 < vertex);
        let Some(&(_, next)) = around[from..from + 2].iter().find(|entry| !used[entry.1 as usize]) else {
            return chain;
        };
        edge = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of triangles over two rows of points; its inner line runs along row 0.
    fn strip(heights: &[f32]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let row = |n: usize| Vec3::new(n as f32, heights[n], 0.0);
        let count = heights.len() as u32;
        let positions = (0..heights.len())
            .map(row)
            .chain((0..heights.len()).map(|n| Vec3::new(n as f32, 0.0, 5.0)))
            .collect();
        let triangles =
            (0..count - 1).flat_map(|n| [[n, n + 1, count + n], [n + 1, count + n + 1, count + n]]).collect();
        (positions, triangles)
    }

    fn kept(heights: &[f32]) -> usize {
        let (positions, triangles) = strip(heights);
        let edges = Edges::of(&triangles);
        let row = heights.len() as u32;
        let mut marked: Vec<bool> =
            edges.edges.iter().map(|edge| edge.ends[0] < row && edge.ends[1] < row).collect();
        drop_ragged(&positions, &edges, &mut marked);
        marked.iter().filter(|mark| **mark).count()
    }

    #[test]
    fn steady_lines_stay_and_zigzags_go() {
        assert_eq!(kept(&[0.0; 9]), 8, "a straight line");
        let arc: Vec<f32> = (0..9).map(|n| (16.0 - (n as f32 - 4.0).powi(2)).max(0.0).sqrt()).collect();
        assert_eq!(kept(&arc), 8, "half a coarse circle");
        assert_eq!(kept(&[0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 6.0, 9.0, 12.0]), 8, "one corner");
        assert_eq!(kept(&[0.0, 1.0, 0.2, 0.9, -0.3, 0.8, 0.1, 1.0, 0.0]), 0, "a zigzag");
        assert_eq!(kept(&[0.0; 4]), 0, "three edges that lead nowhere");
    }
}
