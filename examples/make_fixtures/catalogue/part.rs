//! A mechanical part: an L-bracket with a boss, a blind bore, a through hole and a notch.
//!
//! It has what makes edges hard: straight and circular ones, convex and concave, arcs that meet
//! straight edges in corners (the notch), and edges that turn from straight to round without a
//! corner (the wall's shoulders).

use glam::DVec3;
use qsplat::Result;

use super::curve::{Circle, Curve, Fineness, chain, closed, line};
use super::planar::{Facing, planar};
use super::ruled::ruled;
use super::surface::{Model, Surface};

/// Ends of the base along x; the wall stands at the lower end.
const X: (f64, f64) = (-0.5, 0.5);
/// Half the width along y.
const Y: f64 = 0.3;
/// Top of the base, which starts at 0.
const BASE: f64 = 0.12;
/// The wall's inner face.
const WALL_X: f64 = -0.38;
/// Top of the wall.
const WALL_TOP: f64 = 0.6;
/// Radius of the wall's two round shoulders.
const SHOULDER: f64 = 0.14;
/// Height and radius of the hole through the wall.
const HOLE: (f64, f64) = (0.38, 0.1);
/// Where the boss stands on the base, along x.
const BOSS_X: f64 = 0.08;
/// Radius and top of the boss.
const BOSS: (f64, f64) = (0.15, 0.34);
/// Radius and floor of its bore.
const BORE: (f64, f64) = (0.08, 0.2);
/// Radius of the half-round notch in the base's free end.
const NOTCH: f64 = 0.12;

/// A chord error of 1.5e-4 of the diagonal, 1.31.
const FINE: Fineness = Fineness { step: 0.032, chord_error: 2e-4 };

const UP: Facing = Facing { axis: 2, negative: false };
const DOWN: Facing = Facing { axis: 2, negative: true };
const FORWARD: Facing = Facing { axis: 0, negative: false };
const BACK: Facing = Facing { axis: 0, negative: true };

fn straight(a: [f64; 3], b: [f64; 3]) -> Curve {
    line(DVec3::from_array(a), DVec3::from_array(b), FINE)
}

/// A circle around the boss' axis.
fn around_boss(z: f64, radius: f64) -> Curve {
    Circle { center: DVec3::new(BOSS_X, 0.0, z), u: DVec3::X, v: DVec3::Y, radius }.whole(FINE)
}

/// The base's outline at a height, from one `x` on: the edge at that end, the two sides, and the
/// free end in three pieces with the notch between.
struct BaseOutline {
    end: Curve,
    sides: [Curve; 2],
    tips: [Curve; 2],
    notch: Curve,
}

impl BaseOutline {
    fn new(z: f64, x: f64) -> Self {
        let notch = Circle { center: DVec3::new(X.1, 0.0, z), u: DVec3::X, v: DVec3::Y, radius: NOTCH };
        Self {
            end: straight([x, -Y, z], [x, Y, z]),
            sides: [-Y, Y].map(|y| straight([x, y, z], [X.1, y, z])),
            tips: [-1.0, 1.0].map(|side| straight([X.1, side * Y, z], [X.1, side * NOTCH, z])),
            notch: notch.arc(90.0, 270.0, FINE),
        }
    }

    fn curves(&self) -> [&Curve; 6] {
        [&self.end, &self.sides[0], &self.tips[0], &self.notch, &self.tips[1], &self.sides[1]]
    }
}

/// The wall's outline at an `x`, from a foot height over both shoulders to the other foot, in
/// five pieces that join smoothly: post, shoulder, top, shoulder, post.
struct WallOutline {
    posts: [Curve; 2],
    shoulders: [Curve; 2],
    top: Curve,
    hole: Curve,
}

impl WallOutline {
    fn new(x: f64, foot: f64) -> Self {
        let circle = |y, z, radius| Circle { center: DVec3::new(x, y, z), u: DVec3::Y, v: DVec3::Z, radius };
        let (inner, below) = (Y - SHOULDER, WALL_TOP - SHOULDER);
        Self {
            posts: [-Y, Y].map(|y| straight([x, y, foot], [x, y, below])),
            shoulders: [(-inner, 180.0), (inner, 0.0)]
                .map(|(y, from)| circle(y, below, SHOULDER).arc(from, 90.0, FINE)),
            top: straight([x, -inner, WALL_TOP], [x, inner, WALL_TOP]),
            hole: circle(0.0, HOLE.0, HOLE.1).whole(FINE),
        }
    }

    fn arch(&self) -> Result<Curve> {
        chain(&[&self.posts[0], &self.shoulders[0], &self.top, &self.shoulders[1], &self.posts[1]])
    }
}

/// Base: bottom, top with the hole for the boss, the free end.
fn add_base(surface: &mut Surface, low: &BaseOutline, high: &BaseOutline, foot: &Curve) -> Result<()> {
    planar(surface, &[&closed(&low.curves())?], DOWN, FINE.step)?;
    planar(surface, &[&closed(&high.curves())?, foot], UP, FINE.step)?;
    let uprights = uprights();
    for n in 0..2 {
        let (corner, mouth) = (&uprights[n], &uprights[n + 2]);
        let tip = closed(&[&low.tips[n], mouth, &high.tips[n], corner])?;
        planar(surface, &[&tip], FORWARD, FINE.step)?;
    }
    ruled(surface, &low.notch, &high.notch, FINE.step, true);
    Ok(())
}

/// The upright edges at the free end: two corners, two mouths of the notch.
fn uprights() -> [Curve; 4] {
    [-Y, Y, -NOTCH, NOTCH].map(|y| straight([X.1, y, 0.0], [X.1, y, BASE]))
}

/// Boss: wall, annular top, bore and its floor.
fn add_boss(surface: &mut Surface, [foot, rim, mouth, floor]: [&Curve; 4]) -> Result<()> {
    ruled(surface, foot, rim, FINE.step, false);
    planar(surface, &[rim, mouth], UP, FINE.step)?;
    ruled(surface, floor, mouth, FINE.step, true);
    planar(surface, &[floor], UP, FINE.step)
}

/// Wall: both faces, the hole's wall, shoulders and top.
fn add_wall(
    surface: &mut Surface,
    outer: &WallOutline,
    inner: &WallOutline,
    ends: [&Curve; 2],
) -> Result<()> {
    planar(surface, &[&closed(&[&outer.arch()?, ends[0]])?, &outer.hole], BACK, FINE.step)?;
    planar(surface, &[&closed(&[&inner.arch()?, ends[1]])?, &inner.hole], FORWARD, FINE.step)?;
    ruled(surface, &outer.hole, &inner.hole, FINE.step, true);
    ruled(surface, &outer.shoulders[0], &inner.shoulders[0], FINE.step, true);
    ruled(surface, &outer.top, &inner.top, FINE.step, true);
    ruled(surface, &outer.shoulders[1], &inner.shoulders[1], FINE.step, false);
    Ok(())
}

/// The two L-shaped sides, from the base's bottom to where the shoulders begin.
fn add_sides(surface: &mut Surface, base: [&BaseOutline; 2], wall: [&WallOutline; 2]) -> Result<()> {
    let shoulder = WALL_TOP - SHOULDER;
    for (n, y) in [-Y, Y].into_iter().enumerate() {
        let across = straight([X.0, y, shoulder], [WALL_X, y, shoulder]);
        let outline = closed(&[
            &base[0].sides[n],
            &uprights()[n],
            &base[1].sides[n],
            &wall[1].posts[n],
            &across,
            &wall[0].posts[n],
        ])?;
        planar(surface, &[&outline], Facing { axis: 1, negative: y < 0.0 }, FINE.step)?;
    }
    Ok(())
}

/// The mesh and its lines, one curve from corner to corner each, or closed without a corner.
///
/// # Errors
/// As [`planar`] and [`closed`].
pub fn model() -> Result<Model> {
    let (low, high) = (BaseOutline::new(0.0, X.0), BaseOutline::new(BASE, WALL_X));
    let (outer, inner) = (WallOutline::new(X.0, 0.0), WallOutline::new(WALL_X, BASE));
    let foot = around_boss(BASE, BOSS.0);
    let [rim, mouth, floor] =
        [(BOSS.1, BOSS.0), (BOSS.1, BORE.0), (BORE.1, BORE.0)].map(|(z, radius)| around_boss(z, radius));
    let mut surface = Surface::default();
    add_base(&mut surface, &low, &high, &foot)?;
    add_boss(&mut surface, [&foot, &rim, &mouth, &floor])?;
    add_wall(&mut surface, &outer, &inner, [&low.end, &high.end])?;
    add_sides(&mut surface, [&low, &high], [&outer, &inner])?;

    let mut lines: Vec<Curve> = low.curves().into_iter().chain(high.curves()).cloned().collect();
    lines.extend(uprights());
    lines.extend([outer.arch()?, inner.arch()?, outer.hole, inner.hole, foot, rim, mouth, floor]);
    Ok(Model { surface, lines })
}
