//! `alula check`.
use std::path::{Path, PathBuf};

use alula::case::{Angle, Case, abridged, write};
use alula::math::digits::short;
use alula::run;
use serde_json::{Value, json};

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Reads a case, builds its cloud, and tells what a run would meet and take.
pub(crate) fn check(args: &arguments::Check) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    if args.resolved {
        return output::data(&write(&case));
    }
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let refused = run::refusals(&case, &input);
    if !refused.is_empty() {
        return refused.iter().map(super::refuse).fold(Outcome::BadInput, |_, told| told);
    }
    if !case.has_gas() {
        return structure(&case, &input, args);
    }
    match run::inspect(&case, &input, None) {
        Ok(report) if args.json => {
            let mut fields = json!({ "file": args.case, "title": case.title });
            if let (Some(fields), Ok(Value::Object(known))) = (fields.as_object_mut(), serde_json::to_value(&report)) {
                fields.extend(known);
            }
            output::event("check", fields)
        }
        Ok(report) => {
            let title = format!("{}: no mistakes in `{}`\n", args.case.display(), case.title);
            let structure = report.structure.as_ref().map(describe_structure).unwrap_or_default();
            output::data(&abridged(&(title + &points(&case) + &super::cloud::describe(&report) + &structure)))
        }
        Err(problem) => super::refuse(&problem),
    }
}

/// The same of a structure alone.
fn structure(case: &Case, input: &Path, args: &arguments::Check) -> Outcome {
    let report = match run::inspect_structure(case, input) {
        Ok(report) => report,
        Err(problem) => return super::refuse(&problem),
    };
    if args.json {
        let mut fields = json!({ "file": args.case, "title": case.title });
        if let (Some(fields), Ok(Value::Object(known))) = (fields.as_object_mut(), serde_json::to_value(&report)) {
            fields.extend(known);
        }
        return output::event("check", fields);
    }
    report.warnings.iter().for_each(|w| output::note(&format!("warning: {w}")));
    let title = format!("{}: no mistakes in `{}`\n", args.case.display(), case.title);
    let least = if report.more_steps { " or more" } else { "" };
    let time = report.seconds.map(|s| format!("time           {}{least}\n", super::cloud::readable(s)));
    let cost = format!("memory         about {:.0} MB\n{}", report.bytes / 1e6, time.unwrap_or_default());
    output::data(&abridged(&(title + &describe_structure(&report) + &cost)))
}

/// A structure in words.
fn describe_structure(r: &run::SolidReport) -> String {
    let list = |all: Vec<String>| all.join(", ");
    let mut lines = vec![
        format!(
            "structure      {} particles with {:.1} neighbours each, {:.4e} apart",
            r.particles, r.neighbours, r.spacing[0]
        ),
        format!("bodies         {}", list(r.bodies.iter().map(|b| format!("`{b}`")).collect())),
        format!("gradients      changed by {:.1} % for the divergence theorem", 100.0 * r.correction),
        format!("mass           {:.6e}", r.mass),
        format!("wave speeds    {} m/s", list(r.wave_speeds.iter().map(|c| format!("{c:.1}")).collect())),
    ];
    for (k, held) in r.held.iter().enumerate() {
        lines.push(format!("support {}      holds {held} particles", k + 1));
    }
    for (k, area) in r.loaded.iter().enumerate() {
        lines.push(format!("load {}         acts on {area:.6e}", k + 1));
    }
    lines.push(format!("force          ({}) in all", list(r.force.iter().map(|f| format!("{f:.6e}")).collect())));
    if r.stable_step.is_finite() {
        lines.push(format!("explicit step  {:.3e} s at most", r.stable_step));
    }
    if let Some(steps) = r.steps {
        lines.push(match r.more_steps {
            true => format!("steps          {steps:.0} or more: they become shorter where the body is squeezed"),
            false => format!("steps          about {steps:.0}"),
        });
    }
    if let Some(factor) = r.seen_on {
        lines.push(format!(
            "looked at      bodies with {factor:.3} times the distance of particles; particles are counted without making them"
        ));
    }
    lines.join("\n") + "\n"
}

/// The points of a polar; nothing for a single flow.
fn points(case: &Case) -> String {
    let Some(polar) = &case.polar else { return String::new() };
    let or = |list: Vec<f64>, one: Option<f64>| if list.is_empty() { one.into_iter().collect() } else { list };
    let angles = or(polar.alpha.iter().map(Angle::degrees).collect(), Some(case.flow.alpha.degrees()));
    let machs = or(polar.mach.clone(), case.flow.mach);
    let (all, count) = (polar.len(), polar.angles());
    let at = if machs.is_empty() { String::new() } else { format!("; Mach {}", series(&machs)) };
    format!(
        "polar          {all} points: {count} angles at {} Mach numbers: {} deg{at}\n",
        all / count,
        series(&angles)
    )
}

/// The values of a list; of a long one the first and the last.
fn series(values: &[f64]) -> String {
    /// Most values that are written out.
    const MOST: usize = 6;
    let all = |part: &[f64]| part.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", ");
    match values {
        [first @ .., last] if values.len() > MOST => format!("{}, ..., {last}", all(&first[..2])),
        _ => all(values),
    }
}
