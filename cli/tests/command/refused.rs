//! What the commands refuse before they compute anything, in one table: `check` refuses all of it, in the same words.
use std::path::Path;
use std::process::{Command, Output};

/// A case that a command refuses.
struct Refused {
    command: &'static str,
    /// Parts of the case file.
    case: &'static [&'static str],
    /// Names and texts of files beside it.
    files: &'static [(&'static str, &'static str)],
    /// What both commands say.
    told: &'static str,
}

const SECTION: &str = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.05\nfar_field = 5\n";
const AIR: &str = "[flow]\nmach = 0.5\npressure = \"1 bar\"\ntemperature = \"15 degC\"\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.05\n\
                   far_field = 5\n";
const SPRINGS: &str = "[structure]\nelastic_axis = -0.4\nmass_ratio = 60\nx_alpha = 0.2\nr_alpha2 = 0.25\nfrequency_ratio = 0.5\n\
                       reduced_speed = 2\n";
const LOOSE: &str = "[structure]\nelastic_axis = -0.4\nmass_ratio = 60\nx_alpha = 0.2\nr_alpha2 = 0.25\nstiffness = { plunge = 0, pitch = 0 }\n";
const BENDING: &str = "[structure]\nmodel = \"modal\"\n[[structure.mode]]\nname = \"bending\"\nfile = \"bending.csv\"\nmass = 20\n\
                       reduced_frequency = 0.1\n";
const FORCES: &str =
    "[gaf]\nreduced_frequencies = 0.1\nmodes = []\n[[gaf.mode]]\nname = \"bending\"\nfile = \"bending.csv\"\n";
const TABLE: &[(&str, &str)] = &[("bending.csv", "x,y,dx,dy\n0,0,0,1\n0.5,0,0,1\n1,0,0,1\n")];
const HEADLESS: &[(&str, &str)] = &[("bending.csv", "x,y,u,v\n0,0,0,1\n0.5,0,0,1\n1,0,0,1\n")];
const STILL: &[(&str, &str)] = &[("bending.csv", "x,y,dx,dy\n0,0,0,0\n1,0,0,0\n")];
const ELSEWHERE: &[(&str, &str)] = &[("bending.csv", "x,y,dx,dy\n50,0,0,1\n50.5,0,0,1\n51,0,0,1\n")];
const NONE: &[(&str, &str)] = &[];

const fn refused(
    command: &'static str,
    case: &'static [&'static str],
    files: &'static [(&'static str, &'static str)],
    told: &'static str,
) -> Refused {
    Refused { command, case, files, told }
}

/// All of them.
const ALL: &[Refused] = &[
    refused("run", &["[flow]\nmach = fast\n"], NONE, "not TOML"),
    refused("run", &["[flow]\nmach = 0.5\n[[body]]\nairfoil = \"section.dat\"\n"], NONE, "no file `section.dat`"),
    refused(
        "run",
        &["[flow]\nmach = 0.5\n[[body]]\nairfoil = \"section.dat\"\n"],
        &[("section.dat", "nothing\nof\nnumbers\n")],
        "section.dat",
    ),
    refused("run", &["[flow]\nmach = 0.5\n[[body]]\nnaca = \"0099\"\n"], NONE, "99 % thick"),
    refused("run", &["[flow]\nmach = 0.5\nalpha = \"200 deg\"\n[[body]]\nnaca = \"0012\"\n"], NONE, "is 200 deg"),
    refused("run", &["[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 5\n"], NONE, "only 1 long"),
    refused("run", &[SECTION, "[[compare]]\nfile = \"cp.csv\"\n"], &[("cp.csv", "x,cp\n0,1\n")], "no reference curve"),
    refused(
        "run",
        &[SECTION, "[motion]\nparticles = \"lagrangian\"\n[scheme]\nconservative = true\n[time.explicit]\nuntil = 1\n"],
        NONE,
        "conservative coefficients of particles that travel",
    ),
    refused("run", &[SECTION, SPRINGS, "[time.explicit]\nuntil = 1\n"], NONE, "springs with explicit steps"),
    refused("run", &[SECTION, LOOSE], NONE, "no spring holds the body `body-1`"),
    refused("run", &[SECTION, "[scheme]\nlow_mach = true\nconservative = false\n"], NONE, "slow flow without"),
    refused(
        "run",
        &[SECTION, "[time]\nharmonics = 2\n[motion]\nperiod = 3\nformula = { y = \"0.1*sin(omega*t)*exp(-t/9)\" }\n"],
        NONE,
        "does not repeat",
    ),
    refused(
        "run",
        &[SECTION, "[time]\nharmonics = 1\n[motion]\nparticles = \"deforming\"\nperiod = 1e-9\nplunge = 0.01\n"],
        NONE,
        "is so short",
    ),
    refused(
        "run",
        &[
            SECTION,
            "[time]\nharmonics = 1\n[motion]\nparticles = \"deforming\"\nperiod = 9\nmode = [{ file = \"bending.csv\", amplitude = 0.1 }]\n",
        ],
        ELSEWHERE,
        "the points of mode `bending.csv` reach from",
    ),
    refused(
        "run",
        &["[flow]\nmach = 0.3\n[[body]]\nname = \"front\"\ncircle = { radius = 0.5 }\n[[body]]\nname = \"rear\"\n\
             circle = { radius = 0.5 }\ntranslate = [2.0, 0.0]\n[body.motion]\ntranslation = [-0.3, 0.0]\n[cloud]\nspacing = 0.1\n\
             domain = { min = [-3.2, -3.2], max = [6.4, 3.2] }\n[time.dual]\nstep = 0.1\nuntil = 5\n"],
        NONE,
        "hint",
    ),
    refused("run", &[SECTION, BENDING], NONE, "no file `bending.csv`"),
    refused("run", &[SECTION, BENDING], HEADLESS, "`dx` and `dy` are missing"),
    refused("flutter", &[SECTION, BENDING, "[flutter]\n"], NONE, "no file `bending.csv`"),
    refused("flutter", &[SECTION, BENDING, "[flutter]\n"], HEADLESS, "`dx` and `dy` are missing"),
    refused("flutter", &[SECTION, BENDING, "[flutter]\n"], STILL, "nothing moves"),
    refused("flutter", &[SECTION, "[flutter]\n"], NONE, "flutter without a `[structure]`"),
    refused("flutter", &[SECTION, SPRINGS, "[flutter]\nmatch = \"altitude\"\n"], NONE, "for a stream without units"),
    refused(
        "flutter",
        &[SECTION, SPRINGS, "[flutter]\nmach = [0.4, 0.5]\nmatch = \"density\"\n"],
        NONE,
        "go with the speed",
    ),
    refused("flutter", &[AIR, SPRINGS, "[flutter]\nmatch = \"altitude\"\n"], NONE, "go with the speed"),
    refused(
        "flutter",
        &[
            "[flow]\nvelocity = \"170 m/s\"\npressure = \"1 bar\"\ntemperature = \"15 degC\"\n[[body]]\nnaca = \"0012\"\n[cloud]\n\
             spacing = 0.05\nfar_field = 5\n",
            SPRINGS,
            "[flutter]\n",
        ],
        NONE,
        "given by `velocity`",
    ),
    refused(
        "flutter",
        &["[flow]\nmach = 0.5\nalpha = [0, 1]\n[[body]]\nnaca = \"0012\"\n", SPRINGS, "[flutter]\n"],
        NONE,
        "hint",
    ),
    refused(
        "flutter",
        &[SECTION, SPRINGS, "[lco]\namplitude = [\"1 deg\", \"2 deg\"]\n"],
        NONE,
        "`[lco]` without `[flutter]`",
    ),
    refused(
        "flutter",
        &[SECTION, SPRINGS, "[flutter]\n[lco]\ncoordinate = \"flap\"\namplitude = [\"1 deg\", \"2 deg\"]\n"],
        NONE,
        "`lco.coordinate` is `flap`",
    ),
    refused(
        "flutter",
        &[SECTION, SPRINGS, "[flutter]\n[lco]\ndisplacement = [0.1, 0.2]\n"],
        NONE,
        "`pitch` is an angle",
    ),
    refused("flutter", &[SECTION, SPRINGS, "[flutter]\ntrim = true\n", "[cloud.wake]\n"], NONE, "hint"),
    refused("gaf", &[SECTION, FORCES], NONE, "no file `bending.csv`"),
    refused("gaf", &[SECTION, FORCES], HEADLESS, "`dx` and `dy` are missing"),
    refused("gaf", &[SECTION, FORCES, "amplitude = 0.01\n"], HEADLESS, "`dx` and `dy` are missing"),
    refused("gaf", &[SECTION, FORCES, "amplitude = 0.01\n"], ELSEWHERE, "the points of mode `bending.csv` reach from"),
    refused(
        "gaf",
        &[SECTION, "[gaf]\nreduced_frequencies = 1e9\npivot = [0.25, 0]\nmethod = \"balance\"\n"],
        NONE,
        "is so short",
    ),
    refused("gaf", &[SECTION, "[gaf]\nreduced_frequencies = 0.1\n"], NONE, "pitches about no point"),
    refused(
        "gaf",
        &[SECTION, "[gaf]\nreduced_frequencies = 0.1\npivot = [0.25, 0, 0]\n"],
        NONE,
        "3 coordinates in a 2-D case",
    ),
];

fn alula(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_alula")).args(args).current_dir(folder).output().unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn what_a_command_refuses_check_refuses_in_the_same_words() {
    let mut wrong = Vec::new();
    for (i, refused) in ALL.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("case.toml"), refused.case.concat()).unwrap();
        refused.files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
        for args in [&[refused.command, "case.toml", "--out", "out"][..], &["check", "case.toml"]] {
            let output = alula(folder.path(), args);
            let text = told(&output);
            if output.status.code() != Some(2) || !text.contains(refused.told) {
                wrong.push(format!(
                    "case {i}, `{}`, {:?}: no `{}` in {text}",
                    args[0],
                    output.status.code(),
                    refused.told
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn tables_that_make_sense_are_not_refused() {
    let folder = tempfile::tempdir().unwrap();
    TABLE.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    let case = [SECTION, BENDING, "[flutter]\n", FORCES].concat();
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    let output = alula(folder.path(), &["check", "case.toml"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    for word in [
        "structure      `body-1` with bending",
        "generalised masses: bending 20",
        "flutter        Mach 0.5",
        "gaf            modes bending",
    ] {
        assert!(text.contains(word), "no `{word}` in {text}");
    }
}

#[test]
fn files_that_are_not_there_are_told_with_line_and_key_beside_all_other_mistakes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("torsion.csv"), "x,y,dx,dy\n0,0,0,1\n").unwrap();
    let case = [&BENDING.replace("bending.csv", "torsoin.csv"), "[flutter]\nmatch = \"height\"\n", SECTION].concat();
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    for command in ["check", "flutter"] {
        let text = told(&alula(folder.path(), &[command, "case.toml"]));
        for word in
            ["case.toml:5:8", "`structure[0].mode[0].file`", "did you mean `torsion.csv`?", "`height`", "2 mistakes"]
        {
            assert!(text.contains(word), "no `{word}` in {text}");
        }
    }
}

#[test]
fn all_that_keeps_a_case_from_being_computed_is_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    HEADLESS.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    let more = "[scheme]\nlow_mach = true\nconservative = false\n[flutter]\nmatch = \"altitude\"\n";
    std::fs::write(folder.path().join("case.toml"), [SECTION, BENDING, more].concat()).unwrap();
    let output = alula(folder.path(), &["check", "case.toml"]);
    let text = told(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    for word in ["`dx` and `dy` are missing", "slow flow without", "for a stream without units"] {
        assert!(text.contains(word), "no `{word}` in {text}");
    }
}

#[test]
fn numbers_of_hundreds_of_digits_are_told_in_powers_of_ten() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        "[flow]\nmach = 0.5\nalpha = 1e300\n[[body]]\nnaca = \"0012\"\n",
        "[flow]\nmach = 0.5\nreynolds = 1e-300\n[[body]]\nnaca = \"0012\"\n",
        "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 1e300\n",
        "[[body]]\nbox = { size = [1, 0.2] }\nscale = 1e200\n[body.solid]\nmaterial = \"steel 4340\"\n[time.modes]\n",
    ];
    for case in cases {
        std::fs::write(folder.path().join("case.toml"), case).unwrap();
        for words in [&["check", "case.toml"][..], &["check", "case.toml", "--json"]] {
            let output =
                Command::new(env!("CARGO_BIN_EXE_alula")).args(words).current_dir(folder.path()).output().unwrap();
            assert_eq!(output.status.code(), Some(2), "{case}");
            let told = [output.stdout, output.stderr].concat();
            let longest = told.split(|b| !b.is_ascii_digit()).map(<[u8]>::len).max();
            assert!(longest < Some(30), "{case}: {}", String::from_utf8_lossy(&told));
        }
    }
}
