//! Drawing only a part of the node tree.

use super::Loader;
use super::node::Placed;
use super::variant::known;
use crate::diag::Diagnostic;
use glam::DAffine3;

impl Loader<'_> {
    /// Hides all but the subtree that the caller asked for, if it did. Returns the map that puts the node's own space in
    /// place of the scene's, where that was asked for too; `None` if there is no such node (reported).
    pub(super) fn keep_subtree(&mut self, placed: &mut [Placed]) -> Option<DAffine3> {
        let Some(wanted) = self.options.node.as_deref() else {
            return Some(DAffine3::IDENTITY);
        };
        let names: Vec<String> = placed.iter().map(|p| self.doc.name("nodes", p.index)).collect();
        let by_number = || {
            let index: usize = wanted.parse().ok()?;
            placed.iter().position(|p| p.index == index)
        };
        let Some(root) = names.iter().position(|n| n == wanted).or_else(by_number) else {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let d = Diagnostic::error("G0508", format!("there is no node \"{wanted}\" in the scene"));
            self.report.push("", d.hint(known("nodes", &names)));
            return None;
        };
        // Parents stand before their children.
        let mut is_inside = vec![false; placed.len()];
        for i in 0..placed.len() {
            let parent = placed[i].parent.and_then(|p| is_inside.get(p).copied());
            is_inside[i] = i == root || parent == Some(true);
            placed[i].visible &= is_inside[i];
        }
        if !self.options.node_is_origin {
            return Some(DAffine3::IDENTITY);
        }
        let back = placed[root].world.inverse();
        if !back.is_finite() {
            let message = format!("node \"{wanted}\" has no space of its own: its transform is singular");
            self.report
                .error("G0508", &format!("nodes[{}]", placed[root].index), message);
            return None;
        }
        Some(back)
    }

    /// Moves everything that was loaded, motions included.
    pub(super) fn put_origin(&mut self, origin: DAffine3) {
        if origin == DAffine3::IDENTITY {
            return;
        }
        for object in &mut self.scene.objects {
            object.transform = origin * object.transform; // its motion is in its own space
        }
        let lights = std::mem::take(&mut self.scene.lights);
        self.scene.lights = lights.into_iter().map(|l| l.transformed(origin)).collect();
        let cameras = std::mem::take(&mut self.scene.cameras);
        self.scene.cameras = cameras.into_iter().map(|c| c.transformed(&origin)).collect();
    }
}
