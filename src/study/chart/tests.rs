use super::super::synthetic;
use super::*;

/// Writes the pictures for looking at, into the folder that `PTS_CHARTS` names.
#[test]
fn pictures_for_looking_at() {
    let Some(folder) = std::env::var_os("PTS_CHARTS") else {
        return;
    };
    let folder = std::path::PathBuf::from(folder);
    for (name, study) in [("one", 1), ("four", 4), ("all", 25)].map(|(name, n)| (name, synthetic::study(n))) {
        std::fs::write(folder.join(format!("{name}.svg")), svg(&study)).unwrap();
        std::fs::write(folder.join(format!("{name}.png")), png(&study).unwrap()).unwrap();
    }
}
