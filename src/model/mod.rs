//! What things are: the nouns that every room shares.

pub mod asset;
pub mod clip_curve;
pub mod cloud;
pub mod curve_ends;
pub mod discs;
pub mod frame;
pub mod intersect;
pub mod mesh;
pub mod neighbours;
pub mod outlook;
pub mod partner;
pub mod places;
pub mod polyline;
pub mod sight;
pub mod splat;
pub mod trial;
pub mod triangle;
