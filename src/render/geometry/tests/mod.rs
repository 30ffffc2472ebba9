//! Properties of the whole: trees against brute force, watertightness, invariances, self-intersection.

mod agreement;
mod invariance;
mod reintersection;
mod solids;
mod spheres;
mod support;
mod watertight;
