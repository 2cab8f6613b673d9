//! Materials in single precision, as inner loops and devices read them.

pub(crate) mod bells;
pub(crate) mod color_table;
pub(crate) mod curve_table;
mod inverse_root;
pub(crate) mod lookup_table;
pub(crate) mod mixture;
pub(crate) mod model;
pub(crate) mod node;
mod proposal_table;
mod quantile_table;
pub(crate) mod reduced_table;
mod sampling;
mod vector;
