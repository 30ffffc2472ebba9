//! Properties of the whole: trees against brute force, watertightness, invariances, self-intersection.

mod agreement;
mod support;
