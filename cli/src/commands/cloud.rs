//! `alula cloud`.
use std::path::{Path, PathBuf};

use alula::run::{self, CloudReport, Places};

use super::run::name_of;
use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Builds the cloud of a case and writes it with its pictures and its diagnosis.
pub(crate) fn cloud(args: &arguments::Cloud) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    let name = format!("{}-cloud", name_of(&args.case));
    let out = args.out.clone().unwrap_or_else(|| super::default_folder(&name, args.force));
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let places = Places { input: input.clone(), out: out.clone() };
    if args.force
        && let Err(outcome) = super::tell_kept(run::set_aside_cloud(&case, &places), &out, false)
    {
        return outcome;
    }
    match run::inspect(&case, &input, Some(&out)) {
        Ok(report) => {
            let done = output::data(&describe(&report));
            output::message(&format!("written to {}\n", out.display()));
            done
        }
        Err(problem) => super::refuse(&problem),
    }
}

/// What is known of a cloud before a run.
pub(crate) fn describe(r: &CloudReport) -> String {
    let mut text = format!(
        "particles      {} ({} fluid, {} interface, {} outer)\nneighbours     {} least, {:.1} mean, {} most\nspacing        {:.3e} finest, {:.3e} coarsest\nconditioning   {:.1} worst (1 is best)\n",
        r.particles,
        r.fluid,
        r.interface,
        r.outer,
        r.neighbours.least,
        r.neighbours.mean,
        r.neighbours.most,
        r.spacing.finest,
        r.spacing.coarsest,
        r.worst_condition
    );
    for (what, value) in r.understood.lines() {
        text += &format!("{what:<15}{value}\n");
    }
    text += &match r.seen_on {
        None => format!("built in       {:.2} s\n", r.seconds),
        Some(factor) => format!(
            "looked at      a cloud with {factor:.3} times the spacing, built in {:.2} s; particles are counted on the background\n",
            r.seconds
        ),
    };
    let (memory, time) = match &r.least {
        Some(least) => (
            format!("{}, at most {}", megabytes(least), megabytes(&r.cost)),
            format!(
                "{} if the loads are known well enough then, at most {}",
                readable(least.seconds),
                readable(r.cost.seconds)
            ),
        ),
        None => (megabytes(&r.cost), readable(r.cost.seconds)),
    };
    let disk = format!("about {:.0} MB", r.cost.disk / 1e6);
    text += &format!("memory         {memory}\ntime           {time}\ndisk           {disk}\n");
    for (command, cost) in [("gaf", &r.gaf), ("flutter", &r.flutter)] {
        let told = cost.as_ref().map(|cost| format!("{}, {}", megabytes(cost), readable(cost.seconds)));
        text += &told.map_or_else(String::new, |told| format!("{:<14} {told}\n", format!("`alula {command}`")));
    }
    r.notes.iter().for_each(|n| text += &format!("note: {n}\n"));
    r.warnings.iter().for_each(|w| text += &format!("warning: {w}\n"));
    text
}

fn megabytes(cost: &run::Cost) -> String {
    format!("about {:.0} MB", cost.bytes / 1e6)
}

/// Longest time that is told in hours.
const LONGEST: f64 = 365.0 * 24.0 * 3600.0;

/// A time in words.
pub(super) fn readable(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("about {s:.1} s"),
        s if s < 90.0 => format!("about {s:.0} s"),
        s if s < 5400.0 => format!("about {:.0} min", s / 60.0),
        s if s < LONGEST => format!("about {:.1} h", s / 3600.0),
        _ => "more than a year".to_owned(),
    }
}
