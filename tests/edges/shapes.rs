//! Small surfaces whose lines one clip curve cannot follow.

use std::f64::consts::TAU;

use glam::{DQuat, DVec2, DVec3, EulerRot, Vec3};
use qsplat::bake::Edges;
use qsplat::ingest::Input;
use qsplat::model::cloud::Cloud;
use qsplat::model::frame::Frame;
use qsplat::model::mesh::Mesh;
use qsplat::model::polyline::Polylines;

use super::catalogue::curve::{Circle, Curve, Fineness, closed, divided, line};
use super::catalogue::planar::{Facing, planar};
use super::catalogue::ruled::ruled;
use super::catalogue::surface::Surface;

/// Chords leave their arcs by about a tenth of the bound that the shapes are baked at.
const FINE: Fineness = Fineness { step: 0.06, chord_error: 1.5e-4 };

const UP: Facing = Facing { axis: 2, negative: false };
const DOWN: Facing = Facing { axis: 2, negative: true };

/// A surface, and where its lines come from.
pub struct Shape {
    /// What is hard about it.
    pub name: String,
    /// A mesh.
    pub input: Input,
    /// Given or found.
    pub edges: Edges,
}

fn shape(name: &str, surface: &Surface) -> Shape {
    let points = &surface.positions;
    let min = points.iter().copied().reduce(DVec3::min).unwrap();
    let max = points.iter().copied().reduce(DVec3::max).unwrap();
    let frame = Frame::of_box(min, max);
    let positions: Vec<Vec3> = points.iter().map(|&p| frame.to_model(p).as_vec3()).collect();
    let vertices = Cloud { frame, positions, ..Cloud::default() };
    let mesh = Mesh { vertices, triangles: surface.triangles.clone(), ..Mesh::default() };
    Shape { name: name.to_owned(), input: Input::Mesh(mesh), edges: Edges::Auto }
}

/// A closed outline of straight sides at a height, counter-clockwise.
fn polygon(corners: &[(f64, f64)], z: f64) -> Curve {
    let at = |n: usize| DVec2::from(corners[n % corners.len()]).extend(z);
    let sides: Vec<Curve> = (0..corners.len()).map(|n| line(at(n), at(n + 1), FINE)).collect();
    closed(&sides.iter().collect::<Vec<_>>()).unwrap()
}

/// An upright prism over an outline that is given for every height.
fn prism(name: &str, half: f64, outline: impl Fn(f64) -> Curve) -> Shape {
    let (low, high) = (outline(-half), outline(half));
    let mut surface = Surface::default();
    planar(&mut surface, &[&low], DOWN, FINE.step).unwrap();
    planar(&mut surface, &[&high], UP, FINE.step).unwrap();
    ruled(&mut surface, &low, &high, FINE.step, false);
    shape(name, &surface)
}

/// A block with a bar across its upper side: the bar's top lies between two lines.
fn rib() -> Shape {
    let (base, top, half) = (0.3, 0.36, 0.03);
    let outline = [(-half, base), (-0.5, base), (-0.5, 0.0), (0.5, 0.0), (0.5, base), (half, base)];
    let outline = [&outline[..], &[(half, top), (-half, top)]].concat();
    prism("a rib", 0.3, |z| polygon(&outline, z))
}

/// The same with a groove: so does its floor.
fn slot() -> Shape {
    let (base, floor, half) = (0.3, 0.24, 0.03);
    let outline = [(-half, base), (-0.5, base), (-0.5, 0.0), (0.5, 0.0), (0.5, base), (half, base)];
    let outline = [&outline[..], &[(half, floor), (-half, floor)]].concat();
    prism("a slot", 0.3, |z| polygon(&outline, z))
}

/// Tips of the star.
const TIP_COUNT: u32 = 12;

/// A prism over a star, with notches of 60° between tips of 30°, and of how many facets it is.
pub fn star() -> (Shape, usize) {
    let half_tip = 15.0_f64.to_radians();
    let inner = 0.25 / libm::cos(half_tip);
    let corners = (0..2 * TIP_COUNT).map(|n| {
        let radius = if n.is_multiple_of(2) { 0.5 } else { inner };
        (radius * DVec2::from_angle(TAU * f64::from(n) / f64::from(2 * TIP_COUNT))).into()
    });
    let corners: Vec<(f64, f64)> = corners.collect();
    (prism("notches of a star", 0.1, |z| polygon(&corners, z)), corners.len() + 2)
}

/// The arc of a radius from one point to another, to the left or the right of the way.
fn arc(a: DVec2, b: DVec2, z: f64, radius: f64, left: bool) -> Curve {
    let side = if left { 1.0 } else { -1.0 };
    let across = (b - a).perp().normalize() * side;
    let center = 0.5 * (a + b) - across * (radius * radius - 0.25 * a.distance_squared(b)).sqrt();
    let angle = |p: DVec2| libm::atan2(p.y - center.y, p.x - center.x).to_degrees();
    // An arc that bulges to the left of its way runs clockwise.
    let (from, to) = (angle(a), angle(b));
    let to = from - side * (side * (from - to)).rem_euclid(360.0);
    Circle { center: center.extend(z), u: DVec3::X, v: DVec3::Y, radius }.arc(from, to, FINE)
}

/// A block one of whose sides bends to and fro.
fn s_shaped() -> Shape {
    prism("an S-shaped line", 0.1, |z| {
        let [a, b, c] = [0.5, 0.0, -0.5].map(|x| DVec2::new(x, 0.2));
        let bends = [arc(a, b, z, 0.5, false), arc(b, c, z, 0.5, true)];
        let at = |x: f64, y: f64| DVec3::new(x, y, z);
        let corners = [c.extend(z), at(-0.5, -0.2), at(0.5, -0.2), a.extend(z)];
        let sides = [0, 1, 2].map(|n| line(corners[n], corners[n + 1], FINE));
        closed(&bends.iter().chain(&sides).collect::<Vec<_>>()).unwrap()
    })
}

/// A triangle of arcs: corners with two curved arms, that bulge out or in.
fn curved_corners(name: &str, outwards: bool) -> Shape {
    prism(name, 0.1, |z| {
        let corner = |n: u32| 0.5 * DVec2::from_angle(TAU * f64::from(n) / 3.0);
        let sides = [0, 1, 2].map(|n| arc(corner(n), corner(n + 1), z, 1.5, !outwards));
        closed(&sides.iter().collect::<Vec<_>>()).unwrap()
    })
}

/// A corner where so many lines meet, and the next corners on these: a pyramid, or ridges and valleys
/// by turns.
struct Corner {
    lines: u32,
    apex: DVec3,
    wave: f64,
}

impl Corner {
    fn new(lines: u32) -> Self {
        let (apex, wave) = if lines < 6 { (0.4, 0.0) } else { (0.0, 1.5 / f64::from(lines)) };
        Self { lines, apex: DVec3::Z * apex, wave }
    }

    fn rim(&self, n: u32) -> DVec3 {
        let height = if n.is_multiple_of(2) { self.wave } else { -self.wave };
        (0.5 * DVec2::from_angle(TAU * f64::from(n % self.lines) / f64::from(self.lines))).extend(height)
    }

    /// Triangles around it, or the first few of them, somehow turned: ridges that end at the rim, and
    /// corners there that are acute. Its lines are found.
    fn fan(&self, faces: u32) -> Shape {
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.5, 0.7);
        let mut surface = Surface::default();
        for n in 0..faces {
            let corners = [self.apex, self.rim(n), self.rim(n + 1)].map(|p| surface.vertex(turn * p));
            surface.triangle(corners, false);
        }
        shape(&format!("{faces} facets around a corner of {} lines", self.lines), &surface)
    }

    /// Four-cornered faces around it, none of whose other corners is acute, its lines given.
    fn open(&self) -> Shape {
        let mut surface = Surface::default();
        for n in 0..self.lines {
            let (a, b) = (self.rim(n), self.rim(n + 1));
            let outer = self.apex + 0.72 * ((a - self.apex) + (b - self.apex));
            let [apex, a, outer, b] = [self.apex, a, outer, b].map(|p| surface.vertex(p));
            surface.triangle([apex, a, outer], false);
            surface.triangle([apex, outer, b], false);
        }
        let given = (0..self.lines).map(|n| vec![self.apex, self.rim(n)]).collect();
        let edges = Edges::Given(Polylines { lines: given });
        Shape { edges, ..shape(&format!("a corner of {} lines given", self.lines), &surface) }
    }

    /// Triangles around it, and as many behind around another, its lines found.
    fn closed(&self) -> Shape {
        let mut surface = Surface::default();
        let back = DVec3::NEG_Z * 0.6;
        for n in 0..self.lines {
            let [apex, a, b, back] =
                [self.apex, self.rim(n), self.rim(n + 1), back].map(|p| surface.vertex(p));
            surface.triangle([apex, a, b], false);
            surface.triangle([back, b, a], false);
        }
        shape(&format!("a corner of {} lines found", self.lines), &surface)
    }
}

/// A shape with tips narrower than a pixel: where these end, no ray meets them, and one may meet what is cut
/// within the bound outside them.
pub const TIPS: &str = "acute corners of 30 to 70 degrees";

/// Flat kites beside each other, each with a corner more acute than the last.
fn kites() -> Shape {
    let mut surface = Surface::default();
    for n in 0..9_u32 {
        let (sin, cos) = libm::sincos(0.5 * f64::from(30 + 5 * n).to_radians());
        let center = 2.0 * DVec2::new(f64::from(n % 3), f64::from(n / 3));
        let place = |x: f64, y: f64| {
            let turned = DVec2::from_angle(0.7 * f64::from(n)).rotate(DVec2::new(x - 0.5, y));
            (center + turned).extend(0.0)
        };
        let corners = [(0.0, 0.0), (cos, -sin), (cos + 0.8 * sin, 0.0), (cos, sin)];
        let [tip, right, back, left] = corners.map(|(x, y)| surface.vertex(place(x, y)));
        surface.triangle([tip, right, back], false);
        surface.triangle([tip, back, left], false);
    }
    shape(TIPS, &surface)
}

/// A block with a round step in its upper side, up or down: its rim is a loop inside a splat.
fn loop_in_a_face(name: &str, step: f64) -> Shape {
    let corners = [(-0.5, -0.4), (0.5, -0.4), (0.5, 0.4), (-0.5, 0.4)];
    let [low, high] = [-0.1, 0.1].map(|z| polygon(&corners, z));
    let [foot, rim] = [0.1, 0.1 + step].map(|z| {
        let center = DVec3::new(0.1, 0.05, z);
        Circle { center, u: DVec3::X, v: DVec3::Y, radius: 0.04 }.whole(FINE)
    });
    let mut surface = Surface::default();
    planar(&mut surface, &[&low], DOWN, FINE.step).unwrap();
    planar(&mut surface, &[&high, &foot], UP, FINE.step).unwrap();
    planar(&mut surface, &[&rim], UP, FINE.step).unwrap();
    ruled(&mut surface, &low, &high, FINE.step, false);
    ruled(&mut surface, &foot, &rim, FINE.step, false);
    shape(name, &surface)
}

/// `z = 6 x² |y|` for `x > 0`, else 0: a crease that fades out towards the origin.
fn dart(name: &str, given: bool) -> Shape {
    const HALF: i32 = 20;
    let at = |n: i32| 0.5 * f64::from(n) / f64::from(HALF);
    let place = |i: i32, j: i32| {
        let (x, y) = (at(i), at(j));
        DVec3::new(x, y, 6.0 * x.max(0.0) * x.max(0.0) * y.abs())
    };
    let mut surface = Surface::default();
    for (i, j) in (-HALF..HALF).flat_map(|i| (-HALF..HALF).map(move |j| (i, j))) {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(n, m)| surface.vertex(place(i + n, j + m)));
        surface.triangle([a, b, c], false);
        surface.triangle([a, c, d], false);
    }
    let crease = divided(DVec3::ZERO, DVec3::X * 0.5, HALF as usize);
    let edges = if given { Edges::Given(Polylines { lines: vec![crease] }) } else { Edges::Auto };
    Shape { edges, ..shape(name, &surface) }
}

/// All shapes.
pub fn all() -> Vec<Shape> {
    let mut all = vec![
        rib(),
        slot(),
        s_shaped(),
        curved_corners("corners with arms that bulge out", true),
        curved_corners("corners with arms that bulge in", false),
        loop_in_a_face("a round hole smaller than a splat", -0.05),
        loop_in_a_face("a disc smaller than a splat", 0.05),
        dart("a line given that ends inside", true),
        dart("a line found that ends inside", false),
        kites(),
    ];
    all.extend([3, 4, 6, 12].map(|lines| Corner::new(lines).open()));
    all.extend([3, 4, 6, 12].map(|lines| Corner::new(lines).closed()));
    all
}

/// Open surfaces of a few large facets, and how many these are.
pub fn fans() -> Vec<(Shape, usize)> {
    let fan = |lines: u32, faces: u32| (Corner::new(lines).fan(faces), faces as usize);
    [(3, 2), (3, 3), (4, 4), (5, 5), (6, 6), (12, 12)].map(|(lines, faces)| fan(lines, faces)).into()
}
