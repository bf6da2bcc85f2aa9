//! A conic with its weights as third coordinates: what a polynomial of degree two is made of.

use glam::{DVec2, DVec3};

use crate::model::clip_curve::Conic;

/// The control points, each times its weight, and the weights.
#[derive(Clone, Copy, Debug)]
pub struct Homogeneous(pub [DVec3; 3]);

impl Homogeneous {
    /// Of a curve of any shape, with weights `1 - rho, rho, 1 - rho`.
    #[must_use]
    pub fn new(conic: &Conic) -> Self {
        let weighted = |p: DVec2, w: f64| (p * w).extend(w);
        let (outer, inner) = (1.0 - conic.rho, conic.rho);
        Self([weighted(conic.p1, outer), weighted(conic.p2, inner), weighted(conic.p3, outer)])
    }

    /// The blossom: the symmetric bilinear form whose diagonal is the curve.
    #[must_use]
    pub fn blossom(&self, s: f64, t: f64) -> DVec3 {
        let [a, b, c] = self.0;
        (1.0 - s) * (1.0 - t) * a + (s * (1.0 - t) + t * (1.0 - s)) * b + s * t * c
    }

    /// The distance of a point of the curve from the centre of an ellipse, in units of its border's and
    /// squared; infinite beyond the curve's infinity.
    #[must_use]
    pub fn reach(&self, t: f64, radii: DVec2) -> f64 {
        let point = self.blossom(t, t);
        let (x, y) = (point.x / point.z / radii.x, point.y / point.z / radii.y);
        if point.z > 0.0 { x * x + y * y } else { f64::INFINITY }
    }

    /// The conic from `t1` to `t3` in standard form; `None` where a weight is not positive.
    #[must_use]
    pub fn span(&self, t1: f64, t3: f64) -> Option<Conic> {
        let [a, b, c] = [self.blossom(t1, t1), self.blossom(t1, t3), self.blossom(t3, t3)];
        if a.z > 0.0 && b.z > 0.0 && c.z > 0.0 {
            let weight = b.z / (a.z * c.z).sqrt();
            Some(Conic {
                p1: a.truncate() / a.z,
                p2: b.truncate() / b.z,
                p3: c.truncate() / c.z,
                rho: weight / (1.0 + weight),
            })
        } else {
            None
        }
    }
}
