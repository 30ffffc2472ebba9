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
                    "time_share": self.measured.as_ref().and_then(|m| m.share(effect)).map(|(s, e)| json!([s, e])),
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
            "kernel": size.kernel.word(),
            "solids": size.solids,
            "meeting_solids": size.meetings,
            "media": size.media,
            "max_depth": self.scene.defaults.max_depth,
            "forecast": self.measured.as_ref().and_then(|m| m.forecast.as_ref()).map(|f| {
                json!({"error": f.goal, "seconds": f.seconds})
            }),
            "images": size.images,
            "image_bytes": size.image_bytes,
            "cameras": cameras,
            "names": self.names.json(),
            "files": self.opened,
            "hints": hints.collect::<Vec<_>>(),
        })
    }
}
