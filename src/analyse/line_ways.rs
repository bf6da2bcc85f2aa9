//! Feature lines from corner to corner.

use glam::DVec3;

use super::line_network::Network;
use super::surface::NONE;

/// Where a line turns is looked at over so many segments on either side, and at the one.
const SPAN: usize = 4;

/// A line that turns by more than this over them (cosine of 45°) has a corner there.
const TURN: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A line from one corner to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Way {
    /// Its nodes in order; the first is not repeated at the end.
    pub nodes: Vec<u32>,
    /// Its segments: each leads from the node of its number to the next.
    pub segments: Vec<u32>,
    /// Whether the last leads to the first node and none is a corner.
    pub closed: bool,
}

impl Way {
    /// Its first and last node.
    #[must_use]
    pub fn ends(&self) -> [u32; 2] {
        [self.nodes.first(), self.nodes.last()].map(|node| node.copied().unwrap_or(NONE))
    }

    /// Its segments on either side of the node of a number, so many.
    pub fn around(&self, at: usize, many: usize) -> impl Iterator<Item = u32> + '_ {
        let count = self.segments.len();
        let (from, to) = match self.closed {
            true => (at + count - many.min(count / 2), at + count + many.min(count.div_ceil(2))),
            false => (at.saturating_sub(many), (at + many).min(count)),
        };
        (from..to).map(move |n| self.segments[n % count])
    }
}

/// Whether at a node not two segments meet, or two that turn sharply and with them the line.
fn is_corner(network: &Network, node: u32) -> bool {
    let &[a, b] = network.at_node.row(node) else { return true };
    if network.beyond(a, node) == b {
        return false;
    }
    let place = |node: u32| network.nodes[node as usize].as_dvec3();
    let leads = |segment: u32| {
        let far = network.by_twos(segment, network.across(segment, node)).take(SPAN).last();
        (place(far.map_or(node, |(_, node)| node)) - place(node)).normalize_or_zero()
    };
    leads(a).dot(leads(b)) > -TURN
}

/// The ways between the nodes that are corners, and those round and round without any; each segment is in one.
#[must_use]
pub fn ways(network: &Network, corner: &[bool]) -> Vec<Way> {
    let mut seen = vec![false; network.segments.len()];
    let mut ways = Vec::new();
    let mut follow = |first: u32, node: u32, closed: bool| {
        if seen[first as usize] {
            return;
        }
        let mut way = Way { nodes: vec![node], segments: Vec::new(), closed };
        for (segment, next) in network.by_twos(first, network.across(first, node)) {
            seen[segment as usize] = true;
            way.segments.push(segment);
            if closed && next == node {
                break;
            }
            way.nodes.push(next);
            if corner[next as usize] {
                break;
            }
        }
        ways.push(way);
    };
    let all = 0..network.nodes.len() as u32;
    for node in all.clone().filter(|&node| corner[node as usize]) {
        network.at_node.row(node).iter().for_each(|&segment| follow(segment, node, false));
    }
    for node in all {
        network.at_node.row(node).iter().for_each(|&segment| follow(segment, node, true));
    }
    ways
}

/// The corners of a network.
#[must_use]
pub fn corners(network: &Network) -> Vec<bool> {
    (0..network.nodes.len() as u32).map(|node| is_corner(network, node)).collect()
}

/// The lines of a network, model units; a closed one repeats its first place at the end.
#[must_use]
pub fn lines(network: &Network) -> Vec<Vec<DVec3>> {
    let place = |node: &u32| network.nodes[*node as usize].as_dvec3();
    let line = |way: &Way| {
        let again = way.nodes.first().filter(|_| way.closed);
        way.nodes.iter().chain(again).map(place).collect()
    };
    ways(network, &corners(network)).iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// The ways of lines through places, by the places of their ends and the number of their nodes; whether closed.
    fn told(lines: &[Vec<Vec3>]) -> Vec<(Vec3, Vec3, usize, bool)> {
        let pieces: Vec<[Vec3; 2]> =
            lines.iter().flat_map(|line| line.windows(2).map(|side| [side[0], side[1]])).collect();
        let network = Network::of_pieces(&pieces);
        let ways = ways(&network, &corners(&network));
        let mut segments: Vec<u32> = ways.iter().flat_map(|way| way.segments.iter().copied()).collect();
        segments.sort_unstable();
        assert!(segments.into_iter().eq(0..network.segments.len() as u32), "each segment is in one way");
        for way in &ways {
            assert_eq!(way.segments.len(), way.nodes.len() - usize::from(!way.closed));
            let all: Vec<u32> = way.around(0, 3).collect();
            assert_eq!(
                all.len(),
                if way.closed { 6 } else { 3 },
                "three on either side where there are so many"
            );
        }
        let place = |node: u32| network.nodes[node as usize];
        ways.iter()
            .map(|way| (way.ends().map(place), way))
            .map(|([a, b], way)| (a, b, way.nodes.len(), way.closed))
            .collect()
    }

    #[test]
    fn ways_lead_from_corner_to_corner() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let line = |a: Vec3, b: Vec3| (0..=10).map(|n| a.lerp(b, 0.1 * n as f32)).collect::<Vec<Vec3>>();
        let (left, corner, up) = (at(-1.0, 0.0), at(0.0, 0.0), at(0.0, 1.0));
        let mut ell = told(&[line(left, corner), line(corner, up)]);
        ell.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
        let ends: Vec<[Vec3; 2]> = ell.iter().map(|way| [way.0, way.1]).collect();
        assert!(
            ends.iter().all(|ends| ends.contains(&corner)) && ell.iter().all(|way| way.2 == 11),
            "{ell:?}"
        );
        // One that trembles, by a third of a step, has no corners but its ends.
        let tremble = (0..=20).map(|n| at(0.1 * n as f32, if n % 2 == 0 { 0.0 } else { 0.035 })).collect();
        assert_eq!(told(&[tremble]), [(at(0.0, 0.0), at(0.1 * 20.0, 0.0), 21, false)]);
        // Nor has a circle.
        let round = |n: u32| {
            let (sin, cos) = libm::sincosf(std::f32::consts::TAU * (n % 40) as f32 / 40.0);
            at(cos, sin)
        };
        let circle = told(&[(0..=40).map(round).collect()]);
        assert!(circle.len() == 1 && circle[0].3 && circle[0].2 == 40, "{circle:?}");
    }
}
