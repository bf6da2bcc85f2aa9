//! What the input's surface is: welded, cut along its feature lines, with neighbours and normals.
//!
//! Both kinds of input end as one [`surface::Surface`], so that nothing below asks which it was.

pub mod around;
mod back_to_back;
mod bends;
mod blocks;
pub mod canonical;
mod cell;
pub mod chains;
mod cloud_assembly;
pub mod cloud_creases;
mod cloud_ends;
pub mod cloud_graph;
pub mod cloud_normals;
mod cloud_snap;
pub mod cloud_surface;
mod consensus;
pub mod creases;
mod curved;
pub mod detours;
pub mod distinct;
pub mod doubled;
mod edge_paths;
pub mod edges;
mod flips;
pub mod given_lines;
mod least_axis;
pub mod line_cut;
mod line_ends;
pub mod line_network;
pub mod line_sheets;
mod line_ways;
pub mod marks;
pub mod mesh_surface;
pub mod nearest;
mod open_places;
pub mod orient;
pub mod outliers;
pub mod partners;
#[cfg(test)]
pub(crate) mod planted;
pub mod refine;
pub mod seams;
pub mod segment_grid;
pub mod sets;
pub mod sided;
pub mod sides;
pub mod smooth;
pub mod smoothed;
mod snap;
mod sparse;
pub mod split;
mod strips;
pub mod surface;
pub mod thin;
pub mod weld;
pub mod worth;
