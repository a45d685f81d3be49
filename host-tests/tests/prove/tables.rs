//! What is kept of the proofs is what is proved.

use firmware::scenes::SceneName;
use host_tests::commands::prove::{horizons, known_answers};
use host_tests::oracle::known_answers::table;

#[test]
fn the_readme_has_the_table_that_the_command_makes() {
    let table = horizons([SceneName::Figure7].iter(), || ()).expect("it can be proved").markdown_rows();
    let readme = include_str!("../../README.md");
    assert!(table.lines().all(|line| readme.lines().any(|other| other == line)), "{table}");
}

#[test]
fn the_known_answers_are_those_that_the_command_makes() {
    let scene: Vec<_> = table().expect("the file").into_iter().filter(|row| row.scene == "S11").collect();
    let kept = include_str!("../../data/known_answers.csv").lines().filter(|line| line.starts_with("S11,"));
    assert_eq!(known_answers(&scene).expect("it can be proved"), kept.collect::<Vec<_>>());
}
