//! Feature lines that run beside each other so closely that a cloud shows no surface between them, made one.

use glam::{DVec3, Vec3};

use super::line_network::{CROWD, Network};
use super::segment_grid::SegmentGrid;
use super::surface::NONE;

/// Two lines run beside each other where they keep within this cosine (25°) of the same way.
pub(super) const PARALLEL: f64 = 0.906;

/// But not where they have parted just before by more than this (cosine of 10°): they bound a face that begins there.
const FORK: f64 = 0.985;

/// They are close no farther from there than this many times as far as lines may be that are made one: so far are straight
/// lines that part by 10°.
const ARM: f64 = 6.0;

/// An arm has no more segments: small loops have no end.
const LONGEST: usize = 32;

/// Of the lines of a network, those within `reach` (model units, at a place) of a longer one give way to it, and it
/// moves halfway to them. The segments that are left, as pieces, and the length of those that gave way.
#[must_use]
pub fn merged(network: &Network, reach: &impl Fn(DVec3) -> f64) -> (Vec<[Vec3; 2]>, f64) {
    let doubled = Doubled::of(network, reach);
    let left = (0..network.segments.len() as u32).filter(|&segment| doubled.of[segment as usize] == NONE);
    let places = doubled.places(network, reach);
    let moved = doubled.moved(network);
    let pieces = left.map(|segment| {
        network.segments[segment as usize]
            .map(|node| places[moved[node as usize] as usize].as_vec3() + Vec3::ZERO)
    });
    let gone = (0..network.segments.len() as u32).filter(|&segment| doubled.of[segment as usize] != NONE);
    (pieces.filter(|[a, b]| a != b).collect(), gone.map(|segment| network.length(segment)).sum())
}

/// Which segments give way.
struct Doubled {
    grid: SegmentGrid,
    /// For each segment, the one that it gives way to; or [`NONE`].
    of: Vec<u32>,
}

impl Doubled {
    fn of(network: &Network, reach: &impl Fn(DVec3) -> f64) -> Self {
        let count = network.segments.len();
        let grid = network.grid();
        let strands = network.strands();
        let forks = forks(network, reach);
        let mut rank = vec![NONE; count];
        let mut of = vec![NONE; count];
        for (strand, number) in strands.iter().zip(0..) {
            for &segment in &strand.segments {
                let [a, b] = network.ends(segment);
                let (middle, along) = (0.5 * (a + b), network.along(segment));
                let stays = |other: u32| {
                    rank[other as usize] < number
                        && of[other as usize] == NONE
                        && network.along(other).dot(along).abs() > PARALLEL
                        && forks.binary_search(&[segment.min(other), segment.max(other)]).is_err()
                };
                if let Some(near) = grid.nearest_of(middle, reach(middle), stays) {
                    of[segment as usize] = near.segment;
                }
            }
            strand.segments.iter().for_each(|&segment| rank[segment as usize] = number);
        }
        Self { grid, of }
    }

    /// Where the nodes of the segments that stay lie: halfway to those that give way to them.
    fn places(&self, network: &Network, reach: &impl Fn(DVec3) -> f64) -> Vec<DVec3> {
        let mut places: Vec<DVec3> = network.nodes.iter().map(|node| node.as_dvec3()).collect();
        for segment in self.of.iter().filter(|&&segment| segment != NONE) {
            for node in network.segments[*segment as usize] {
                let place = network.nodes[node as usize].as_dvec3();
                let gives_way = |other: u32| self.of[other as usize] != NONE;
                if let Some(near) = self.grid.nearest_of(place, reach(place), gives_way) {
                    places[node as usize] = 0.5 * (place + near.point);
                }
            }
        }
        places
    }

    /// For each node the one that stands for it: of a segment that gives way, the nearest of what it gives way to.
    fn moved(&self, network: &Network) -> Vec<u32> {
        let place = |node: u32| network.nodes[node as usize].as_dvec3();
        let stands = |node: u32| {
            let around = network.at_node.row(node).iter();
            let given = around.map(|&segment| self.of[segment as usize]).filter(|&segment| segment != NONE);
            let nodes = given.flat_map(|segment| network.segments[segment as usize]);
            let away = |other: &u32| place(*other).distance_squared(place(node));
            nodes.min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b))).unwrap_or(node)
        };
        (0..network.nodes.len() as u32).map(stands).collect()
    }
}

/// Pairs of segments, the lesser first, ascending, on lines that part nearby, as far from there as they are close.
fn forks(network: &Network, reach: &impl Fn(DVec3) -> f64) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for node in 0..network.nodes.len() as u32 {
        let around = network.at_node.row(node);
        if around.len() > CROWD {
            continue;
        }
        for (n, &a) in around.iter().enumerate() {
            for &b in &around[..n] {
                let cosine = network.along_from(a, node).dot(network.along_from(b, node));
                if (PARALLEL..FORK).contains(&cosine) {
                    let [a, b] = [a, b].map(|segment| arm(network, segment, node, reach));
                    pairs.extend(a.iter().flat_map(|&a| b.iter().map(move |&b| [a.min(b), a.max(b)])));
                }
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// The segments from a node on, by one of its own, as far as another arm of a fork there is close.
fn arm(network: &Network, segment: u32, node: u32, reach: &impl Fn(DVec3) -> f64) -> Vec<u32> {
    let place = |node: u32| network.nodes[node as usize].as_dvec3();
    let close = ARM * reach(place(node));
    let way = network.through(segment, network.across(segment, node)).take(LONGEST);
    let near = way.take_while(|&(_, to)| place(to).distance(place(node)) <= close);
    near.map(|(segment, _)| segment).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A network of straight lines in segments of 0.02.
    fn network(lines: &[[DVec3; 2]]) -> Network {
        let pieces = lines.iter().flat_map(|[a, b]| {
            let count = (a.distance(*b) / 0.02).round() as usize;
            let at = move |n: usize| a.lerp(*b, n as f64 / count as f64).as_vec3();
            (0..count).map(move |n| [at(n), at(n + 1)])
        });
        Network::of_pieces(&pieces.collect::<Vec<_>>())
    }

    fn merged(lines: &[[DVec3; 2]]) -> (Network, f64) {
        let (pieces, length) = super::merged(&network(lines), &|_| 0.02);
        (Network::of_pieces(&pieces), length)
    }

    #[test]
    fn of_two_lines_side_by_side_one_is_left_midway() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        // A crest from end to end, which branches at one end and has a wall on one of its sides.
        let long = [at(0.0, 0.0), at(0.8, 0.0)];
        let short = [at(0.0, 0.01), at(0.6, 0.01)];
        let wall = [at(0.3, 0.01), at(0.3, 0.3)];
        let branch = [at(0.6, 0.01), at(0.8, 0.2)];
        let (left, length) = merged(&[long, short, wall, branch]);
        assert!((length - 0.6).abs() < 0.05, "{length}");
        for node in &left.nodes {
            let is_beside = node.y.abs() < 0.015 && (0.03..0.57).contains(&node.x);
            assert!(!is_beside || (node.y - 0.005).abs() < 1e-6, "{node} is not midway");
        }
        // The wall and the branch hang on what is left: all is one.
        let loose = (0..left.nodes.len() as u32).filter(|&node| left.at_node.row(node).len() == 1);
        assert_eq!(loose.count(), 4, "two ends of the crest, one of the wall, one of the branch");
    }

    #[test]
    fn lines_that_part_at_an_acute_angle_are_two_from_the_start() {
        for (degrees, stay) in [(17.0_f64, true), (5.0, false)] {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let fork = [DVec3::X, DVec3::new(cos, sin, 0.0)].map(|way| [DVec3::ZERO, 0.4 * way]);
            let (left, length) = merged(&fork);
            assert_eq!(left.segments.len() == network(&fork).segments.len(), stay, "{degrees}: {length}");
        }
    }

    #[test]
    fn an_arm_round_a_loop_ends() {
        // Sixteen sides of 0.02, all within reach of a corner, from which a line leads into the loop beside the first.
        let corner = |n: u32| {
            let (sin, cos) = libm::sincos(f64::from(n % 16) * std::f64::consts::TAU / 16.0);
            0.05 * DVec3::new(cos, sin, 0.0)
        };
        let (sin, cos) = libm::sincos(118.0_f64.to_radians());
        let beside = [corner(0), corner(0) + 0.2 * DVec3::new(cos, sin, 0.0)];
        let lines: Vec<_> = (0..16).map(|n| [corner(n), corner(n + 1)]).chain([beside]).collect();
        let network = network(&lines);
        let at =
            |place: DVec3| (0..).zip(&network.nodes).find(|(_, node)| node.as_dvec3().distance(place) < 1e-6);
        let [from, to] = [corner(0), corner(1)].map(|place| at(place).unwrap().0);
        let first = network.find([from, to].map(|node: u32| network.nodes[node as usize])).unwrap();
        assert_eq!(arm(&network, first, from, &|_| 0.02).len(), LONGEST);
        assert!(!forks(&network, &|_| 0.02).is_empty());
    }

    #[test]
    fn lines_apart_and_lines_that_meet_stay() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let apart = [[at(0.0, 0.0), at(0.4, 0.0)], [at(0.0, 0.03), at(0.4, 0.03)]];
        let corner =
            [[at(0.0, 0.0), at(0.4, 0.0)], [at(0.0, 0.0), at(0.0, 0.4)], [at(0.0, 0.0), at(0.3, 0.3)]];
        for lines in [&apart[..], &corner[..]] {
            let (left, length) = merged(lines);
            assert_eq!((left.segments, length), (network(lines).segments, 0.0));
        }
    }
}
