//! The mesh of the head-like surface.

use super::geodesic::geodesic;
use super::head;
use super::surface::Surface;

/// The mesh.
pub fn mesh() -> Surface {
    geodesic(22, head::point)
}
