//! Forces that a former run left: `flutter.json` of `alula flutter`, or `gaf.json` of `alula gaf`.
use num_complex::Complex64;

use super::held::Held;
use crate::problem::RunError;
use crate::record::flutter::{Boundary, FlutterAt, Mark};
use crate::record::gaf::{GafFile, SquareMatrix};

/// Part by which Mach numbers and chords may differ, and angles in degrees.
const SAME: f64 = 1e-6;

/// All that a file has.
pub(crate) struct Stored {
    file: String,
    all: Vec<FlutterAt>,
}

/// Forces on the coordinates of a case, and what is left of the residual of their equations.
pub(super) struct Samples {
    /// Angular frequencies in units of the solver, and forces by rows.
    pub(super) all: Vec<(f64, Vec<Complex64>)>,
    /// Greatest relative residual.
    pub(super) residual: f64,
}

impl Stored {
    /// From the text of a file of this name.
    pub(crate) fn parse(file: &str, text: &str) -> Result<Self, RunError> {
        let file = file.to_owned();
        let wrong = |what: String| unreadable(&file, &what);
        let value: serde_json::Value = serde_json::from_str(text).map_err(|e| wrong(format!("is no JSON: {e}")))?;
        let all = if value.get("flutter").is_some() {
            serde_json::from_value::<Boundary>(value).map(|found| found.flutter)
        } else {
            serde_json::from_value::<GafFile>(value).map(|gaf| vec![of_gaf(gaf)])
        };
        let all = all.map_err(|e| wrong(format!("has no forces of this version: {e}")))?;
        let whole = |at: &FlutterAt| {
            let n = at.coordinates.len();
            let square = at.forces.iter().all(|f| f.len() == n * n && f.iter().flatten().all(|x| x.is_finite()));
            let rising = at.reduced_frequencies.windows(2).all(|w| w[0] < w[1]);
            square && rising && at.forces.len() == at.reduced_frequencies.len() && at.moved.len() == n && n > 0
        };
        match all.iter().find(|at| !whole(at) || at.forces.is_empty()) {
            Some(at) => Err(wrong(format!("has broken matrices at Mach {}", at.mach))),
            None => Ok(Self { file, all }),
        }
    }

    /// Name of the file.
    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Mach numbers, in the order of the file.
    pub(super) fn machs(&self) -> Vec<f64> {
        self.all.iter().map(|at| at.mach).collect()
    }

    /// Forces at a Mach number and an angle of attack on the coordinates of `held`.
    pub(super) fn samples(&self, mach: f64, alpha_deg: f64, held: &Held) -> Result<Samples, RunError> {
        let Some(at) = self.all.iter().find(|at| (at.mach - mach).abs() <= SAME * mach) else {
            let known: Vec<String> = self.machs().iter().map(|m| format!("{m}")).collect();
            let what = format!("has no forces at Mach {mach}, but at {}", known.join(", "));
            return Err(unfit(&self.file, &what, "give these in `flutter.mach`, or run without `--forces`"));
        };
        let fresh = "run without `--forces` to compute them";
        if (at.alpha_deg - alpha_deg).abs() > SAME {
            let what = format!("has forces at {} degrees, the case has {alpha_deg}", at.alpha_deg);
            return Err(unfit(&self.file, &what, fresh));
        }
        if (at.chord - held.chord).abs() > SAME * held.chord {
            let what = format!("has forces on a chord of {}, that of the case is {}", at.chord, held.chord);
            return Err(unfit(&self.file, &what, fresh));
        }
        let mut places = Vec::new();
        for (name, mark) in held.names.iter().zip(&held.marks) {
            let Some(place) = at.coordinates.iter().position(|c| c == name) else {
                let what = format!("has no coordinate `{name}`, but `{}`", at.coordinates.join("`, `"));
                return Err(unfit(&self.file, &what, "leave it out of the structure, or run without `--forces`"));
            };
            if at.moved[place].contradicts(mark, held.chord) {
                let what = format!("has forces of another `{name}`: its pivot or its shape has changed");
                return Err(unfit(&self.file, &what, fresh));
            }
            places.push(place);
        }
        let n = at.coordinates.len();
        let chosen = |f: &Vec<[f64; 2]>| {
            let entry = |i: &usize, j: &usize| Complex64::new(f[i * n + j][0], f[i * n + j][1]);
            places.iter().flat_map(|i| places.iter().map(move |j| entry(i, j))).collect::<Vec<_>>()
        };
        let omega = |k: &f64| k * at.mach / at.semichord;
        let all = at.reduced_frequencies.iter().map(omega).zip(at.forces.iter().map(chosen)).collect();
        Ok(Samples { all, residual: at.residual })
    }
}

/// The forces of a table of `alula gaf` in units of the solver: plunge is counted in lengths of the reduced frequency there.
fn of_gaf(mut gaf: GafFile) -> FlutterAt {
    gaf.matrices.sort_by(|a, b| a.k.total_cmp(&b.k));
    let length = |mode: &String| if mode == "plunge" { gaf.reduced_length } else { 1.0 };
    let pressure = 0.5 * gaf.mach * gaf.mach * gaf.area * gaf.chord;
    let forces = |square: &SquareMatrix| {
        let row = |(row, mode): (&Vec<[f64; 2]>, &String)| {
            let scaled = |(q, other): (&[f64; 2], &String)| q.map(|x| x * pressure / (length(mode) * length(other)));
            row.iter().zip(&gaf.modes).map(scaled).collect::<Vec<_>>()
        };
        square.q.iter().zip(&gaf.modes).flat_map(row).collect()
    };
    let rigid = |mode: &String| mode == "plunge" || mode == "pitch";
    let mark = |mode: &String| Mark { pivot: gaf.pivot.clone().filter(|_| rigid(mode)), shape: None };
    FlutterAt {
        mach: gaf.mach,
        alpha_deg: gaf.alpha_deg,
        chord: gaf.chord,
        semichord: gaf.reduced_length,
        moved: gaf.modes.iter().map(mark).collect(),
        reduced_frequencies: gaf.matrices.iter().map(|m| m.k).collect(),
        forces: gaf.matrices.iter().map(forces).collect(),
        coordinates: gaf.modes,
        residual: gaf.columns.iter().filter_map(|c| c.solved).map(|s| s.left).fold(0.0, f64::max),
        ..FlutterAt::default()
    }
}

/// Why a file has no forces.
pub(crate) fn unreadable(file: &str, what: &str) -> RunError {
    unfit(file, what, "give `flutter.json` of `alula flutter`, or `gaf.json` of `alula gaf`")
}

fn unfit(file: &str, what: &str, hint: &str) -> RunError {
    RunError::Folder { what: format!("`{file}` {what}"), hint: hint.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::Matrices;

    fn held(names: &[&str]) -> Held {
        let n = names.len() * names.len();
        let matrices = Matrices { mass: vec![0.0; n], damping: vec![0.0; n], stiffness: vec![0.0; n] };
        let mark = Mark { pivot: Some(vec![0.25, 0.0]), shape: None };
        let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
        Held {
            chord: 1.0,
            marks: vec![mark; names.len()],
            names,
            matrices,
            springs: Vec::new(),
            translations: Vec::new(),
        }
    }

    #[test]
    fn matrices_of_gaf_become_forces_on_coordinates() {
        let text = r#"{"mach": 0.5, "alpha_deg": 1, "chord": 1, "area": 1, "reduced_length": 0.5, "pivot": [0.25, 0],
            "modes": ["plunge", "pitch"], "matrices": [{"k": 0.2, "q": [[[1, 2], [3, 4]], [[5, 6], [7, 8]]]},
            {"k": 0.1, "q": [[[1, 0], [0, 0]], [[0, 0], [0, 0]]]}]}"#;
        let stored = Stored::parse("gaf.json", text).unwrap();
        let found = stored.samples(0.5, 1.0, &held(&["plunge", "pitch"])).unwrap();
        // k = ω L/U
        assert!((found.all[0].0 - 0.1).abs() < 1e-15 && (found.all[1].0 - 0.2).abs() < 1e-15);
        let second = &found.all[1].1;
        let q = 0.125;
        let expected = [4.0 * q, 2.0 * q * 3.0, 2.0 * q * 5.0, 7.0 * q];
        assert!(second.iter().zip(expected).all(|(f, e)| (f.re - e).abs() < 1e-15), "{second:?}");
        // one of the coordinates alone
        let alone = stored.samples(0.5, 1.0, &held(&["pitch"])).unwrap();
        assert_eq!(alone.all[1].1, [second[3]]);
        let refused = |mach: f64, alpha: f64, held: &Held| {
            stored.samples(mach, alpha, held).err().map(|e| e.to_string()).unwrap_or_default()
        };
        assert!(refused(0.6, 1.0, &held(&["pitch"])).contains("no forces at Mach 0.6, but at 0.5"));
        assert!(refused(0.5, 0.0, &held(&["pitch"])).contains("at 1 degrees"));
        assert!(refused(0.5, 1.0, &held(&["flap"])).contains("no coordinate `flap`, but `plunge`, `pitch`"));
        let mut other = held(&["pitch"]);
        other.marks[0].pivot = Some(vec![0.4, 0.0]);
        assert!(refused(0.5, 1.0, &other).contains("another `pitch`"));
        other.chord = 2.0;
        assert!(refused(0.5, 1.0, &other).contains("chord of 1, that of the case is 2"));
        let other = Stored::parse("gaf.json", "{\"modes\": []}");
        assert!(other.err().is_some_and(|e| e.to_string().contains("no forces of this version")));
    }
}
