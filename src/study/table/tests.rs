use super::super::synthetic;
use super::*;

#[test]
fn reports_for_looking_at() {
    let Some(folder) = std::env::var_os("PTS_CHARTS") else {
        return;
    };
    let folder = std::path::PathBuf::from(folder);
    let study = synthetic::study(25);
    std::fs::write(folder.join("all.md"), markdown(&study)).unwrap();
    std::fs::write(folder.join("all.csv"), csv(&study)).unwrap();
    std::fs::write(folder.join("all.json"), format!("{:#}", json(&study))).unwrap();
}
