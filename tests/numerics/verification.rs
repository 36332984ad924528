//! The shortest cases of `verification/`: every claim of theirs must hold.
use std::path::Path;

use alula::claims::ClaimRow;
use alula::run::Silent;
use alula::verification::{Selection, Walk};

/// Processor seconds of the cases that are judged here; `alula verify --fast` judges more.
const SECONDS: f64 = 40.0;

fn describe(r: &ClaimRow) -> String {
    format!("{} {}: {} against {} ({})", r.case, r.metric, r.value, r.reference, r.source)
}

#[test]
fn quick_claims_hold() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("verification");
    let mut walk = Walk::new(&root, &Selection { filters: Vec::new(), within: Some(SECONDS) }).unwrap();
    let mut failed = Vec::new();
    for k in 0..walk.len() {
        let rows = walk.judge(k, &mut Silent).unwrap();
        assert!(!rows.is_empty());
        failed.extend(rows.iter().filter(|r| !r.pass).map(describe));
    }
    assert!(failed.is_empty(), "{} claims fail:\n{}", failed.len(), failed.join("\n"));
}

#[test]
fn every_folder_is_in_order() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("verification");
    let walk = Walk::new(&root, &Selection::default()).unwrap();
    for folder in walk.cases() {
        let name = &folder.name;
        assert!(folder.path.join("README.md").is_file(), "{name} has no README.md");
        for claim in &folder.claims.claims {
            let file = claim.file.as_ref().map(|f| folder.path.join(f));
            assert!(file.is_none_or(|f| f.is_file()), "{name} names a missing curve");
            let there = |o: &String| root.join(o).is_dir() || folder.path.join(o).is_file();
            assert!(claim.other.as_ref().is_none_or(there), "{name} names a missing case");
        }
    }
}
