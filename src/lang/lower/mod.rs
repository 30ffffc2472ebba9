//! Words to descriptions, descriptions to the IR. Each file reads the blocks of one kind; `emit` draws what is reached.

mod camera;
mod csg;
mod emit;
mod emit_input;
mod emit_light;
mod emit_material;
mod emit_model;
mod emit_surface;
mod environment;
mod extent;
mod finish;
mod fog;
mod image_map;
mod input;
mod interior;
mod item;
mod light;
mod material;
mod media;
mod mesh;
mod model;
mod modifier;
mod object;
mod parameters;
mod pattern;
mod pigment;
mod settings;
mod shapes;
mod skip;
mod surface;
mod texture;
mod transform;
mod words;

/// Whether a word begins something at the top level of a scene.
pub fn is_item_word(w: crate::lang::syntax::Word) -> bool {
    words::ITEMS.contains(&w)
}
