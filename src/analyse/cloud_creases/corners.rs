//! Ends of lines brought together: over gaps, at corners, and on the lines that they run into.

use glam::{DMat3, DVec3, Vec3};

use super::arcs::Arc;
use super::ends::{AHEAD, End, stands};
use super::lines::Line;
use crate::analyse::nearest::Search;
use crate::analyse::sets::Sets;
use crate::error::Result;

/// A line may be carried on this far, in its size, to a corner at which others are known to meet, or three do: by chance
/// two sizes and more lie between the last sample of an edge of a cube and its corner.
const TO_KNOWN_CORNER: f64 = 4.0;

/// Ends that run the same way or against each other (sine of 15°) lead to no corner.
const PARALLEL: f64 = 0.26;

/// Times that lines which bend are carried on to where they meet, each from where they did before: what is left to go
/// shrinks by the angle that they turn by on the way...
const ROUNDS: usize = 4;

/// ... which all have to pass within this share of their size.
const SHARED: f64 = 0.2;

/// Ends looked at around one end.
const LOOKED_AT: usize = 16;

/// Places that an end may go on to are looked for around this share of its reach: those
/// reached lie in the ball whose middle that is.
const MIDWAY: f64 = 0.5;

/// Places of lines looked at there. They lie a third of a size apart, so that two lines have twelve
/// within the reach; its own, which comes from behind, has half as many.
const PLACES_LOOKED_AT: usize = 32;

/// Three directions span space if the volume between them is more than this: they do not lie in a plane by 15°.
pub(super) const SOLID: f64 = 0.26;

/// Weight of the mean of their places among the lines that meet at a corner, so that nearly parallel ones do
/// not meet far away.
const MEAN_WEIGHT: f64 = 1e-3;

/// Where ends meet, or one runs on to, and the numbers of these.
type Meeting = (DVec3, Vec<usize>);

fn ends(lines: &[Line]) -> Vec<End> {
    let open = lines.iter().enumerate().filter(|(_, line)| !line.closed);
    open.flat_map(|(n, line)| [false, true].into_iter().filter_map(move |last| End::of(n, line, last)))
        .collect()
}

/// A search over places; `None` where there are none.
///
/// # Errors
/// As [`Search::new`].
pub(super) fn search(places: impl Iterator<Item = DVec3>) -> Result<Option<Search>> {
    let places: Vec<Vec3> = places.map(|place| place.as_vec3()).collect();
    if places.is_empty() { Ok(None) } else { Search::new(&places).map(Some) }
}

/// What became of lines whose ends were carried on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Joined {
    /// Whether each line's two ends meet something.
    pub(super) met: Vec<[bool; 2]>,
    /// Of each line the first of those that it goes on with, over gaps, as one.
    pub(super) run: Vec<u32>,
}

/// Carries the ends of lines on to corners and to other lines; `smooth` tells whether the surface is where a place lies.
///
/// # Errors
/// As [`Search::new`].
pub(super) fn join(lines: &mut [Line], smooth: &impl Fn(DVec3) -> bool) -> Result<Joined> {
    let count = lines.len();
    let loose = ends(lines);
    let mut joining = Joining { lines, loose, met: vec![[false; 2]; count], runs: Sets::new(count) };
    // Two edges of a corner may turn by no more than one does over a gap; a third out of their plane tells it is none.
    let mut known = corners(&joining.loose, AHEAD)?;
    known.retain(|corner| joining.is_solid(corner));
    joining.bring(&known);
    let over_gaps = gaps(&joining.loose)?;
    joining.runs_on(over_gaps.iter().map(|(_, ends)| [ends[0], ends[1]]));
    joining.bring(&over_gaps);
    joining.measure();
    let round = round_gaps(joining.lines, &joining.loose, smooth)?;
    joining.go_round(round);
    let others = corners(&joining.loose, AHEAD)?;
    joining.bring(&others);
    known.extend(others);
    // By chance the samples of all edges end far from their corner, to which three lead all the same.
    let mut far = corners(&joining.loose, TO_KNOWN_CORNER)?;
    far.retain(|corner| joining.is_solid(corner));
    joining.bring(&far);
    known.extend(far);
    let late = to_corners(&joining.loose, &known)?;
    joining.bring(&late);
    let run = run_into(joining.lines, &joining.loose)?;
    joining.bring(&run);
    let Joining { met, mut runs, .. } = joining;
    Ok(Joined { met, run: (0..count as u32).map(|line| runs.root(line)).collect() })
}

/// Lines whose ends are carried on.
struct Joining<'a> {
    lines: &'a mut [Line],
    /// The ends that meet nothing yet.
    loose: Vec<End>,
    met: Vec<[bool; 2]>,
    runs: Sets,
}

impl Joining<'_> {
    /// Whether the ends at a meeting span space.
    fn is_solid(&self, (_, ends): &Meeting) -> bool {
        are_solid(&ends.iter().map(|&n| self.loose[n].outward).collect::<Vec<_>>())
    }

    /// Carries ends on to where they meet.
    fn bring(&mut self, meetings: &[Meeting]) {
        for (place, ends) in meetings {
            for end in ends.iter().map(|&n| &self.loose[n]) {
                extend(&mut self.lines[end.line], end, *place);
                self.met[end.line][usize::from(end.last)] = true;
            }
        }
        self.loose.retain(|end| !self.met[end.line][usize::from(end.last)]);
    }

    /// Carries the first end of each pair on to the other by the places between.
    fn go_round(&mut self, gaps: Vec<([usize; 2], Vec<DVec3>)>) {
        self.runs_on(gaps.iter().map(|(pair, _)| *pair));
        for (pair, places) in gaps {
            let [a, b] = pair.map(|n| &self.loose[n]);
            let own = &mut self.lines[a.line].places;
            for place in places.into_iter().chain([b.place]) {
                if a.last { own.push(place) } else { own.insert(0, place) }
            }
            for end in [a, b] {
                self.met[end.line][usize::from(end.last)] = true;
            }
        }
        self.loose.retain(|end| !self.met[end.line][usize::from(end.last)]);
    }

    /// Takes the lines of both ends of gaps for one.
    fn runs_on(&mut self, gaps: impl Iterator<Item = [usize; 2]>) {
        for [a, b] in gaps {
            self.runs.merge(self.loose[a].line as u32, self.loose[b].line as u32);
        }
    }

    /// Tells anew which of the ends left are of lines that stand, which gaps alone ask.
    fn measure(&mut self) {
        let mut lengths = vec![0.0; self.lines.len()];
        for (n, line) in (0_u32..).zip(&*self.lines) {
            lengths[self.runs.root(n) as usize] += line.length();
        }
        for end in &mut self.loose {
            end.stands = stands(lengths[self.runs.root(end.line as u32) as usize], end.size);
        }
    }
}

/// Lets a line end at a place.
fn extend(line: &mut Line, end: &End, place: DVec3) {
    let beyond = |other: DVec3| (other - place).dot(end.outward) >= 0.0;
    // What lies beyond the corner goes, but for the line's other end.
    while line.places.len() > 2 {
        let last = if end.last { line.places.len() - 1 } else { 0 };
        if !beyond(line.places[last]) {
            break;
        }
        line.places.remove(last);
    }
    if end.last { line.places.push(place) } else { line.places.insert(0, place) }
}

/// Where the two ends at a gap meet.
fn gaps(ends: &[End]) -> Result<Vec<Meeting>> {
    let meeting = |a: &End, b: &End| a.faces(b).then(|| between(a, b));
    let pairs = mutual(ends, meeting)?.into_iter();
    Ok(pairs.map(|(pair, place)| (place, pair.to_vec())).collect())
}

/// Pairs of ends at a gap over which a line goes on round a circle, each with the places on that.
fn round_gaps(
    lines: &[Line],
    ends: &[End],
    smooth: &impl Fn(DVec3) -> bool,
) -> Result<Vec<([usize; 2], Vec<DVec3>)>> {
    let arc = |a: &End, b: &End| {
        let tails = [a, b].map(|end| end.tail(lines));
        Arc::between([a, b], [&tails[0], &tails[1]]).filter(|arc| arc.is_creased(smooth))
    };
    Ok(mutual(ends, arc)?.into_iter().map(|(pair, arc)| (pair, arc.places().collect())).collect())
}

/// Pairs of ends at gaps, each the nearest of all that the other faces, with what leads from the first to the second.
fn mutual<T>(ends: &[End], over: impl Fn(&End, &End) -> Option<T>) -> Result<Vec<([usize; 2], T)>> {
    let Some(search) = search(ends.iter().map(|end| end.place))? else { return Ok(Vec::new()) };
    let facing = |n: usize| {
        let near = search.around(ends[n].place.as_vec3(), LOOKED_AT).into_iter().map(|other| other as usize);
        near.filter(|&other| other != n).find_map(|other| Some((other, over(&ends[n], &ends[other])?)))
    };
    let facing: Vec<Option<(usize, T)>> = (0..ends.len()).map(facing).collect();
    let faced: Vec<Option<usize>> =
        facing.iter().map(|facing| facing.as_ref().map(|found| found.0)).collect();
    let pairs = facing.into_iter().enumerate().filter_map(|(n, found)| Some((n, found?)));
    let pairs = pairs.filter(|&(n, (other, _))| n < other && faced[other] == Some(n));
    Ok(pairs.map(|(n, (other, over))| ([n, other], over)).collect())
}

/// The middle of the cubic that leads from one end to another as both do (Hermite's).
fn between(a: &End, b: &End) -> DVec3 {
    0.5 * (a.place + b.place) + 0.125 * a.place.distance(b.place) * (a.outward + b.outward)
}

/// Where ends meet, at right angles at most so many sizes ahead, and which do.
fn corners(ends: &[End], most: f64) -> Result<Vec<Meeting>> {
    let Some(search) = search(ends.iter().map(|end| end.place))? else { return Ok(Vec::new()) };
    let mut sets = Sets::new(ends.len());
    for (n, end) in ends.iter().enumerate() {
        for other in search.around(end.place.as_vec3(), LOOKED_AT) {
            if other as usize != n && meet(end, &ends[other as usize], most) {
                sets.merge(n as u32, other);
            }
        }
    }
    let mut groups: Vec<(u32, usize)> = (0..ends.len()).map(|n| (sets.root(n as u32), n)).collect();
    groups.sort_unstable();
    let groups = groups.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1);
    Ok(groups.filter_map(|group| corner(ends, group.iter().map(|&(_, n)| n).collect(), most)).collect())
}

/// Whether two ends lead to one place, at right angles at most so many sizes ahead.
fn meet(a: &End, b: &End, most: f64) -> bool {
    let cross = a.outward.cross(b.outward);
    let between = b.place - a.place;
    if cross.length() <= PARALLEL {
        return false;
    }
    // Where the two lines pass each other.
    let square = cross.length_squared();
    let along = |outward: DVec3| between.cross(outward).dot(cross) / square;
    let (s, t) = (along(b.outward), along(a.outward));
    let place = 0.5 * (a.place + s * a.outward + b.place + t * b.outward);
    a.is_apart(b) && a.reaches(place, a.corner_reach(b, most)) && b.reaches(place, b.corner_reach(a, most))
}

/// Whether some directions span space.
fn are_solid(ways: &[DVec3]) -> bool {
    let pairs = ways.iter().enumerate().flat_map(|(n, a)| ways[..n].iter().map(move |b| a.cross(*b)));
    pairs.into_iter().any(|across| ways.iter().any(|way| across.dot(*way).abs() > SOLID))
}

/// The place nearest to all lines that end there, and those ends that reach it.
fn corner(ends: &[End], mut of: Vec<usize>, most: f64) -> Option<Meeting> {
    loop {
        let lines: Vec<[DVec3; 2]> = of.iter().map(|&n| [ends[n].place, ends[n].outward]).collect();
        let place = meeting(&lines);
        let others = |n: usize| of.iter().filter(move |&&other| other != n).map(|&other| &ends[other]);
        let ahead = |n: usize| others(n).map(|other| ends[n].corner_reach(other, most)).fold(0.0, f64::max);
        let reaching: Vec<usize> = of.iter().copied().filter(|&n| ends[n].reaches(place, ahead(n))).collect();
        if reaching.len() < 2 {
            return None;
        }
        if reaching.len() == of.len() {
            let of_all = || of.iter().map(|&n| &ends[n]);
            return Some((bent_meeting(of_all, place).unwrap_or(place), of));
        }
        of = reaching;
    }
}

/// The place near another at which some ends that are carried on as their lines bend meet, if they do.
fn bent_meeting<'a, I: Iterator<Item = &'a End>>(ends: impl Fn() -> I, mut place: DVec3) -> Option<DVec3> {
    let straight = place;
    for _ in 0..ROUNDS {
        place = meeting(&ends().map(|end| end.toward(place)).collect::<Vec<_>>());
    }
    let passes = |end: &End| {
        let [at, way] = end.toward(place);
        (place - at).reject_from_normalized(way).length() <= SHARED * end.size
    };
    ends().all(|end| place.distance(straight) <= AHEAD * end.size && passes(end)).then_some(place)
}

/// The place nearest to all of some lines, each of which has a place and a direction (unit vector).
#[must_use]
pub fn meeting(lines: &[[DVec3; 2]]) -> DVec3 {
    let mean = lines.iter().map(|[place, _]| place).sum::<DVec3>() / lines.len() as f64;
    let (mut square, mut side) = (MEAN_WEIGHT * DMat3::IDENTITY, DVec3::ZERO);
    for &[place, o] in lines {
        square += DMat3::IDENTITY - DMat3::from_cols(o.x * o, o.y * o, o.z * o);
        side += (place - mean).reject_from_normalized(o);
    }
    mean + square.inverse() * side
}

/// Loose ends that lead to corners at which others meet.
fn to_corners(loose: &[End], corners: &[Meeting]) -> Result<Vec<Meeting>> {
    let Some(search) = search(corners.iter().map(|corner| corner.0))? else { return Ok(Vec::new()) };
    let corner = |(n, end): (usize, &End)| {
        let near = search.around(midway(end, TO_KNOWN_CORNER), LOOKED_AT);
        let places = near.into_iter().map(|near| corners[near as usize].0);
        Some((end.nearest(places, TO_KNOWN_CORNER)?, vec![n]))
    };
    Ok(loose.iter().enumerate().filter_map(corner).collect())
}

/// Loose ends that run into other lines, each at a place of such a line.
fn run_into(lines: &[Line], loose: &[End]) -> Result<Vec<Meeting>> {
    let all: Vec<(usize, DVec3)> = lines
        .iter()
        .enumerate()
        .flat_map(|(n, line)| line.places.iter().map(move |&place| (n, place)))
        .collect();
    let Some(search) = search(all.iter().map(|(_, place)| *place))? else { return Ok(Vec::new()) };
    let hit = |(n, end): (usize, &End)| {
        let near = search.around(midway(end, AHEAD), PLACES_LOOKED_AT).into_iter();
        let others = near.map(|near| all[near as usize]).filter(|&(line, _)| line != end.line);
        Some((end.nearest(others.map(|(_, place)| place), AHEAD)?, vec![n]))
    };
    Ok(loose.iter().enumerate().filter_map(hit).collect())
}

/// The middle of what lies at most so many sizes ahead of an end.
fn midway(end: &End, most: f64) -> Vec3 {
    (end.place + MIDWAY * most * end.size * end.outward).as_vec3()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A line along a circle of radius 12 about the origin, from one angle to another, in degrees.
    fn arc(from: f64, to: f64) -> Line {
        let at = |n: u32| {
            let (sin, cos) = libm::sincos((from + (to - from) * f64::from(n) / 60.0).to_radians());
            DVec3::new(12.0 * cos, 12.0 * sin, 0.0)
        };
        Line { places: (0..=60).map(at).collect(), closed: false, size: 1.0 }
    }

    #[test]
    fn three_lines_meet_farther_ahead_than_two() {
        // Edges of a cube that end so many sizes before its corner.
        let edges = |short: f64| {
            let edge = |axis: DVec3| {
                let places = (0..=30).map(|n| (short + 10.0 - f64::from(n) / 3.0) * axis).collect();
                Line { places, closed: false, size: 1.0 }
            };
            DVec3::AXES.map(edge)
        };
        for (short, three, two) in [(1.5, true, true), (3.0, true, false), (5.0, false, false)] {
            let mut lines = edges(short);
            let met = join(&mut lines, &|_| true).unwrap().met;
            assert_eq!(met, [[false, three]; 3], "{short}");
            let ends = lines.iter().filter_map(|line| line.places.last());
            assert!(!three || ends.into_iter().all(|end| end.length() < 0.01));
            assert_eq!(join(&mut edges(short)[..2], &|_| true).unwrap().met, [[false, two]; 2], "{short}");
        }
    }

    #[test]
    fn wide_gaps_are_bridged_where_the_line_goes_straight_on() {
        // Of 1.7, 3.8 and 5.2 sizes.
        for (degrees, met) in [(8.0, true), (18.0, true), (25.0, false)] {
            let mut lines = [arc(0.0, 90.0), arc(90.0 + degrees, 180.0 + degrees)];
            assert_eq!(join(&mut lines, &|_| true).unwrap().met, [[false, met], [met, false]], "{degrees}°");
            if met {
                let place = *lines[0].places.last().unwrap();
                // The middle of the wider gap's chord is off by 0.15.
                assert!((place.length() - 12.0).abs() < 0.06, "{degrees}°: {place} is off the circle");
                assert_eq!(lines[1].places[0], place);
            }
        }
        // As wide as the second of these, to a line beside the first.
        let mut lines = [arc(0.0, 90.0), arc(108.0, 198.0)];
        for place in &mut lines[1].places {
            *place += 1.2 * place.normalize();
        }
        assert_eq!(join(&mut lines, &|_| true).unwrap().met, [[false; 2]; 2]);
        // And between lines of which neither, or one, is long enough to be one by itself.
        for (from, met) in [(70.0, false), (0.0, true)] {
            let mut lines = [arc(from, 90.0), arc(108.0, 128.0)];
            assert_eq!(
                join(&mut lines, &|_| true).unwrap().met,
                [[false, met], [met, false]],
                "from {from}°"
            );
        }
    }

    /// A straight line with as many places as that is long, in sizes, times three.
    fn straight(from: DVec3, to: DVec3) -> Line {
        let count = (3.0 * from.distance(to)) as u32;
        let places = (0..=count).map(|n| from.lerp(to, f64::from(n) / f64::from(count))).collect();
        Line { places, closed: false, size: 1.0 }
    }

    #[test]
    fn lines_that_end_before_their_corner_are_carried_on_to_it() {
        // Two sides of an angle, each as far from its tip as the other hides it, and a third line that ends
        // so far from the corner.
        for (degrees, short, third) in [(90.0_f64, 1.7, 3.9), (36.0, 3.9, 1.0), (20.0, 5.5, 3.9)] {
            let (sin, cos) = libm::sincos(0.5 * degrees.to_radians());
            let ways = [DVec3::new(cos, sin, 0.0), DVec3::new(cos, -sin, 0.0), DVec3::Z];
            let from = [short, short, third];
            let mut lines: Vec<Line> = ways
                .into_iter()
                .zip(from)
                .map(|(way, from)| straight(from * way, (from + 9.0) * way))
                .collect();
            assert_eq!(join(&mut lines, &|_| true).unwrap().met, [[true, false]; 3], "{degrees}°");
            assert!(lines.iter().all(|line| line.places[0].length() < 0.1), "{degrees}°");
        }
        // None of these ends near enough for the angle.
        let mut lines = [straight(3.0 * DVec3::X, 9.0 * DVec3::X), straight(3.0 * DVec3::Y, 9.0 * DVec3::Y)];
        assert_eq!(join(&mut lines, &|_| true).unwrap().met, [[false; 2]; 2]);
    }

    #[test]
    fn two_edges_of_a_corner_that_turn_little_meet_where_the_third_leads() {
        // The corner of a hexagonal bar: two edges at 120°, which might go over a gap as one, and one along it.
        let (sin, cos) = libm::sincos(60_f64.to_radians());
        let ways = [DVec3::new(cos, sin, 0.0), DVec3::new(cos, -sin, 0.0), DVec3::Z];
        for third in [true, false] {
            let ways = &ways[..if third { 3 } else { 2 }];
            let mut lines: Vec<Line> = ways.iter().map(|&way| straight(0.7 * way, 9.0 * way)).collect();
            assert!(join(&mut lines, &|_| true).unwrap().met.iter().all(|met| *met == [true, false]));
            let off = lines[0].places[0].length();
            assert!((off < 1e-3) == third, "{off}");
        }
    }

    #[test]
    fn a_straight_line_goes_on_into_an_arc_over_a_gap() {
        // The side of a slot and its round end of radius 6, each some two sizes short of where they meet.
        let at = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            6.0 * DVec3::new(sin, 1.0 - cos, 0.0)
        };
        let round = Line {
            places: (0..20).map(|n| at(0.3 + 0.055 * f64::from(n))).collect(),
            closed: false,
            size: 1.0,
        };
        let mut lines = [straight(-12.0 * DVec3::X, -2.0 * DVec3::X), round];
        assert_eq!(join(&mut lines, &|_| true).unwrap().met, [[false, true], [true, false]]);
    }

    #[test]
    fn lines_that_bend_are_carried_on_to_their_corner_as_they_bend() {
        // Two arcs of radius 8 that leave one place at right angles and bend toward each other, and a line out of
        // their plane: each ends 1.7 sizes before, where its tangent passes the place by 0.2.
        let arc = |way: DVec3, to: DVec3| {
            let at = |n: u32| {
                let (sin, cos) = libm::sincos((1.7 + f64::from(n) / 3.0) / 8.0);
                8.0 * (sin * way + (1.0 - cos) * to)
            };
            Line { places: (0..24).map(at).collect(), closed: false, size: 1.0 }
        };
        let mut lines =
            [arc(DVec3::X, DVec3::Y), arc(DVec3::Y, DVec3::X), straight(1.7 * DVec3::Z, 9.0 * DVec3::Z)];
        assert_eq!(join(&mut lines, &|_| true).unwrap().met, [[true, false]; 3]);
        let off = lines.iter().map(|line| line.places[0].length()).fold(0.0, f64::max);
        assert!(off < 0.05, "{off}");
    }
}
