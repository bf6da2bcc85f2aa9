//! The part of the surface that an ellipse reaches without leaving it.

use glam::{DVec2, DVec3};

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
#[derive(Debug, Default)]
pub struct Region {
    /// Points inside the ellipse, joined to a seed inside it.
    pub members: Vec<Member>,
    /// Neighbours of members outside the ellipse, each with one of those members.
    pub rim: Vec<(u32, u32)>,
    stamps: Vec<u32>,
    stamp: u32,
}

impl Region {
    /// An empty region over a surface of `points` points.
    #[must_use]
    pub fn new(points: usize) -> Self {
        Self { stamps: vec![0; points], ..Self::default() }
    }

    /// Starts a new set of marked points.
    pub fn unmark(&mut self) {
        if self.stamp == u32::MAX {
            self.stamps.fill(0);
            self.stamp = 0;
        }
        self.stamp += 1;
    }

    /// Marks a point; whether it was new.
    pub fn mark(&mut self, point: u32) -> bool {
        let stamp = &mut self.stamps[point as usize];
        let new = *stamp != self.stamp;
        *stamp = self.stamp;
        new
    }

    /// Whether a point is marked.
    #[must_use]
    pub fn marked(&self, point: u32) -> bool {
        self.stamps[point as usize] == self.stamp
    }

    /// Walks from the seeds over all points inside the ellipse.
    ///
    /// Afterwards members and rim are marked. False where a seed lies outside. A surface that
    /// folds over inside the ellipse is walked too: its far side is a large error.
    pub fn gather(&mut self, surface: &Surface, pose: &Pose, radii: DVec2, seeds: &[u32]) -> bool {
        self.unmark();
        self.members.clear();
        self.rim.clear();
        let squared = |local: DVec3| (local.truncate() / radii).length_squared();
        for &seed in seeds {
            if !self.mark(seed) {
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
                if !self.mark(to) {
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
