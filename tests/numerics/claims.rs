//! The walk through a folder of cases with claims: what is judged, what is kept between two walks, what ends one before it begins.
use std::fs;
use std::path::Path;

use alula::claims::ClaimRow;
use alula::run::{Monitor, Silent, Tick};
use alula::verification::{Keep, Selection, Walk, WalkError, times};

const CASE: &str = "title = \"still\"\ndimension = 2\n[flow]\nmach = 0.5\n[cloud]\nspacing = 0.25\n\
    domain = { min = [0.0, 0.0], max = [1.0, 1.0] }\n[time.explicit]\nuntil = 0.1\ncfl = 0.5\nmethod = \"ssprk3\"\n";

fn write(root: &Path, name: &str, claims: &str) {
    let folder = root.join(name);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("case.toml"), CASE).unwrap();
    fs::write(folder.join("claim.toml"), claims).unwrap();
}

#[test]
fn claims_are_judged_and_reasons_given() {
    let root = tempfile::tempdir().unwrap();
    let claim = |metric: &str, bound: f64| {
        format!("[[claim]]\nmetric = \"{metric}\"\nkind = \"at_most\"\nreference = {bound}\nsource = \"s\"\n")
    };
    let three = claim("free_stream_deviation", 1e-12) + &claim("particles", 1.0) + &claim("shock_upper", 1.0);
    write(root.path(), "a", &three);
    write(root.path(), "b", &format!("cpu_seconds = 2\n{}", claim("cp_max_difference", 1.0)));
    write(root.path(), "c", &format!("cpu_seconds = 1\n{}", claim("particles", 1.0)));
    write(root.path(), "d", &format!("cpu_seconds = 3\n{}", claim("particles", 1.0)));
    let named = |name: &str| Selection { filters: vec![name.into()], within: None };
    let mut walk = Walk::new(root.path(), &named("a")).unwrap();
    assert_eq!(walk.len(), 1);
    let rows = walk.judge(0, &mut Silent).unwrap();
    assert_eq!(rows.iter().map(|r| r.pass).collect::<Vec<_>>(), [true, false, false], "{rows:?}");
    assert!(rows[2].value.is_nan() && rows[2].source.starts_with("no value: "), "{rows:?}");
    let chosen = |filters: &[&str], within: Option<f64>| {
        let filters = filters.iter().map(|&text| text.to_owned()).collect();
        let walk = Walk::new(root.path(), &Selection { filters, within });
        walk.map(|walk| walk.cases().map(|f| f.name.clone()).collect::<Vec<_>>())
    };
    assert_eq!(chosen(&["d", "a"], None).unwrap(), ["a", "d"]);
    assert_eq!(chosen(&[], Some(3.5)).unwrap(), ["b", "c"]);
    assert_eq!(chosen(&["b", "a"], Some(3.5)).unwrap(), ["b"]);
    assert!(chosen(&["d"], Some(3.5)).unwrap_err().to_string().contains("among the shortest"));
    assert!(chosen(&["a", "wing"], None).unwrap_err().to_string().contains("no case is called like `wing`"));
    assert!(!Walk::new(root.path(), &named("b")).unwrap().judge(0, &mut Silent).unwrap()[0].pass);
}

/// What a walk finds of the case `a` and, of all that it needed, what was kept before.
fn kept(root: &Path, keep: &Keep) -> (Vec<ClaimRow>, Vec<bool>) {
    let mut walk = Walk::new(root, &Selection::default()).unwrap();
    walk.keep(keep.clone()).unwrap();
    let rows = walk.judge(0, &mut Silent).unwrap();
    let kept = walk.spent().map(|s| s.kept).collect();
    (rows, kept)
}

#[test]
fn what_is_kept_is_not_computed_again() {
    let root = tempfile::tempdir().unwrap();
    let claim = |metric: &str, bound: f64| {
        format!("[[claim]]\nmetric = \"{metric}\"\nkind = \"at_most\"\nreference = {bound}\nsource = \"s\"\n")
    };
    let study = "[study]\nspacings = [0.25, 0.125]\n";
    let claims =
        study.to_owned() + &claim("free_stream_deviation", 1e-12) + &claim("order", 9.0) + &claim("particles", 1.0);
    write(root.path(), "a", &claims);
    let folder = tempfile::tempdir().unwrap();
    let of = |build: &str| Keep { folder: folder.path().join("deep"), build: build.into(), again: false };
    let (first, fresh) = kept(root.path(), &of("one"));
    assert_eq!(fresh.iter().filter(|kept| **kept).count(), 0);
    let same = |a: &[ClaimRow], b: &[ClaimRow]| a.iter().zip(b).all(|(a, b)| a.value.to_bits() == b.value.to_bits());
    let (second, known) = kept(root.path(), &of("one"));
    assert!(same(&first, &second) && known.iter().all(|kept| *kept) && known.len() == fresh.len(), "{second:?}");
    // another claim of the same case is judged on what is there
    write(root.path(), "a", &claims.replace("particles\"\nkind = \"at_most", "particles\"\nkind = \"at_least"));
    let (third, known) = kept(root.path(), &of("one"));
    assert!(third[2].pass != first[2].pass && known.iter().all(|kept| *kept));
    // another case, another build and a wish for it compute
    let again = Keep { again: true, ..of("one") };
    assert!(kept(root.path(), &again).1.iter().all(|kept| !kept));
    assert!(kept(root.path(), &of("two")).1.iter().all(|kept| !kept));
    assert!(kept(root.path(), &of("one")).1.iter().all(|kept| *kept));
    let case = root.path().join("a/case.toml");
    fs::write(&case, CASE.replace("mach = 0.5", "mach = 0.6")).unwrap();
    assert!(kept(root.path(), &of("one")).1.iter().all(|kept| !kept));
    let taken = &times(&of("one").folder)["a"];
    assert!(taken.build == "one" && taken.wall_seconds > 0.0);
    // the oldest build makes room, what else is there stays
    fs::create_dir(of("one").folder.join("mine")).unwrap();
    for build in ["three", "four"] {
        kept(root.path(), &of(build));
    }
    let there = |name: &str| of("one").folder.join(name).exists();
    assert!(!there("build-two") || !there("build-one"));
    assert!(there("build-four") && there("build-three") && there("mine"));
}

#[test]
fn a_file_that_a_case_names_is_part_of_it() {
    let root = tempfile::tempdir().unwrap();
    let claim = "[[claim]]\nmetric = \"cd\"\nkind = \"at_most\"\nreference = 9\nsource = \"s\"\n";
    write(root.path(), "a", claim);
    let diamond = |half: f64| format!("1 0\n0.5 {half}\n0 0\n0.5 {}\n1 0\n", -half);
    let write = |name: &str, text: &str| fs::write(root.path().join("a").join(name), text).unwrap();
    write(
        "case.toml",
        "[flow]\nmach = 2\n[[body]]\nairfoil = \"diamond.dat\"\n[cloud]\nspacing = 0.125\nfar_field = 2\n[time.steady]\norders = 2\n",
    );
    write("diamond.dat", &diamond(0.1));
    let folder = tempfile::tempdir().unwrap();
    let keep = Keep { folder: folder.path().to_owned(), build: "b".into(), again: false };
    let (first, _) = kept(root.path(), &keep);
    assert!(first[0].value > 0.0, "{first:?}");
    let (second, known) = kept(root.path(), &keep);
    assert_eq!((second[0].value, &known[..]), (first[0].value, &[true][..]));
    write("diamond.dat", &diamond(0.12));
    let (third, known) = kept(root.path(), &keep);
    assert!(third[0].value > first[0].value && known == [false], "{third:?}");
}

/// Says stop as soon as it is asked.
struct Impatient;

impl Monitor for Impatient {
    fn tick(&mut self, _: &Tick) {}
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        true
    }
}

#[test]
fn a_run_that_was_stopped_is_not_kept() {
    let root = tempfile::tempdir().unwrap();
    write(root.path(), "a", "[[claim]]\nmetric = \"particles\"\nkind = \"at_least\"\nreference = 1\nsource = \"s\"\n");
    let folder = tempfile::tempdir().unwrap();
    let keep = Keep { folder: folder.path().to_owned(), build: "b".into(), again: false };
    let mut walk = Walk::new(root.path(), &Selection::default()).unwrap();
    walk.keep(keep.clone()).unwrap();
    assert!(walk.judge(0, &mut Impatient).is_none());
    let (rows, known) = kept(root.path(), &keep);
    assert!(rows[0].pass && known == [false]);
}

/// Slow flow about a sphere: Cp = 1 − 9/4 sin²θ, with sin²θ = 4 (x/c) (1 − x/c) in the plane through its middle.
#[test]
fn sections_are_compared_where_their_reference_has_points() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("sphere");
    fs::create_dir_all(&folder).unwrap();
    let case = "[flow]\nmach = 0.1\n[[body]]\nsphere = { radius = 0.5 }\n[cloud]\nspacing = 0.125\n\
                curvature_levels = 0\nfar_field = 4\n[time.steady]\norders = 3\n";
    fs::write(folder.join("case.toml"), case).unwrap();
    let parts = [0.05, 0.2, 0.35, 0.5];
    let rows = ["upper", "lower"]
        .iter()
        .flat_map(|side| parts.map(|x| format!("0,{side},{x},{}\n", 1.0 - 9.0 * x * (1.0 - x))));
    fs::write(folder.join("cp.csv"), format!("y,surface,x_c,Cp\n{}", rows.collect::<String>())).unwrap();
    let claim = |more: &str| {
        format!(
            "[[claim]]\nmetric = \"section_cp_rms\"\nfile = \"cp.csv\"\nkind = \"at_most\"\nreference = 0.1\nsource = \"s\"\n{more}"
        )
    };
    let outside = "region = { min = [-1, 2], max = [1, 3] }\n";
    fs::write(folder.join("claim.toml"), claim("") + &claim(outside)).unwrap();
    let rows = Walk::new(root.path(), &Selection::default()).unwrap().judge(0, &mut Silent).unwrap();
    assert!(rows[0].pass && rows[0].value > 0.0, "{rows:?}");
    assert!(rows[1].value.is_nan(), "{rows:?}");
}

#[test]
fn bad_folders_end_the_walk_before_it_begins() {
    let root = tempfile::tempdir().unwrap();
    assert!(matches!(Walk::new(&root.path().join("none"), &Selection::default()), Err(WalkError::Unreadable { .. })));
    assert!(matches!(Walk::new(root.path(), &Selection::default()), Err(WalkError::NoCase { .. })));
    write(root.path(), "a", "");
    assert!(matches!(Walk::new(root.path(), &Selection::default()), Err(WalkError::Mistakes { .. })));
}
