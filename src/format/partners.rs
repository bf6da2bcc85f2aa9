//! The chunk of clip partners: who cuts whom, and how their areas come together.
//!
//! Partnership is mutual, so a pair is listed once, by the splat that comes first in the file.
//! `format-spec.md`, section 8.2, is the norm.

use super::fields::{Fields, LONGEST, push};
use super::limits::Limits;
use crate::error::{Error, Result};
use crate::model::partner::{Cut, Group, Partner};
use crate::model::splat::Splat;

/// What errors call the chunk.
const PLACE: &str = "chunk PART";

/// The layout of the chunk that this crate writes and reads.
const VERSION: u8 = 1;

/// No file holds more pairs than this many times its splats.
const MOST_PAIRS: u64 = 64;

/// Bytes of the chunk for each splat, at most: two numbers for each splat, and for each pair one
/// and a label on either side. (The byte of the version is less than what is never reached.)
pub const MOST_BYTES: u64 = LONGEST as u64 * (2 + 3 * MOST_PAIRS);

/// Each partner cuts by itself.
const UNION: u64 = 0;
/// A place is cut away where all partners cut it.
const INTERSECTION: u64 = 1;
/// Each partner has a label.
const GROUPS: u64 = 2;

/// One partner of a splat, as the file has it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Link {
    /// Place in the file.
    other: u32,
    cut: Cut,
    /// Number of its group, from 1; 0 if it does not cut.
    label: u64,
}

/// The chunk's bytes for splats whose order in the file is `order`, a list of their indices;
/// empty if no splat has partners.
///
/// # Errors
/// [`Error::Usage`] for partners that are not some other splats, and for too many of them.
pub fn split(splats: &[Splat], order: &[u32]) -> Result<Vec<u8>> {
    if splats.iter().all(|splat| splat.partners.is_empty()) {
        return Ok(Vec::new());
    }
    let links = links(splats, order)?;
    let mut bytes = vec![VERSION];
    for (at, own) in links.iter().enumerate() {
        let later = &own[own.partition_point(|link| (link.other as usize) < at)..];
        push(&mut bytes, later.len() as u64);
        let mut last = at as u32;
        for link in later {
            let back = find(&links[link.other as usize], at as u32).map_or(Cut::Unseen, |back| back.cut);
            let sides = u64::from(link.cut == Cut::Seen) | u64::from(back == Cut::Seen) << 1;
            // At most 34 bits, so at most LONGEST bytes.
            push(&mut bytes, u64::from(link.other - last - 1) << 2 | sides);
            last = link.other;
        }
    }
    for own in links.iter().filter(|own| !own.is_empty()) {
        arrange(&mut bytes, own);
    }
    Ok(bytes)
}

/// The links of each splat in the order of the file, ascending; each pair on both its splats.
fn links(splats: &[Splat], order: &[u32]) -> Result<Vec<Vec<Link>>> {
    let mut place = vec![0_u32; splats.len()];
    for (at, &index) in order.iter().enumerate() {
        place[index as usize] = at as u32;
    }
    let mut links: Vec<Vec<Link>> = vec![Vec::new(); splats.len()];
    for (at, &index) in order.iter().enumerate() {
        for (n, group) in splats[index as usize].partners.iter().enumerate() {
            for partner in group {
                let Some(&other) = place.get(partner.splat as usize) else {
                    return Err(refused(format!("{} is no splat's index", partner.splat)));
                };
                links[at].push(Link { other, cut: partner.cut, label: n as u64 + 1 });
            }
        }
        links[at].sort_unstable();
        let twice = links[at].windows(2).any(|pair| pair[0].other == pair[1].other);
        if twice || find(&links[at], at as u32).is_some() {
            return Err(refused("a splat has a partner twice, or itself".into()));
        }
    }
    for at in 0..links.len() {
        for link in links[at].clone() {
            let back = &mut links[link.other as usize];
            let slot = back.partition_point(|other| (other.other as usize) < at);
            if back.get(slot).is_none_or(|other| other.other as usize != at) {
                back.insert(slot, Link { other: at as u32, cut: Cut::Unseen, label: 0 });
            }
        }
    }
    let pairs = links.iter().map(|own| own.len() as u64).sum::<u64>() / 2;
    if pairs > MOST_PAIRS * splats.len() as u64 {
        let what = format!("{pairs} pairs are more than {MOST_PAIRS} for each of {} splats", splats.len());
        return Err(refused(what));
    }
    Ok(links)
}

fn refused(why: String) -> Error {
    Error::Usage(format!("cannot store the clip partners: {why}"))
}

/// A splat's link to another, by the other's place.
fn find(links: &[Link], other: u32) -> Option<&Link> {
    let at = links.partition_point(|link| link.other < other);
    links.get(at).filter(|link| link.other == other)
}

/// Appends how the areas of a splat's partners come together.
fn arrange(bytes: &mut Vec<u8>, links: &[Link]) {
    let mut known: Vec<u64> = Vec::new();
    let labels: Vec<u64> = links
        .iter()
        .map(|link| match known.iter().position(|&label| label == link.label) {
            _ if link.label == 0 => 0,
            Some(at) => at as u64 + 1,
            None => {
                known.push(link.label);
                known.len() as u64
            }
        })
        .collect();
    if labels.iter().zip(1..).all(|(&label, n)| label == n) {
        push(bytes, UNION);
    } else if labels.iter().all(|&label| label == 1) {
        push(bytes, INTERSECTION);
    } else {
        push(bytes, GROUPS);
        labels.into_iter().for_each(|label| push(bytes, label));
    }
}

/// Gives splats in the order of the file the partners that the chunk states.
///
/// # Errors
/// [`Error::Format`] for bytes that the specification forbids; [`Error::Limits`] for more pairs
/// than the limits allow.
pub fn join(bytes: &[u8], splats: &mut [Splat], max_error: f64, limits: &Limits) -> Result<()> {
    let mut numbers = Fields(bytes);
    let [version] = numbers.take(PLACE)?;
    if version != VERSION {
        return Err(fault(format!("is of version {version}, unknown to this reader; update it")));
    }
    let links = pairs(&mut numbers, splats.len(), limits)?;
    // A partner brings its quadric, which does not change.
    let sheets = |link: &Link, splats: &[Splat]| {
        Partner::new(link.other, &splats[link.other as usize], link.cut, max_error)
    };
    for (at, own) in links.into_iter().enumerate().filter(|(_, own)| !own.is_empty()) {
        let mut groups: Vec<Group> = Vec::new();
        for link in arranged(&mut numbers, own)? {
            let partner = sheets(&link, splats);
            match link.label as usize {
                0 => {}
                label if label > groups.len() => groups.push(vec![partner]),
                label => groups[label - 1].push(partner),
            }
        }
        splats[at].partners = groups;
    }
    if numbers.0.is_empty() { Ok(()) } else { Err(fault("holds more than the splats need")) }
}

fn fault(why: impl Into<String>) -> Error {
    Error::format(PLACE, why.into())
}

/// The links of each splat, ascending, not yet labelled.
fn pairs(numbers: &mut Fields<'_>, count: usize, limits: &Limits) -> Result<Vec<Vec<Link>>> {
    let mut links: Vec<Vec<Link>> = vec![Vec::new(); count];
    let mut pairs = 0;
    for at in 0..count {
        let later = numbers.varint(PLACE)?;
        let mut last = at as u64;
        for _ in 0..later {
            pairs += 1;
            limits.check("clip partners", pairs, limits.partners)?;
            let number = numbers.varint(PLACE)?;
            last += (number >> 2) + 1;
            if last >= count as u64 {
                return Err(fault(format!("names splat {last} of {count}")));
            }
            let cut = |bit: u64| if number >> bit & 1 == 1 { Cut::Seen } else { Cut::Unseen };
            links[at].push(Link { other: last as u32, cut: cut(0), label: 0 });
            links[last as usize].push(Link { other: at as u32, cut: cut(1), label: 0 });
        }
    }
    // Those from before a splat came in while its forerunners were read.
    links.iter_mut().for_each(|own| own.sort_unstable());
    Ok(links)
}

/// Labels a splat's links as the chunk's next numbers say.
fn arranged(numbers: &mut Fields<'_>, mut links: Vec<Link>) -> Result<Vec<Link>> {
    let arrangement = numbers.varint(PLACE)?;
    let mut most = 0;
    let single = links.len() == 1;
    for (link, n) in links.iter_mut().zip(1..) {
        link.label = match arrangement {
            UNION => n,
            INTERSECTION if !single => 1,
            GROUPS => numbers.varint(PLACE)?,
            other => return Err(fault(format!("arranges {n} partners in the unknown way {other}"))),
        };
        if link.label > most + 1 {
            return Err(fault(format!("has a group {} after group {most}", link.label)));
        }
        most = most.max(link.label);
    }
    Ok(links)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::format::planted::bumpy_asset;

    /// Splats with every arrangement: united, intersected, in groups, cut one way only.
    fn partnered() -> Vec<Splat> {
        let mut splats = bumpy_asset(40, 30.0, 3).splats;
        let bare = splats.clone();
        let partner = |n: usize, cut| Partner::new(n as u32, &bare[n], cut, 2e-3);
        splats[0].partners = vec![vec![partner(3, Cut::Seen)], vec![partner(39, Cut::Unseen)]];
        splats[3].partners = vec![vec![partner(0, Cut::Seen), partner(7, Cut::Unseen)]];
        splats[7].partners =
            vec![vec![partner(3, Cut::Unseen), partner(20, Cut::Seen)], vec![partner(8, Cut::Seen)]];
        splats[20].partners = vec![vec![partner(7, Cut::Seen)]];
        splats
    }

    fn joined(bytes: &[u8]) -> Result<Vec<Splat>> {
        let mut splats = partnered();
        splats.iter_mut().for_each(|splat| splat.partners.clear());
        join(bytes, &mut splats, 2e-3, &Limits::default())?;
        Ok(splats)
    }

    #[test]
    fn partners_come_back() {
        let splats = partnered();
        let bytes = split(&splats, &(0..40).collect::<Vec<_>>()).unwrap();
        assert_eq!(joined(&bytes).unwrap(), splats);
        assert!((bytes.len() as u64) < MOST_BYTES * 40);
        let none = bumpy_asset(40, 30.0, 3).splats;
        assert!(split(&none, &(0..40).collect::<Vec<_>>()).unwrap().is_empty());
    }

    #[test]
    fn partners_follow_their_splats_into_another_order() {
        let splats = partnered();
        let order: Vec<u32> = (0..40).rev().collect();
        let mut turned: Vec<Splat> = order.iter().map(|&n| splats[n as usize].clone()).collect();
        turned.iter_mut().for_each(|splat| splat.partners.clear());
        join(&split(&splats, &order).unwrap(), &mut turned, 2e-3, &Limits::default()).unwrap();
        let again = split(&turned, &order).unwrap();
        assert_eq!(again, split(&splats, &(0..40).collect::<Vec<_>>()).unwrap());
    }

    #[test]
    fn what_no_file_may_hold_is_refused() {
        let bytes = split(&partnered(), &(0..40).collect::<Vec<_>>()).unwrap();
        for end in 0..bytes.len() {
            assert!(joined(&bytes[..end]).is_err(), "{end} bytes");
        }
        assert!(joined(&[bytes.as_slice(), &[0]].concat()).is_err());
        assert!(joined(&[&[9], &bytes[1..]].concat()).is_err(), "another version");
        // One pair: splat 0 with a later one, then 39 splats without, then what follows.
        let file = |pair: &[u8], rest: &[u8]| [&[VERSION, 1], pair, &[0; 39], rest].concat();
        assert!(joined(&file(&[1], &[0, 0])).is_ok() && joined(&file(&[1], &[2, 0, 2, 1])).is_ok());
        for (what, bytes) in [
            ("an index beyond the splats", file(&[0xa0, 0x01], &[0, 0])),
            ("idle bytes", file(&[0x81, 0x00], &[0, 0])),
            ("a long number", file(&[0x81, 0x81, 0x81, 0x81, 0x81, 0x01], &[0, 0])),
            ("an intersection of one", file(&[1], &[1, 0])),
            ("an unknown arrangement", file(&[1], &[3, 0])),
            ("a group too high", file(&[1], &[2, 2, 0])),
        ] {
            assert!(matches!(joined(&bytes), Err(Error::Format { .. })), "{what}");
        }
        let tight = Limits { partners: 4, ..Limits::default() };
        assert!(matches!(join(&bytes, &mut partnered(), 2e-3, &tight), Err(Error::Limits { .. })));
    }

    #[test]
    fn partners_that_are_not_there_cannot_be_stored() {
        let order: Vec<u32> = (0..40).collect();
        let mut splats = partnered();
        splats[0].partners[0][0].splat = 40;
        assert!(matches!(split(&splats, &order), Err(Error::Usage(_))));
        splats[0].partners[0][0].splat = 0;
        assert!(matches!(split(&splats, &order), Err(Error::Usage(_))));
    }
}
