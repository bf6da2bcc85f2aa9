//! A cloud before a camera: the discs that its surface is known by.

use glam::{DVec2, DVec3, UVec2};
use rayon::prelude::*;

use super::eye::{Eye, Ray};
use super::input::{Met, color};
use super::project::{self, Bound, Prism};
use super::tiles::{Hit, Look, Rect, Scene};
use crate::model::cloud::Cloud;
use crate::model::discs::{Disc, Discs};
use crate::model::intersect::{self, LocalRay};

/// A line within this many margins of a point ends its sheet, whatever lies between.
const LINE_REACH: f32 = 2.0;

/// Discs that all eyes look at before the next ones: they stay in the cache, and their pictures lie together.
const BLOCK: usize = 1 << 14;

/// What rounding moves a picture by at most, samples.
const ROUNDING: f64 = 1e-6;

/// How far discs are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// As far as their points stand for the surface.
    Margin,
    /// As far as the surface may go on.
    Reach,
}

/// Discs before a camera.
pub(super) struct DiscScene<'a> {
    cloud: &'a Cloud,
    discs: &'a Discs,
    eye: &'a Eye,
    extent: Extent,
    /// Where the model's origin and its axes lie in an orthographic picture, in samples.
    plane: [DVec2; 4],
    /// Samples for each unit of an orthographic picture.
    samples: f64,
}

/// A disc in view coordinates.
struct Placed {
    center: DVec3,
    /// Unit.
    normal: DVec3,
    radius: f64,
}

impl Placed {
    fn bound(&self, eye: &Eye) -> Option<Bound> {
        let &Self { center, normal, radius } = self;
        let (u, v) = normal.any_orthonormal_pair();
        project::bound(
            &Prism { center, half_axes: [radius * u, radius * v], normal, low: 0.0, high: 0.0 },
            eye,
        )
    }

    /// The way from its centre to where a ray meets it.
    fn way(&self, ray: &Ray) -> Option<DVec3> {
        let &Self { center, normal, radius } = self;
        let lateral = (ray.at(center.z) - center.truncate()).extend(0.0);
        let local = LocalRay {
            origin: DVec3::new(0.0, 0.0, lateral.dot(normal)),
            direction: DVec3::new(0.0, 0.0, ray.direction().dot(normal)),
        };
        let s = intersect::plane_root(&local, radius);
        let way = lateral + s * ray.direction();
        (s <= radius && way.length_squared() <= radius * radius).then_some(way)
    }
}

impl<'a> DiscScene<'a> {
    /// Places the discs of a cloud before an eye.
    pub(super) fn new(cloud: &'a Cloud, discs: &'a Discs, eye: &'a Eye, extent: Extent) -> Self {
        let samples = eye.samples_per_unit();
        let across = |way: DVec3| samples * DVec2::new(eye.right.dot(way), -eye.up.dot(way));
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(across);
        let plane = [eye.middle() - across(eye.position), axes[0], axes[1], axes[2]];
        Self { cloud, discs, eye, extent, plane, samples }
    }

    fn center(&self, item: usize) -> DVec3 {
        self.eye.to_view(self.cloud.positions[item].as_dvec3())
    }

    fn placed(&self, item: usize) -> Placed {
        let disc = self.discs.at(item);
        Placed { center: self.center(item), normal: self.normal(disc), radius: self.radius(disc) }
    }

    /// A disc's normal in view coordinates; without one it faces the eye.
    fn normal(&self, disc: &Disc) -> DVec3 {
        let normal = disc.normal.as_dvec3();
        if normal == DVec3::ZERO { -DVec3::Z } else { self.eye.turn(normal) }
    }

    fn radius(&self, disc: &Disc) -> f64 {
        f64::from(match self.extent {
            Extent::Margin => disc.margin,
            Extent::Reach => disc.reach(),
        })
    }

    /// Whether what lies on a disc, `way` from its centre in view coordinates, is of its own sheet.
    fn is_own(&self, item: usize, way: DVec3) -> bool {
        self.discs.ends(item).is_empty() || {
            let center = self.cloud.positions[item].as_dvec3();
            self.discs.share(item, center, self.eye.turn_back(way)) >= 1.0
        }
    }

    /// Whether the surface may end before a place on a disc: in a gap, unless it goes on up to a line there.
    fn is_in_gap(&self, item: usize, ray: &Ray, depth: f64) -> bool {
        let disc = self.discs.at(item);
        let Some(gap) = disc.gap else { return false };
        let way = self.eye.turn_back(ray.at(depth).extend(depth) - self.center(item));
        let far = f64::from(LINE_REACH * disc.margin) / way.length();
        gap.holds(way) && self.discs.share(item, self.cloud.positions[item].as_dvec3(), far * way) >= 1.0
    }

    /// What rays meet, surely or perhaps, before each of some eyes: see [`super::input::Prepared::all_met`].
    ///
    /// All eyes look at a block of discs before the next, so that these are read from memory once.
    pub(super) fn all_met(cloud: &'a Cloud, discs: &'a Discs, eyes: &'a [Eye]) -> Vec<Met> {
        let before = |eye: &'a Eye| {
            let count = eye.size[0] as usize * eye.size[1] as usize;
            let met = Met { surely: vec![f64::INFINITY; count], perhaps: vec![false; count] };
            (Self::new(cloud, discs, eye, Extent::Reach), met)
        };
        let mut looks: Vec<_> = eyes.iter().map(before).collect();
        for first in (0..cloud.positions.len()).step_by(BLOCK) {
            let block = first..cloud.positions.len().min(first + BLOCK);
            looks.par_iter_mut().for_each(|(scene, met)| {
                block.clone().for_each(|item| scene.meet(item, met));
            });
        }
        looks.into_iter().map(|(_, met)| met).collect()
    }

    /// Adds what rays meet of one disc.
    fn meet(&self, item: usize, met: &mut Met) {
        let whole = Rect::whole(self.eye.size);
        if self.eye.perspective {
            let Some(bound) = self.bound(item) else { return };
            let placed = self.placed(item);
            return Rect::of(&bound, self.eye.size)
                .samples_in(&whole, |place, sample| self.meet_at(item, &placed, (place, sample), met));
        }
        let (place, [origin, x, y, z]) = (self.cloud.positions[item].as_dvec3(), self.plane);
        let middle = origin + place.x * x + place.y * y + place.z * z;
        // Rounding must not lose a ray that grazes the rim.
        let radius = self.samples * self.radius(self.discs.at(item)) + ROUNDING;
        // Of a dense cloud many discs lie between the rays of all pixels.
        let nearest = middle.as_uvec2();
        let to_ray = nearest.as_dvec2() + DVec2::splat(0.5) - middle;
        if to_ray.length_squared() > radius * radius {
            return;
        }
        let bound = Bound { min: middle - radius, max: middle + radius };
        let placed = self.placed(item);
        let ([across, up, ahead], wide) = (placed.normal.to_array(), radius * radius);
        Rect::of(&bound, self.eye.size).samples_in(&whole, |place, sample| {
            // Rays meet the disc within an ellipse of the picture, told here without a division.
            let off = UVec2::from(sample).as_dvec2() + DVec2::splat(0.5) - middle;
            let slope = across * off.x - up * off.y;
            if (off.length_squared() - wide) * ahead * ahead + slope * slope <= 0.0 {
                self.meet_at(item, &placed, (place, sample), met);
            }
        });
    }

    /// Adds what one ray meets of a disc, whose place in the picture comes with it.
    fn meet_at(&self, item: usize, placed: &Placed, (place, sample): (usize, [u32; 2]), met: &mut Met) {
        let hidden = |depth: f64, met: &Met| met.perhaps[place] && depth >= met.surely[place];
        if hidden(placed.center.z - placed.radius, met) {
            return;
        }
        let ray = self.eye.ray_through(sample);
        let Some(way) = placed.way(&ray) else { return };
        let depth = placed.center.z + way.z;
        if hidden(depth, met) || depth < self.eye.near || !self.is_own(item, way) {
            return;
        }
        met.perhaps[place] = true;
        let (disc, direction) = (self.discs.at(item), ray.direction());
        let slant = (placed.normal.dot(direction) / direction.length()).abs();
        let within = way.length_squared() <= f64::from(disc.margin) * f64::from(disc.margin);
        if within && slant > f64::from(disc.turn) && !self.is_in_gap(item, &ray, depth) {
            let deepest = depth + f64::from(disc.sagitta()) / slant;
            met.surely[place] = met.surely[place].min(deepest);
        }
    }
}

impl Scene for DiscScene<'_> {
    fn len(&self) -> usize {
        self.cloud.positions.len()
    }

    fn bound(&self, item: usize) -> Option<Bound> {
        self.placed(item).bound(self.eye)
    }

    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit> {
        let placed = self.placed(item);
        let way = placed.way(ray)?;
        let depth = placed.center.z + way.z;
        let ellipse = way.length_squared() / (placed.radius * placed.radius);
        let met = depth >= self.eye.near && self.is_own(item, way);
        met.then_some(Hit { depth, at: DVec2::ZERO, ellipse, gives_way: 0.0 })
    }

    fn look(&self, item: usize, _at: DVec2) -> Look {
        Look { normal: self.normal(self.discs.at(item)), color: color(self.cloud, item) }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::model::frame::Frame;
    use crate::render::Camera;
    use crate::render::camera::Projection;

    /// Multiples of these, whole numbers left off, spread evenly (the sequence R₃ of Roberts 2018).
    const SPREAD: DVec3 =
        DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3);

    /// Discs strewn through a cube, turned every way.
    fn discs(radius: f32) -> (Cloud, Discs) {
        let vector = |n: u32| (2.0 * (f64::from(n) * SPREAD).fract() - 1.0).as_vec3();
        let positions = (0..400).map(|n| 0.5 * vector(n)).collect();
        let disc = |n: u32| Disc {
            normal: vector(1000 + 7 * n).normalize(),
            margin: radius * (1.5 + vector(2000 + 13 * n).x),
            turn: 0.2 * vector(2000 + 13 * n).y.abs(),
            open: n.is_multiple_of(3),
            gap: None,
        };
        (Cloud { positions, ..Cloud::default() }, Discs::new((0..400).map(disc).collect(), &[]))
    }

    /// As [`DiscScene::all_met`], ray by ray and disc by disc.
    fn plainly(cloud: &Cloud, discs: &Discs, eye: &Eye) -> Met {
        let scene = DiscScene::new(cloud, discs, eye, Extent::Reach);
        let rays = (0..eye.size[1]).flat_map(|y| (0..eye.size[0]).map(move |x| eye.ray_through([x, y])));
        let met = rays.map(|ray| {
            let hits = (0..discs.all().len()).filter_map(|item| Some((item, scene.hit(item, &ray)?)));
            hits.fold((f64::INFINITY, false), |(surely, _), (item, hit)| {
                let (disc, direction) = (discs.at(item), ray.direction());
                let slant = (scene.normal(disc).dot(direction) / direction.length()).abs();
                let share = f64::from(disc.margin) / scene.radius(disc);
                let counts = slant > f64::from(disc.turn) && hit.ellipse <= share * share;
                let deepest = hit.depth + f64::from(disc.sagitta()) / slant;
                (if counts { surely.min(deepest) } else { surely }, true)
            })
        });
        let (surely, perhaps) = met.unzip();
        Met { surely, perhaps }
    }

    fn eyes() -> [Eye; 2] {
        let views = [Projection::Orthographic { height: 1.5 }, Projection::Perspective { fov_degrees: 40.0 }];
        views.map(|projection| {
            let (eye, target) = ([1.0, 2.0, 3.0], [0.1, 0.0, 0.0]);
            let camera = Camera { eye, target, up: [0.0, 1.0, 0.0], projection, near: None };
            Eye::new(&camera, &Frame::default(), [96, 80]).unwrap()
        })
    }

    #[test]
    fn discs_are_met_as_ray_by_ray() {
        // Of some pixels, of about one, and of a part of one.
        for radius in [0.05, 0.01, 0.003] {
            let (cloud, discs) = discs(radius);
            let eyes = eyes();
            for (eye, found) in eyes.iter().zip(DiscScene::all_met(&cloud, &discs, &eyes)) {
                let truth = plainly(&cloud, &discs, eye);
                assert_eq!(found.perhaps, truth.perhaps);
                assert!(truth.perhaps.iter().any(|perhaps| *perhaps));
                for (found, truth) in found.surely.iter().zip(&truth.surely) {
                    let both_miss = found.is_infinite() && truth.is_infinite();
                    assert!(both_miss || (found - truth).abs() < 1e-12, "{found} {truth}");
                }
            }
        }
    }
}
