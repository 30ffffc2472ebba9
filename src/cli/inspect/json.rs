//! What was found, for programs.

use super::{Found, place};
use crate::compile::effects::Effect;
use crate::diag::SourceMap;
use serde_json::{Value, json};

impl Found {
    /// One document; `version` grows when a key changes its meaning or goes away.
    pub(super) fn json(&self, sources: &SourceMap) -> Value {
        let effects: Value = Effect::ALL
            .into_iter()
            .map(|effect| {
                let causes = self.effects.causes(effect).iter();
                let causes: Vec<Value> = causes
                    .map(|c| json!({"what": c.what, "why": c.why, "place": place(&c.place, sources), "times": c.times}))
                    .collect();
                let value = json!({
                    "on": self.effects.has(effect),
                    "strategy": effect.is_strategy(),
                    "causes": causes,
                });
                (effect.word().to_owned(), value)
            })
            .collect();
        let hints = self
            .hints
            .iter()
            .map(|(hint, at)| json!({"hint": hint, "place": place(at, sources)}));
        let cameras: Vec<&str> = self.scene.cameras.iter().map(|c| c.name.as_str()).collect();
        let size = self.measure();
        let [pruned, saved] = self.pruned_json(sources);
        json!({
            "version": 2,
            "scene": self.name,
            "width": self.size[0],
            "height": self.size[1],
            "effects": effects,
            "prune": self.pruned.is_some(),
            "pruned": pruned,
            "saved": saved,
            "objects": size.objects,
            "triangles": size.triangles,
            "mesh_bytes": size.mesh_bytes,
            "lights": size.lights,
            "images": size.images,
            "image_bytes": size.image_bytes,
            "cameras": cameras,
            "files": self.opened,
            "hints": hints.collect::<Vec<_>>(),
        })
    }
}
