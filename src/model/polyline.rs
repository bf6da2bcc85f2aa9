//! Feature lines as they were read.

use glam::DVec3;

/// Polylines in *input* coordinates (64 bits): where the surface has sharp edges or ends.
///
/// A closed line repeats its first point at the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polylines {
    /// Each line's points in order, at least two.
    pub lines: Vec<Vec<DVec3>>,
}

/// Whether a line ends where it begins.
#[must_use]
pub fn is_closed(line: &[DVec3]) -> bool {
    line.len() > 2 && line.first() == line.last()
}

/// The place of the straight line from `a` to `b` nearest to another.
#[must_use]
pub fn nearest_on(a: DVec3, b: DVec3, place: DVec3) -> DVec3 {
    let along = b - a;
    let length = along.length_squared();
    if length > 0.0 { a + along * ((place - a).dot(along) / length).clamp(0.0, 1.0) } else { a }
}

/// A line of at least one point without those that lie between others, no farther than `most` off the straight
/// line through these (Douglas and Peucker 1973).
#[must_use]
pub fn straightened(line: &[DVec3], most: f64) -> Vec<DVec3> {
    let mut kept = vec![false; line.len()];
    kept[0] = true;
    kept[line.len() - 1] = true;
    let mut open = vec![(0, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (line[from], line[to]);
        let along = (b - a).normalize_or_zero();
        let off = |n: &usize| {
            let way = line[*n] - a;
            (way - way.dot(along) * along).length()
        };
        let farthest = (from + 1..to).max_by(|m, n| off(m).total_cmp(&off(n)));
        if let Some(at) = farthest.filter(|at| off(at) > most) {
            kept[at] = true;
            open.extend([(from, at), (at, to)]);
        }
    }
    line.iter().zip(kept).filter(|(_, kept)| *kept).map(|(place, _)| *place).collect()
}

impl Polylines {
    /// Number of segments over all lines.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.lines.iter().map(|line| line.len().saturating_sub(1)).sum()
    }

    /// The lines, all of whose segments are among some, ascending in the order of the lines.
    #[must_use]
    pub fn whole(&self, segments: &[u32]) -> Vec<usize> {
        let (mut first, mut whole) = (0, Vec::new());
        for (index, line) in self.lines.iter().enumerate() {
            let end = first + line.len().saturating_sub(1);
            let place = |segment: usize| segments.partition_point(|&other| (other as usize) < segment);
            if end > first && place(end) - place(first) == end - first {
                whole.push(index);
            }
            first = end;
        }
        whole
    }

    /// Length of all lines, in input units.
    #[must_use]
    pub fn length(&self) -> f64 {
        length(&self.lines)
    }
}

/// Length of all of some lines, in their units.
#[must_use]
pub fn length(lines: &[Vec<DVec3>]) -> f64 {
    let segments = lines.iter().flat_map(|line| line.windows(2));
    segments.map(|pair| pair[0].distance(pair[1])).fold(0.0, |sum, length| sum + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_whole_with_all_their_segments() {
        let line = |points: usize| vec![DVec3::ZERO; points];
        let lines = Polylines { lines: vec![line(3), line(1), line(2), line(4)] };
        assert_eq!(lines.whole(&[0, 1, 2, 3, 5]), [0, 2]);
        assert_eq!(lines.whole(&[1, 3, 4, 5]), [3]);
        assert!(lines.whole(&[]).is_empty());
    }
}
