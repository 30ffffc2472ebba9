//! Properties of the whole: trees against brute force, watertightness, invariances, self-intersection.

mod agreement;
mod coplanar;
mod exact;
mod invariance;
mod mesh_properties;
mod placing;
mod properties;
mod reintersection;
mod solids;
mod spheres;
mod support;
mod truth;
mod watertight;
