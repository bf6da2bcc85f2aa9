//! Which splats: grow a domain around each seed, cover every piece of the surface, drop what
//! became redundant, move and merge what is left, choose anew from all that were grown, lay out others
//! for shares that neighbours exchange, shrink each to its own share, follow the lines that
//! none follows, mend what shows from the side.

pub mod backing;
pub mod budget;
pub mod candidates;
pub mod cover;
pub mod disc;
pub mod edge_cases;
pub mod enclose;
mod enlarge;
mod exchange;
pub mod facet;
mod follow;
mod gain;
pub mod grow;
pub mod lower_bound;
pub mod margin;
pub mod moves;
pub mod outline;
mod owners;
pub mod polygon;
mod rechoose;
pub mod region;
pub mod scout;
mod seal;
mod set_cover;
pub mod settle;
mod shaped;
mod starts;
mod steps;
pub mod thrift;
mod tighten;
mod withdraw;
