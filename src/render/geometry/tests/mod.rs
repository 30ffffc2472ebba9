//! Properties of the whole: trees against brute force, watertightness, invariances, self-intersection.

mod agreement;
mod bending;
mod coplanar;
mod exact;
mod extremes;
mod invariance;
mod mesh_properties;
mod motion;
mod patterns;
mod placing;
mod planes;
mod properties;
mod reintersection;
mod solids;
mod sphere_reference;
mod spheres;
mod support;
mod truth;
mod watertight;
