//! The part of the surface that an ellipse reaches without leaving it.

use glam::{DVec2, DVec3};

use crate::analyse::marks::Marks;
use crate::analyse::surface::Surface;
use crate::fit::pose::Pose;

/// A point inside the ellipse, in splat coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    /// The point.
    pub point: u32,
    /// Its `(u, v, w)`.
    pub local: DVec3,
}

/// What one walk over the surface found; reused from walk to walk.
#[derive(Debug)]
pub struct Region {
    /// Points inside the ellipse, joined to a seed inside it.
    pub members: Vec<Member>,
    /// Neighbours of members outside the ellipse, each with one of those members.
    pub rim: Vec<(u32, u32)>,
    /// Members and rim, after [`Self::gather`].
    pub marks: Marks,
}

impl Region {
    /// An empty region over a surface of `points` points.
    #[must_use]
    pub fn new(points: usize) -> Self {
        Self { members: Vec::new(), rim: Vec::new(), marks: Marks::new(points) }
    }

    /// The points inside the ellipse and just outside.
    pub fn reached(&self) -> impl Iterator<Item = u32> + '_ {
        self.members.iter().map(|member| member.point).chain(self.rim.iter().map(|&(_, outside)| outside))
    }

    /// Marks these points, and no others.
    pub fn mark_only(&mut self, points: &[u32]) {
        self.marks.clear();
        for &point in points {
            self.marks.insert(point);
        }
    }

    /// Whether all of these points are marked.
    #[must_use]
    pub fn marks_all(&self, points: &[u32]) -> bool {
        points.iter().all(|&point| self.marks.contains(point))
    }

    /// Walks from the seeds over all points inside the ellipse.
    ///
    /// False where a seed lies outside. A surface that
    /// folds over inside the ellipse is walked too: its far side is a large error.
    pub fn gather(&mut self, surface: &Surface, pose: &Pose, radii: DVec2, seeds: &[u32]) -> bool {
        self.marks.clear();
        self.members.clear();
        self.rim.clear();
        let squared = |local: DVec3| (local.truncate() / radii).length_squared();
        for &seed in seeds {
            if !self.marks.insert(seed) {
                continue;
            }
            let local = pose.to_local(surface.point(seed));
            if squared(local) > 1.0 {
                return false;
            }
            self.members.push(Member { point: seed, local });
        }
        let mut at = 0;
        while at < self.members.len() {
            let from = self.members[at].point;
            at += 1;
            for &to in surface.neighbours.row(from) {
                if !self.marks.insert(to) {
                    continue;
                }
                let local = pose.to_local(surface.point(to));
                if squared(local) > 1.0 {
                    self.rim.push((from, to));
                } else {
                    self.members.push(Member { point: to, local });
                }
            }
        }
        true
    }
}
