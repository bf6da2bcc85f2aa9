//! Chains of marked mesh edges, and which of them are the noise of a scan.

use glam::{DVec3, Vec3};

use super::edges::Edges;
use super::sets::Sets;

/// A chain is ragged if at every other vertex its bend changes by more than this (sine of
/// 20°): the edges of things bend steadily, even where a mesh makes a circle a hexagon, and
/// noise zigzags.
const RAGGED: f64 = 0.34;

/// A chain that bends so often, by far the most of it (share) to one side, goes round: random bends add up to less than
/// half of this.
const ROUND: usize = 6;
const ONE_WAY: f64 = 0.8;

/// A chain of fewer edges than this that ends inside the surface, or closes on itself
/// without meeting another, says nothing. One that runs from border to border, as the ridge of two
/// triangles does, parts the surface however few its edges are.
const SHORTEST: usize = 4;

/// A line that turns by less than this (sine) goes straight on: so far the rounding of 32 bits may turn it.
const LEAST_TURN: f64 = 2e-3;

/// Rounds of dropping chains; each may join others or leave them with a loose end.
const ROUNDS: usize = 8;

/// A path of marked edges between vertices where not exactly two of them meet.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Its edges, in order.
    pub edges: Vec<u32>,
    vertices: Vec<u32>,
    /// Whether it ends inside the surface: an end meets neither another marked edge nor a border.
    loose: bool,
}

impl Chain {
    /// The way along each of its edges.
    fn sides(&self, positions: &[Vec3]) -> Vec<DVec3> {
        let at = |vertex: u32| positions[vertex as usize].as_dvec3();
        self.vertices.windows(2).map(|pair| at(pair[1]) - at(pair[0])).collect()
    }

    /// Its straight runs: how many edges each has and how long it is. One edge of a mesh that was refined
    /// since is one run at least.
    fn runs(&self, positions: &[Vec3]) -> Vec<(usize, f64)> {
        let is_straight = |a: &DVec3, b: &DVec3| {
            a.normalize_or_zero().cross(b.normalize_or_zero()).length() < LEAST_TURN && a.dot(*b) > 0.0
        };
        let run = |sides: &[DVec3]| (sides.len(), sides.iter().map(|side| side.length()).sum());
        self.sides(positions).chunk_by(is_straight).map(run).collect()
    }

    /// Whether most of it lies in straight runs at least so `long`.
    pub fn is_coarse(&self, positions: &[Vec3], long: f64) -> bool {
        let runs = self.runs(positions);
        let length = |least: f64| runs.iter().map(|run| run.1).filter(|run| *run >= least).sum::<f64>();
        2.0 * length(long) >= length(0.0)
    }

    /// Its edges in straight runs that are not so `long`.
    fn short(&self, positions: &[Vec3], long: f64) -> Vec<u32> {
        let runs = self.runs(positions).into_iter();
        let is_short = runs.flat_map(|(count, length)| std::iter::repeat_n(length < long, count));
        self.edges.iter().zip(is_short).filter(|(_, short)| *short).map(|(edge, _)| *edge).collect()
    }
}

/// Unmarks chains that zigzag, and short ones that lead nowhere.
///
/// Straight runs at least so `long` are lines by themselves and stay, and where they make up most of a
/// chain, all of it stays: the short edges round a corner between them.
pub fn drop_ragged(positions: &[Vec3], edges: &Edges, long: f64, marked: &mut [bool]) {
    for _ in 0..ROUNDS {
        let is_bad = |chain: &Chain| {
            let closed = chain.vertices.first() == chain.vertices.last();
            let lost = chain.edges.len() < SHORTEST && (chain.loose || closed);
            (lost || is_ragged(positions, chain)) && !chain.is_coarse(positions, long)
        };
        let bad = chains(positions.len(), edges, marked).into_iter().filter(is_bad);
        let dropped: Vec<u32> = bad.flat_map(|chain| chain.short(positions, long)).collect();
        if dropped.is_empty() {
            break;
        }
        dropped.into_iter().for_each(|edge| marked[edge as usize] = false);
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

/// Whether the bend changes much at more than half of the vertices, and not only between more and less of one that
/// goes on, as round a circle of long and short edges in turn.
fn is_ragged(positions: &[Vec3], chain: &Chain) -> bool {
    let sides: Vec<DVec3> = chain.sides(positions).into_iter().map(DVec3::normalize_or_zero).collect();
    let bends: Vec<DVec3> = sides.windows(2).map(|pair| pair[0].cross(pair[1])).collect();
    let ragged = bends.windows(2).filter(|pair| pair[0].distance(pair[1]) > RAGGED).count();
    2 * ragged > bends.len().saturating_sub(1) && !goes_round(&bends)
}

/// Whether bends are enough, and nearly all to one side.
fn goes_round(bends: &[DVec3]) -> bool {
    let (sum, all) =
        bends.iter().fold((DVec3::ZERO, 0.0), |(sum, all), bend| (sum + *bend, all + bend.length()));
    bends.len() >= ROUND && sum.length() > ONE_WAY * all
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
    let ends = Ends { degree, at_border: at_border(vertices, edges) };
    let mut used = vec![false; edges.edges.len()];
    let mut found = Vec::new();
    // First from the ends and joints, then whatever closes on itself.
    for joints in [true, false] {
        for &(vertex, edge) in &around {
            if ends.joins_two(vertex) != joints && !used[edge as usize] {
                found.push(walk(edges, &around, &ends, &mut used, vertex, edge));
            }
        }
    }
    found
}

/// For each vertex, whether the surface ends there.
fn at_border(vertices: usize, edges: &Edges) -> Vec<bool> {
    let mut at_border = vec![false; vertices];
    for edge in edges.edges.iter().filter(|edge| edges.pair(edge).is_none()) {
        edge.ends.iter().for_each(|&end| at_border[end as usize] = true);
    }
    at_border
}

/// Where chains end, and where they end loosely.
struct Ends {
    /// For each vertex, how many marked edges meet there.
    degree: Vec<u32>,
    at_border: Vec<bool>,
}

impl Ends {
    fn joins_two(&self, vertex: u32) -> bool {
        self.degree[vertex as usize] == 2
    }

    fn are_loose(&self, vertex: u32) -> bool {
        self.degree[vertex as usize] == 1 && !self.at_border[vertex as usize]
    }
}

fn walk(
    edges: &Edges,
    around: &[(u32, u32)],
    ends: &Ends,
    used: &mut [bool],
    start: u32,
    first: u32,
) -> Chain {
    let mut chain = Chain { edges: Vec::new(), vertices: vec![start], loose: ends.are_loose(start) };
    let (mut vertex, mut edge) = (start, first);
    loop {
        used[edge as usize] = true;
        chain.edges.push(edge);
        let [a, b] = edges.edges[edge as usize].ends;
        vertex = if a == vertex { b } else { a };
        chain.vertices.push(vertex);
        if !ends.joins_two(vertex) {
            chain.loose |= ends.are_loose(vertex);
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

    /// Three rows of points, and the triangles between them; the line that is marked runs along the
    /// middle row, through columns that rise by some heights, and `beyond` as many columns lie before
    /// and after it.
    fn sheet(heights: &[f32], beyond: usize) -> (Vec<Vec3>, Edges, Vec<bool>) {
        let (count, across) = (heights.len(), heights.len() + 2 * beyond);
        let height = |n: usize| heights[n.clamp(beyond, beyond + count - 1) - beyond];
        let row = |z: f32| (0..across).map(move |n| Vec3::new(n as f32, height(n), z));
        let positions = [-5.0, 0.0, 5.0].into_iter().flat_map(row).collect();
        let across = across as u32;
        let triangles: Vec<[u32; 3]> = (0..2 * across)
            .filter(|n| n % across + 1 < across)
            .flat_map(|n| [[n, n + 1, across + n], [n + 1, across + n + 1, across + n]])
            .collect();
        let edges = Edges::of(&triangles);
        let line = across + beyond as u32..across + (beyond + count) as u32;
        let marked = edges.edges.iter().map(|edge| edge.ends.iter().all(|end| line.contains(end))).collect();
        (positions, edges, marked)
    }

    fn kept_of(heights: &[f32], beyond: usize) -> usize {
        let (positions, edges, mut marked) = sheet(heights, beyond);
        drop_ragged(&positions, &edges, f64::INFINITY, &mut marked);
        marked.iter().filter(|mark| **mark).count()
    }

    fn kept(heights: &[f32]) -> usize {
        kept_of(heights, 1)
    }

    #[test]
    fn a_line_of_few_edges_stays_where_it_ends_at_borders() {
        assert_eq!(kept_of(&[0.0; 2], 0), 1, "the ridge of a roof");
        assert_eq!(kept_of(&[0.0; 2], 1), 0, "inside the surface");
    }

    #[test]
    fn a_straight_run_is_a_line_by_itself_and_a_chain_of_such_runs_stays_whole() {
        let kept = |heights: &[f32], long: f64| {
            let (positions, edges, mut marked) = sheet(heights, 1);
            drop_ragged(&positions, &edges, long, &mut marked);
            marked.iter().filter(|mark| **mark).count()
        };
        assert_eq!((kept(&[0.0; 4], 3.0), kept(&[0.0; 4], 3.1)), (3, 0), "inside the surface");
        let bent = [0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0, -1.0];
        assert_eq!(kept(&bent, 3.1), 0, "a zigzag in its middle");
        assert_eq!(kept(&bent, 3.0), 6, "but for its two straight runs");
        assert_eq!(kept(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 3.0), 8, "these are most of it");
    }

    #[test]
    fn steady_lines_stay_and_zigzags_go() {
        assert_eq!(kept(&[0.0; 9]), 8, "a straight line");
        let arc: Vec<f32> = (0..9).map(|n| (16.0 - (n as f32 - 4.0).powi(2)).max(0.0).sqrt()).collect();
        assert_eq!(kept(&arc), 8, "half a coarse circle");
        assert_eq!(kept(&[0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 6.0, 9.0, 12.0]), 8, "one corner");
        assert_eq!(kept(&[0.0, 1.0, 0.2, 0.9, -0.3, 0.8, 0.1, 1.0, 0.0]), 0, "a zigzag");
        let split = [0.0, 3.0, 6.0, 7.0, 8.0, 8.2, 8.4, 7.9, 7.4, 5.9, 4.4, -0.6, -5.6];
        assert_eq!(kept(&split), 12, "half a dodecagon, its sides split");
        assert_eq!(kept(&[0.0; 4]), 0, "three edges that lead nowhere");
    }
}
