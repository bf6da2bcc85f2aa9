//! From a point cloud to its surface: sort and merge, find neighbours, give normals, cut
//! along feature lines, given or found, join.

use glam::{DVec3, Vec3};

use super::cloud_creases::{Sought, found};
use super::cloud_graph::{Joined, Sites};
use super::cloud_normals::{NormalSource, Normals, normals, parted};
use super::distinct::{Distinct, distinct};
use super::given_lines::Matched;
use super::line_cut::LineCut;
use super::line_network::Network;
use super::nearest::{Nearest, Search, spacing};
use super::outliers::outliers;
use super::surface::{NONE, Rows, Spot, Surface, inverse};
use crate::error::Result;
use crate::model::cloud::Cloud;

/// The surface of a cloud, and what is not part of it.
#[derive(Clone, Debug, Default)]
pub struct CloudSurface {
    /// The surface.
    pub surface: Surface,
    /// Points of the cloud that belong to no surface, ascending: outliers.
    pub left_out: Vec<u32>,
    /// Segments of the lines, given or found and resampled, at which a sheet of the surface ends.
    pub edges: usize,
    /// What became of the lines, if any were given; `edges` counts their samples' segments.
    pub matched: Option<Matched>,
}

/// Where the feature lines of a cloud come from.
#[derive(Clone, Copy, Debug)]
pub enum Lines<'a> {
    /// Given, model units; perhaps none.
    Given(&'a [Vec<DVec3>]),
    /// Its creases, so far as they are these.
    Found(Sought),
}

/// The surface of a cloud, cut along feature lines.
///
/// Neither the order of points and lines nor repeated points change anything but `left_out`.
/// Lines far from the cloud, and lines around which the points show no sheets, cut nothing.
///
/// # Errors
/// [`crate::Error::Usage`] where normals are to be kept and none is sound.
pub fn cloud_surface(cloud: &Cloud, source: NormalSource, lines: Lines<'_>) -> Result<CloudSurface> {
    let points = distinct(cloud);
    let search = Search::new(&points.positions)?;
    let nearest = search.nearest();
    let spacing = spacing(&points.positions, &nearest);
    let mut normals = normals(&points, &nearest, source)?;
    let resampled = |lines: &[_]| Network::new(lines, &search, &points.positions, &spacing);
    let mut network = match lines {
        Lines::Given(lines) => resampled(lines),
        Lines::Found(sought) => resampled(&found(&points.positions, &search, &nearest, &spacing, &sought)?),
    };
    drop(search);
    let lost = std::mem::take(&mut network.far);
    let cut = (!network.segments.is_empty()).then(|| cut(network, &points, &nearest, &spacing, &mut normals));
    let sites = Sites {
        positions: &points.positions,
        normals: &normals.normals,
        spacing: &spacing,
        nearest: &nearest,
    };
    let mut joined = match &cut {
        Some(cut) => sites.join(&|a, b| cut.parts(&sites, a, b)),
        None => sites.join(&|_, _| false),
    };
    let joins = cut.as_ref().map(|cut| cut.joins(&sites)).unwrap_or_default();
    let mut on_line = vec![false; joined.len()];
    for &(_, point) in &joins {
        on_line[point as usize] = true;
    }
    if let Some(cut) = &cut {
        for (point, joined) in (0_u32..).zip(&mut joined) {
            joined.margin = joined.margin.max(cut.reach(&sites, point));
        }
    }
    let outlier = outliers(&nearest, &spacing, &joined, &on_line);
    let place = |v: &u32| outlier[points.place[*v as usize] as usize];
    let left_out = (0..points.place.len() as u32).filter(place).collect();
    let surface = assemble(&points, &normals.normals, &joined, &outlier, cut.as_ref(), joins);
    let (edges, length) = cut.as_ref().map_or((0, 0.0), LineCut::found);
    let matched = match lines {
        Lines::Given(lines) if !lines.is_empty() => Some(matched(lines, edges, length, lost)),
        Lines::Given(_) | Lines::Found(_) => None,
    };
    Ok(CloudSurface { surface, left_out, edges, matched })
}

/// Cuts the cloud along a network; estimated normals beside it are estimated again.
fn cut(
    network: Network,
    points: &Distinct,
    nearest: &Nearest,
    spacing: &[f32],
    found: &mut Normals,
) -> LineCut {
    let sites = Sites { positions: &points.positions, normals: &found.normals, spacing, nearest };
    let cut = LineCut::new(network, &sites);
    if found.estimated {
        let mut again = found.normals.clone();
        parted(points, nearest, &|a, b| cut.parts(&sites, a, b), &mut again);
        found.normals = again;
    }
    cut
}

fn matched(lines: &[Vec<DVec3>], edges: usize, matched_length: f64, lost: Vec<u32>) -> Matched {
    let length = lines.iter().flat_map(|line| line.windows(2)).map(|side| side[0].distance(side[1])).sum();
    Matched { edges, length, matched_length: matched_length.min(length), lost, ..Matched::default() }
}

/// The surface over all points that are no outliers, and those on lines.
fn assemble(
    points: &Distinct,
    normals: &[Vec3],
    joined: &[Joined],
    outlier: &[bool],
    cut: Option<&LineCut>,
    joins: Vec<(u32, u32)>,
) -> Surface {
    let kept: Vec<u32> = (0..outlier.len() as u32).filter(|&n| !outlier[n as usize]).collect();
    let mut index = vec![NONE; outlier.len()];
    for (new, &old) in kept.iter().enumerate() {
        index[old as usize] = new as u32;
    }
    let count = kept.len() as u32;
    let on_lines = cut.map(|cut| cut.points.as_slice()).unwrap_or_default();
    let rows = count + on_lines.len() as u32;
    let mut border_next = vec![NONE; rows as usize];
    let mut from_lines = joins;
    from_lines.retain(|&(_, point)| index[point as usize] != NONE);
    for pair in &mut from_lines {
        pair.1 = index[pair.1 as usize];
    }
    for (from, to) in cut.into_iter().flat_map(LineCut::sides) {
        border_next[(count + from) as usize] = count + to;
        from_lines.push((from, count + to));
    }
    let from_lines = Rows::from_pairs(on_lines.len(), from_lines);
    let listed = |row: u32| {
        let sectors = (row < count).then(|| joined[kept[row as usize] as usize].sectors);
        let near = sectors.into_iter().flatten().filter(|&n| n != NONE).map(|n| index[n as usize]);
        let lines = if row < count { &[] } else { from_lines.row(row - count) };
        near.filter(|&n| n != NONE).chain(lines.iter().copied())
    };
    let of = |values: &[Vec3], more: fn(&super::line_cut::LinePoint) -> Vec3| {
        kept.iter().map(|&n| values[n as usize]).chain(on_lines.iter().map(more)).collect()
    };
    let like = kept.iter().copied().chain(on_lines.iter().map(|point| point.like));
    Surface {
        points: of(&points.positions, |point| point.position),
        places: (0..count).chain(on_lines.iter().map(|point| count + point.node)).collect(),
        normals: of(normals, |point| point.normal),
        colors: match points.colors.is_empty() {
            true => Vec::new(),
            false => like.map(|n| points.colors[n as usize]).collect(),
        },
        neighbours: Rows::symmetric(rows, listed),
        pieces: (0..count).map(|n| [n; 3]).collect(),
        spots: kept
            .iter()
            .map(|&n| Spot { position: points.positions[n as usize], margin: joined[n as usize].margin })
            .collect(),
        pieces_of: Rows::singles(rows, count),
        margin: kept.iter().map(|&n| joined[n as usize].margin).chain(on_lines.iter().map(|_| 0.0)).collect(),
        border_prev: inverse(&border_next),
        border_next,
    }
}
