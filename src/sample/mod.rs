//! Which splats: grow a domain around each seed, cover every piece of the surface, drop what
//! became redundant, move and merge what is left, choose anew from all that were grown, mend what shows
//! from the side.

pub mod backing;
pub mod budget;
pub mod candidates;
pub mod cover;
pub mod enclose;
pub mod facet;
mod gain;
pub mod grow;
pub mod lower_bound;
pub mod margin;
pub mod moves;
pub mod outline;
pub mod polygon;
mod rechoose;
pub mod region;
pub mod scout;
mod seal;
mod set_cover;
pub mod settle;
mod withdraw;
