//! The classification on hand-made cases: the right angle, the box's corner, the hole, the L.
#![allow(clippy::panic)]

use glam::{DMat3, DVec2, DVec3, dvec3};

use super::*;

const RULE: Rule = Rule { agree: 0.9, max_error: 0.01 };

/// A disc.
fn disc(center: DVec3, normal: DVec3, radius: f64) -> Splat {
    let (i, j) = normal.any_orthonormal_pair();
    Splat {
        center,
        axes: DMat3::from_cols(i, j, normal),
        radii: DVec2::splat(radius),
        curvature: DVec2::ZERO,
        clips: Vec::new(),
        partners: Vec::new(),
        color: [255; 3],
    }
}

/// As in the paper: a splat is known by its centre.
fn centers(splats: &[Splat]) -> Vec<Shown> {
    splats.iter().map(|splat| Shown { places: vec![splat.center], ends: None }).collect()
}

/// The partners of a splat, group by group.
fn listed(groups: &[Group]) -> Vec<Vec<(u32, Cut)>> {
    groups.iter().map(|group| group.iter().map(|partner| (partner.splat, partner.cut)).collect()).collect()
}

/// Each of some walls around a polygon in the plane `z = 0`, below it, facing out of it; and the
/// polygon itself, last. Corners go around it with its inside on the left.
fn prism(corners: &[DVec2], face: Splat, places: &[DVec2]) -> (Vec<Splat>, Vec<Shown>) {
    const DEEP: DVec3 = dvec3(0.0, 0.0, -1.0);
    let flat = |p: &DVec2| p.extend(0.0);
    let sides: Vec<[DVec3; 2]> =
        (0..corners.len()).map(|n| [flat(&corners[n]), flat(&corners[(n + 1) % corners.len()])]).collect();
    let wall = |&[a, b]: &[DVec3; 2]| {
        let middle = a.midpoint(b) + 0.5 * DEEP;
        disc(middle, (b - a).cross(DVec3::Z).normalize(), 1.05 * a.distance(middle))
    };
    let around = |&[a, b]: &[DVec3; 2]| {
        let middle = a.midpoint(b) + 0.5 * DEEP;
        Shown { places: vec![middle], ends: Some(vec![[a, b], [a, a + DEEP], [b, b + DEEP]]) }
    };
    let mut splats: Vec<Splat> = sides.iter().map(wall).collect();
    let mut shown: Vec<Shown> = sides.iter().map(around).collect();
    splats.push(face);
    shown.push(Shown { places: places.iter().map(flat).collect(), ends: Some(sides) });
    (splats, shown)
}

#[test]
fn two_faces_of_a_box_cut_what_the_other_sees() {
    let splats = [disc(DVec3::ZERO, DVec3::Z, 1.2), disc(dvec3(1.0, 0.0, -0.8), DVec3::X, 1.2)];
    let (groups, tally) = clip_partners(&splats, &centers(&splats), &RULE);
    assert_eq!(listed(&groups[0]), [[(1, Cut::Seen)]]);
    assert_eq!(listed(&groups[1]), [[(0, Cut::Seen)]]);
    assert_eq!(tally, Tally { pairs: 1, united: 2, ..Tally::default() });
}

#[test]
fn floor_and_wall_cut_what_the_other_does_not_see() {
    let splats = [disc(DVec3::ZERO, DVec3::Z, 1.2), disc(dvec3(1.0, 0.0, 0.8), DVec3::NEG_X, 1.2)];
    let (groups, _) = clip_partners(&splats, &centers(&splats), &RULE);
    assert_eq!(listed(&groups[0]), [[(1, Cut::Unseen)]]);
    assert_eq!(listed(&groups[1]), [[(0, Cut::Unseen)]]);
}

#[test]
fn discs_that_do_not_cross_or_belong_to_one_surface_are_no_partners() {
    // Both cross the line of their planes, but side by side (Fig. 2a of the paper).
    let beside = [disc(DVec3::ZERO, DVec3::Z, 1.0), disc(dvec3(0.5, 1.7, -0.1), DVec3::X, 0.8)];
    let bent = [disc(DVec3::ZERO, DVec3::Z, 1.0), disc(DVec3::X, dvec3(0.3, 0.0, 1.0).normalize(), 1.0)];
    let apart = [disc(DVec3::ZERO, DVec3::Z, 1.0), disc(dvec3(2.1, 0.0, 0.0), DVec3::X, 1.0)];
    for splats in [beside, bent, apart] {
        let (groups, tally) = clip_partners(&splats, &centers(&splats), &RULE);
        assert!(groups.iter().all(Vec::is_empty) && tally == Tally::default(), "{groups:?}");
    }
}

#[test]
fn at_the_corner_of_a_box_areas_unite() {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
    let top = disc(dvec3(0.5, 0.5, 0.0), DVec3::Z, 0.75);
    let (splats, shown) = prism(&corners, top, &[DVec2::splat(0.5)]);
    let (groups, tally) = clip_partners(&splats, &shown, &RULE);
    assert_eq!(listed(&groups[4]), [0, 1, 2, 3].map(|wall| vec![(wall, Cut::Seen)]));
    assert_eq!(listed(&groups[0]), [1, 3, 4].map(|face| vec![(face, Cut::Seen)]));
    assert_eq!((tally.pairs, tally.united, tally.mixed, tally.given_up), (8, 5, 0, 0));
}

#[test]
fn around_a_hole_areas_intersect() {
    // Clockwise: the inside of the face is outside of the hole.
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)].map(|(x, y)| DVec2::new(x, y));
    let places = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(x, y)| DVec2::new(x, y));
    let (splats, shown) = prism(&corners, disc(DVec3::ZERO, DVec3::Z, 1.5), &places);
    let (groups, tally) = clip_partners(&splats, &shown, &RULE);
    assert_eq!(listed(&groups[4]), [[0, 1, 2, 3].map(|wall| (wall, Cut::Seen)).to_vec()]);
    // The hole's own walls are cut by the face, and by each other where they meet in a corner.
    assert_eq!(listed(&groups[0]), [(1, Cut::Unseen), (3, Cut::Unseen), (4, Cut::Seen)].map(|one| vec![one]));
    assert_eq!((tally.united, tally.intersected, tally.given_up), (4, 1, 0));
}

#[test]
fn a_mixed_set_falls_into_groups() {
    // An L: the walls of its inner corner cut together, the others each by itself.
    let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
    let corners = corners.map(|(x, y)| DVec2::new(x, y));
    let places = [(0.5, 0.5), (0.5, 1.5), (1.5, 0.5), (0.9, 0.9)].map(|(x, y)| DVec2::new(x, y));
    let (splats, shown) = prism(&corners, disc(dvec3(1.0, 1.0, 0.0), DVec3::Z, 2.0), &places);
    let (groups, tally) = clip_partners(&splats, &shown, &RULE);
    let seen = |walls: &[u32]| walls.iter().map(|&wall| (wall, Cut::Seen)).collect::<Vec<_>>();
    assert_eq!(listed(&groups[6]), [seen(&[0]), seen(&[1]), seen(&[2, 3]), seen(&[4]), seen(&[5])]);
    assert_eq!((tally.mixed, tally.given_up), (1, 0));
    let face = Splat { partners: groups[6].clone(), ..splats[6].clone() };
    let kept = |x: f64, y: f64| face.covers(face.to_local(dvec3(x, y, 0.0)).truncate());
    for (x, y, expected) in [
        (0.5, 1.9, true),
        (1.9, 0.5, true),
        (0.99, 0.99, true),
        (1.02, 1.02, false),
        (1.5, 1.5, false),
        (2.02, 0.5, false),
        (0.5, -0.02, false),
    ] {
        assert_eq!(kept(x, y), expected, "({x}, {y})");
    }
}

#[test]
fn what_is_shown_is_never_cut_away() {
    // A wall that only passes through a part of the floor.
    let splats = [disc(DVec3::ZERO, DVec3::Z, 1.2), disc(dvec3(0.5, 0.0, -0.8), DVec3::X, 1.0)];
    let mut shown = centers(&splats);
    shown[0].places.push(dvec3(0.9, 0.7, 0.0));
    let (groups, tally) = clip_partners(&splats, &shown, &RULE);
    assert_eq!((groups[0].len(), groups[1].len(), tally.given_up), (0, 1, 1));
}

#[test]
fn bent_splats_meet_along_their_bend() {
    // A cylinder's side and its lid: the lid is cut along the arc, not along a chord.
    let lid = disc(dvec3(0.0, 0.6, 0.0), DVec3::Z, 0.6);
    let mut side = disc(dvec3(0.0, 1.0, -0.3), DVec3::Y, 0.7);
    side.axes = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    side.curvature = DVec2::new(-0.5, 0.0);
    let splats = [lid, side];
    let (groups, _) = clip_partners(&splats, &centers(&splats), &RULE);
    let lid = Splat { partners: groups[0].clone(), ..splats[0].clone() };
    let kept = |x: f64, y: f64| lid.covers(lid.to_local(dvec3(x, y, 0.0)).truncate());
    let arc = |x: f64| 1.0 - 0.5 * x * x;
    for x in [-0.35, 0.0, 0.35] {
        assert!(kept(x, arc(x) - 0.001) && !kept(x, arc(x) + 0.02), "{x}");
    }
}
