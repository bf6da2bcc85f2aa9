//! Loops of feature lines so small that a cloud shows next to no surface inside, opened.

use glam::DVec3;

use super::line_network::Network;

/// A way from a node where more than two segments meet to the next node where not two do.
struct Way {
    end: u32,
    length: f64,
    segments: Vec<u32>,
}

/// The segments, ascending, of all but the shortest of several ways between two nodes, and of all from a node to
/// itself, no longer than `reach` (model units, at a node).
#[must_use]
pub fn detours(network: &Network, reach: &impl Fn(DVec3) -> f64) -> Vec<u32> {
    let mut detours = Vec::new();
    for node in 0..network.nodes.len() as u32 {
        if network.at_node.row(node).len() < 3 {
            continue;
        }
        let reach = reach(network.nodes[node as usize].as_dvec3());
        let from_here = network.at_node.row(node).iter();
        let mut ways: Vec<Way> =
            from_here.filter_map(|&segment| way(network, node, segment, reach)).collect();
        // Every way is met from both of its ends.
        ways.retain(|way| way.end >= node);
        ways.sort_by(|a, b| a.end.cmp(&b.end).then(a.length.total_cmp(&b.length)));
        for ways in ways.chunk_by(|a, b| a.end == b.end) {
            let kept = usize::from(ways[0].end != node);
            detours.extend(ways[kept..].iter().flat_map(|way| way.segments.iter().copied()));
        }
    }
    detours.sort_unstable();
    detours.dedup();
    detours
}

/// The way from a node by one of its segments, if it is no longer than `reach`.
fn way(network: &Network, node: u32, segment: u32, reach: f64) -> Option<Way> {
    let mut way = Way { end: node, length: 0.0, segments: Vec::new() };
    for (segment, end) in network.by_twos(segment, network.across(segment, node)) {
        way.length += network.length(segment);
        if way.length > reach {
            return None;
        }
        way.segments.push(segment);
        way.end = end;
    }
    Some(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_the_ways_around_a_small_loop_the_shortest_is_left() {
        let at = |x: f32, y: f32| glam::Vec3::new(x, y, 0.0);
        // A line that parts and meets again twice, round a small loop and a large one, with a small loop at its end.
        let ways = [
            vec![at(-1.0, 0.0), at(0.0, 0.0)],
            vec![at(0.0, 0.0), at(0.1, 0.01), at(0.2, 0.0)],
            vec![at(0.0, 0.0), at(0.1, -0.05), at(0.2, 0.0)],
            vec![at(0.2, 0.0), at(1.0, 0.0)],
            vec![at(1.0, 0.0), at(2.0, 0.1), at(3.0, 0.0)],
            vec![at(1.0, 0.0), at(2.0, -0.1), at(3.0, 0.0)],
            vec![at(3.0, 0.0), at(4.0, 0.0)],
            vec![at(4.0, 0.0), at(4.1, 0.0), at(4.05, 0.1), at(4.0, 0.0)],
        ];
        let pieces: Vec<_> =
            ways.iter().flat_map(|way| way.windows(2).map(|side| [side[0], side[1]])).collect();
        let network = Network::of_pieces(&pieces);
        let gone = detours(&network, &|_| 0.5);
        let middles = gone.iter().map(|&segment| network.ends(segment)).map(|[a, b]| 0.5 * (a + b));
        assert_eq!(gone.len(), 5);
        assert!(
            middles.clone().all(|middle| middle.y < 0.0 || middle.x >= 4.0),
            "{:?}",
            middles.collect::<Vec<_>>()
        );
        let left = network.without(&gone);
        assert!(detours(&left, &|_| 0.5).is_empty());
        assert_eq!(left.segments.len(), pieces.len() - 5);
    }
}
