use super::super::synthetic;
use super::*;

#[test]
fn t() {
    let mut study = synthetic::study(25);
    println!("{}", recommend(&study).text);
    study.goal = Goal::Seconds(60.0);
    println!("{}", recommend(&study).text);
    study.goal = Goal::Error(0.0001);
    println!("{}", recommend(&study).text);
}
