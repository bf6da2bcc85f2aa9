//! A cloud before a camera: the discs that its surface is known by.

use glam::{DVec2, DVec3};

use super::eye::{Eye, Ray};
use super::input::{Met, color};
use super::project::{self, Bound, Prism};
use super::tiles::{self, Hit, Look, Scene};
use crate::model::cloud::Cloud;
use crate::model::discs::{Disc, Discs};
use crate::model::intersect::{self, LocalRay};

/// A line within this many margins of a point ends its sheet, whatever lies between.
const LINE_REACH: f32 = 2.0;

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
}

impl<'a> DiscScene<'a> {
    /// Places the discs of a cloud before an eye.
    pub(super) fn new(cloud: &'a Cloud, discs: &'a Discs, eye: &'a Eye, extent: Extent) -> Self {
        Self { cloud, discs, eye, extent }
    }

    fn center(&self, item: usize) -> DVec3 {
        self.eye.to_view(self.cloud.positions[item].as_dvec3())
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

    /// What rays meet, surely or perhaps: see [`super::input::Prepared::met`].
    pub(super) fn met(&self) -> Met {
        let count = self.eye.size[0] as usize * self.eye.size[1] as usize;
        let mut met = Met { surely: vec![f64::INFINITY; count], perhaps: vec![false; count] };
        tiles::visit(self, self.eye, |place, item, ray, hit| {
            let disc = self.discs.at(item);
            met.perhaps[place] = true;
            let direction = ray.direction();
            let slant = (self.normal(disc).dot(direction) / direction.length()).abs();
            let margin = f64::from(disc.margin) / self.radius(disc);
            let surely = slant > f64::from(disc.turn) && hit.ellipse <= margin * margin;
            if surely && !self.is_in_gap(item, ray, hit.depth) {
                let deepest = hit.depth + f64::from(disc.sagitta()) / slant;
                met.surely[place] = met.surely[place].min(deepest);
            }
        });
        met
    }
}

impl Scene for DiscScene<'_> {
    fn len(&self) -> usize {
        self.cloud.positions.len()
    }

    fn bound(&self, item: usize) -> Option<Bound> {
        let disc = self.discs.at(item);
        let (normal, radius) = (self.normal(disc), self.radius(disc));
        let (u, v) = normal.any_orthonormal_pair();
        let half_axes = [radius * u, radius * v];
        project::bound(&Prism { center: self.center(item), half_axes, normal, low: 0.0, high: 0.0 }, self.eye)
    }

    fn hit(&self, item: usize, ray: &Ray) -> Option<Hit> {
        let disc = self.discs.at(item);
        let (center, normal, radius) = (self.center(item), self.normal(disc), self.radius(disc));
        let lateral = (ray.at(center.z) - center.truncate()).extend(0.0);
        let local = LocalRay {
            origin: DVec3::new(0.0, 0.0, lateral.dot(normal)),
            direction: DVec3::new(0.0, 0.0, ray.direction().dot(normal)),
        };
        let s = intersect::plane_root(&local, radius);
        if s > radius {
            return None;
        }
        let way = lateral + s * ray.direction();
        let ellipse = way.length_squared() / (radius * radius);
        let depth = center.z + s;
        let met = ellipse <= 1.0 && depth >= self.eye.near && self.is_own(item, way);
        met.then_some(Hit { depth, at: DVec2::ZERO, ellipse, gives_way: 0.0 })
    }

    fn look(&self, item: usize, _at: DVec2) -> Look {
        Look { normal: self.normal(self.discs.at(item)), color: color(self.cloud, item) }
    }
}
