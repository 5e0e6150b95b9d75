//! Arms from URDF and by name.

mod presets;
mod urdf;
