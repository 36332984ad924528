//! `alula run`.
use std::path::{Path, PathBuf};

use alula::math::digits::{fixed, short};
use alula::observe::convergence::{Convergence, FamilyEnd};
use alula::observe::error_bars::{self, Bar, ErrorBars};
use alula::observe::loads::Coefficients;
use alula::observe::strips::Span;
use alula::run::{self, Outcome as Ended, PeriodicLoads, Places, PolarPoint, RunError, SolidSummary, Summary};
use serde_json::json;

use crate::arguments::{self, Verbosity};
use crate::interrupt::Interrupt;
use crate::outcome::Outcome;
use crate::output;
use crate::watch::Watch;

/// Computes a case.
pub(crate) fn run(args: &arguments::Run) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    let out = args.out.clone().unwrap_or_else(|| super::default_folder(&name_of(&args.case), args.force));
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let places = Places { input, out: out.clone() };
    if args.force
        && let Err(outcome) = super::tell_kept(run::set_aside(&case, &places), &out, args.verbosity.quiet)
    {
        return outcome;
    }
    let mut watch = watched(&out, args.verbosity);
    let ended = match &args.from {
        Some(from) => run::run_from(&case, &places, from, &mut watch),
        None => run::run(&case, &places, &mut watch),
    };
    tell(ended, &out, &mut watch, args.verbosity)
}

/// Says how a run ended.
pub(crate) fn tell(ended: Result<Ended, RunError>, out: &Path, watch: &mut Watch, verbosity: Verbosity) -> Outcome {
    watch.progress().finish();
    match ended {
        Ok(Ended::Finished(summary)) => finished(&summary, out, verbosity),
        Ok(Ended::Structure(summary)) => structure(&summary, out, verbosity),
        Ok(Ended::AlreadyFinished { summary }) => already_finished(&summary, out, verbosity),
        Ok(Ended::Interrupted { iteration }) => interrupted(out, iteration, verbosity),
        Err(problem) => super::refuse(&problem),
    }
}

/// A watch over the run in the folder `out`.
pub(super) fn watched(out: &Path, verbosity: Verbosity) -> Watch {
    let folder = out.to_path_buf();
    Watch::new(verbosity).with_farewell(move || {
        let text = match run::has_begun(&folder) {
            true => format!("interrupted; go on with `alula resume {}`", folder.display()),
            false => {
                let out = folder.display();
                format!("interrupted before the first iteration; begin it again, in the same folder with `--out {out}`")
            }
        };
        if verbosity.json {
            output::event("interrupted", json!({ "run": folder, "message": text }));
        } else {
            output::message(&format!("{text}\n"));
        }
    })
}

/// Says how to go on with a run that was told to stop.
fn interrupted(out: &Path, iteration: u64, verbosity: Verbosity) -> Outcome {
    let text = Interrupt::farewell(out, iteration);
    if verbosity.json {
        output::event("interrupted", json!({ "run": out, "iteration": iteration, "message": text }));
    } else {
        output::message(&format!("{text}\n"));
    }
    Outcome::Interrupted
}

/// What a run lacks: what and what may help.
pub(super) struct Shortfall {
    pub(super) what: String,
    pub(super) hint: String,
}

/// Tells results, and what they lack: the results are the last line for programs, the first one for people.
pub(super) fn results(found: &str, lacking: Option<Shortfall>, verbosity: Verbosity) -> Outcome {
    let say = || if verbosity.quiet { Outcome::Done } else { output::data(found) };
    let Some(Shortfall { what, hint }) = lacking else { return say() };
    if verbosity.json {
        output::error(&what, &hint);
        say();
    } else {
        say();
        output::error(&what, &hint);
    }
    Outcome::Failed
}

/// Says that a run needs nothing more; whether it converged is told as when it ended.
fn already_finished(summary: &serde_json::Value, out: &Path, verbosity: Verbosity) -> Outcome {
    let found = match verbosity.json {
        true => format!("{summary}\n"),
        false => format!("the run in `{}` is finished: nothing was changed\n", out.display()),
    };
    let lacking = (summary["converged"] == false).then(|| Shortfall {
        what: "the run is finished, but not converged".into(),
        hint: format!("change `{}` and go on with `alula resume`", out.join("case.toml").display()),
    });
    results(&found, lacking, verbosity)
}

/// Tells what was found of a structure alone.
fn structure(summary: &SolidSummary, out: &Path, verbosity: Verbosity) -> Outcome {
    let found = match verbosity.json {
        true => serde_json::to_string(summary).unwrap_or_default() + "\n",
        false => describe_structure(summary, out),
    };
    results(&found, None, verbosity)
}

/// The same in words.
fn describe_structure(s: &SolidSummary, out: &Path) -> String {
    let mut lines = vec![format!("{}: {} solid particles, {:.1} CPU s", s.title, s.particles, s.cpu_seconds)];
    for (k, mode) in s.modes.iter().enumerate() {
        lines.push(format!(
            "mode {}: {:.6} Hz, generalised mass {:.6e}, residual {:.0e}",
            k + 1,
            mode.frequency,
            mode.generalised_mass,
            mode.residual
        ));
    }
    if let Some(residual) = s.residual.filter(|_| s.study == "equilibrium") {
        lines.push(format!("equilibrium: forces are left to {residual:.0e} of the largest"));
    }
    if let Some(p) = &s.periodic {
        let tail = p.tail.map(|t| format!(", the last of which is {:.2} % of all", 100.0 * t)).unwrap_or_default();
        lines.push(format!(
            "periodic motion at {:.6} Hz: harmonics 1 to {}{tail}; {} iterations, {} linear ones",
            p.frequency, p.harmonics, p.iterations, p.linear
        ));
    }
    if let Some(ledger) = s.ledger.filter(|_| s.study != "modes") {
        lines.push(format!(
            "energy: kinetic {:.4e}, strain {:.4e}, stabilisation {:.1e}, dissipated {:.4e}, damped {:.4e}, work {:.4e}; open by {:.1e}",
            ledger.kinetic,
            ledger.strain,
            ledger.stabilisation,
            ledger.dissipated,
            ledger.damped,
            ledger.work,
            ledger.open
        ));
    }
    for probe in s.probes.iter().filter(|p| !p.displacement.is_empty()) {
        let values: Vec<String> = probe.displacement.iter().map(|x| format!("{x:.6e}")).collect();
        if probe.harmonics.is_empty() {
            lines.push(format!("{} moved by ({})", probe.name, values.join(", ")));
            continue;
        }
        let mean: Vec<String> = probe.mean.iter().map(|x| format!("{x:.6e}")).collect();
        lines.push(format!("{}: mean ({})", probe.name, mean.join(", ")));
        for h in &probe.harmonics {
            let waves = h.amplitude.iter().zip(&h.phase_deg).map(|(a, p)| format!("{a:.6e} at {p:.2} deg"));
            lines.push(format!("{}: harmonic {} ({})", probe.name, h.harmonic, waves.collect::<Vec<_>>().join(", ")));
        }
    }
    lines.push(place(out) + "\n");
    lines.join("\n")
}

fn finished(summary: &Summary, out: &Path, verbosity: Verbosity) -> Outcome {
    let found = match verbosity.json {
        true => serde_json::to_string(summary).unwrap_or_default() + "\n",
        false => describe(summary, out),
    };
    results(&found, shortfall(summary, out), verbosity)
}

/// Why a run did not converge; `None` where it did.
fn shortfall(summary: &Summary, out: &Path) -> Option<Shortfall> {
    if summary.succeeded() {
        return None;
    }
    if !summary.polar.is_empty() {
        let (all, not) = (summary.polar.len(), summary.polar.iter().filter(|p| !p.converged).count());
        return Some(Shortfall {
            what: format!("{not} of {all} points did not converge"),
            hint: format!("the reasons stand in `{}`", out.join("polar.csv").display()),
        });
    }
    if summary.is_march() && summary.periodic.periodic_change.is_none() {
        return Some(Shortfall {
            what: format!("the march ended at t = {:.4}, short of its end", summary.convergence.time),
            hint: "raise `time.explicit.steps`".into(),
        });
    }
    if summary.is_march() {
        return Some(Shortfall {
            what: "not converged: the loads have not become periodic".into(),
            hint: "raise `periods` of `[time.dual]` or `[time.explicit]`, or loosen `periodic_tolerance` there".into(),
        });
    }
    let (table, swings) = match summary.periodic.harmonic_balance {
        Some(_) => ("harmonics", "does not repeat with the motion"),
        None => ("steady", "comes to no rest"),
    };
    Some(Shortfall {
        what: format!(
            "not converged: the residual fell {:.1} orders",
            summary.convergence.residual_drop.unwrap_or_default()
        ),
        hint: format!(
            "the residual in the report says why: one that still falls needs more `time.{table}.iterations`, one that swings is of a flow \
             that {swings}, which `[time.dual]` follows"
        ),
    })
}

/// Whether the loads are known as well as was asked, and on how many clouds.
fn grid_convergence(c: &Convergence) -> String {
    // 0.07 times 100 is not quite 7
    let asked = (1e6 * c.asked).round() / 1e4;
    let n = c.clouds.len();
    let end = match c.ended_by {
        FamilyEnd::Accuracy => format!("loads within {asked} % on {n} clouds\n"),
        FamilyEnd::Particles => format!(
            "the error bars are longer than {asked} %: `accuracy.particles` allows no finer cloud than the last of {n}\n"
        ),
        FamilyEnd::Unsteady => format!(
            "the error bars are longer than {asked} %: on a cloud finer than the last of {n} the flow came to no rest\n"
        ),
        FamilyEnd::Time => format!(
            "the error bars are longer than {asked} %: a finer cloud than the last of {n} would not end within `accuracy.time`\n"
        ),
    };
    c.moved_shocks().map_or_else(|| end.clone(), |why| format!("{end}{why}\n"))
}

/// Every number of a march or a balance with its error bar and the parts of that; nothing where none are asked for.
fn error_bars(found: &ErrorBars) -> String {
    if let Some(why) = &found.untold {
        return format!("no error bars: {why}\n");
    }
    type Part = (&'static str, fn(&Bar) -> Option<f64>);
    let parts: [Part; 4] =
        [("cloud", |b| b.cloud), ("step", |b| b.step), ("harmonics", |b| b.harmonics), ("transient", |b| b.transient)];
    let there: Vec<&Part> = parts.iter().filter(|(_, of)| found.bars.iter().any(|b| of(b).is_some())).collect();
    if there.is_empty() {
        return String::new();
    }
    let row = |name: &str, cells: &mut dyn Iterator<Item = String>| {
        format!("{name:<28}{}\n", cells.map(|cell| format!("{cell:>13}")).collect::<String>())
    };
    let names = ["value", "±"].into_iter().chain(there.iter().map(|(name, _)| *name));
    let mut text = row("error bars", &mut names.map(str::to_owned));
    for b in &found.bars {
        // coordinates are lengths and angles of any size
        let is_load = error_bars::LOADS.contains(&b.of.as_str());
        let told = |value: f64| if is_load { fixed(value, 5) } else { short(value) };
        let parts = there.iter().map(|(_, of)| of(b).map_or("-".to_owned(), told));
        text +=
            &row(&format!("{} {}", b.of, b.name()), &mut [b.value, b.half_width].map(told).into_iter().chain(parts));
    }
    text
}

fn describe(s: &Summary, out: &Path) -> String {
    let mut text = s.conditions() + "\n" + &solids(s);
    text += &match (&s.polar[..], &s.periodic.periodic_loads) {
        ([], Some(loads)) => periodic_loads(loads) + &change_of_period(s) + &instant(s),
        ([], None) => loads(s) + &cycles(s),
        (points, _) => polar(points),
    };
    if let Some(c) = s.grid.grid_convergence.as_ref().filter(|_| s.polar.is_empty()) {
        text += &grid_convergence(c);
    }
    text += &s.error_bars.as_ref().map_or_else(String::new, error_bars);
    if let Some(t) = &s.periodic.momentum_of_period {
        text += &format!(
            "over the last period momentum and walls differ by CL {:.1e}, CD {:.1e}, CM {:.1e} (rms at {} moments; ranges {:.3}, {:.3}, {:.3})\n",
            t.cl.rms, t.cd.rms, t.cm.rms, t.moments, t.cl.range, t.cd.range, t.cm.range
        );
    }
    if let Some(c) = &s.convergence.adapt_change {
        text += &format!("last adaptation {:+9.5}  {:+9.5}  {:+9.5}\n", c.cl, c.cd, c.cm);
    }
    if let Some(e) = s.convergence.error_l2_density {
        text += &format!("error of density (L2, exact solution) {e:.3e}\n");
    }
    if let Some(r) = &s.convergence.re_clouding {
        let t = &r.transfer;
        text += &format!(
            "cloud built anew {} times: {} particles inserted, {} removed; transfer: mass {:.1e}, momentum {:.1e}, energy {:.1e}\n",
            r.renewals, r.inserted, r.removed, t.mass, t.momentum, t.energy
        );
    }
    text += &cost(s);
    if let Some(l) = &s.convergence.ledger {
        text += &format!("ledger: mass {:.1e}, momentum {:.1e}, energy {:.1e}\n", l.mass, l.momentum, l.energy);
    }
    text + &place(out) + "\n"
}

/// Where the results are: the page, where there is one.
fn place(out: &Path) -> String {
    let page = out.join("report.html");
    if page.exists() { format!("report: {}", page.display()) } else { format!("results in {}", out.display()) }
}

/// What became of bodies made of particles in the units of the case: how far they moved, and the greatest stress.
fn solids(s: &Summary) -> String {
    let Some(end) = &s.structures.solid else { return String::new() };
    let list = |values: &[f64]| values.iter().map(|x| format!("{x:.4e}")).collect::<Vec<_>>().join(", ");
    let mut text = String::new();
    for probe in &end.probes {
        let (name, place) = (&probe.name, list(&probe.displacement));
        text += &format!("{name:<16}moved by ({place}), at most {:.4e}\n", probe.farthest);
    }
    let at = end.stress_at.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(", ");
    text + &format!("{:<16}{:.4e} at ({at}), the greatest by von Mises\n", "stress", end.stress)
}

/// What it took; how far the residual fell where there is one flow that it belongs to.
fn cost(s: &Summary) -> String {
    let marched = s.is_march();
    let way = match (s.convergence.residual_drop, s.polar.len()) {
        _ if marched => format!("to t = {:.4}{}", s.convergence.time, missed(s)),
        (Some(drop), 0) => format!("residual down {drop:.1} orders"),
        (None, 0) => "nothing to converge: the start is a steady flow".into(),
        (_, points) => format!("{points} points"),
    };
    format!(
        "{} particles, {} {}, {way}; {:.2} s of processor time ({:.3} ms per particle), {:.0} bytes per particle\n",
        s.convergence.particles,
        s.convergence.iterations,
        match (marched, s.convergence.iterations) {
            (true, 1) => "step",
            (true, _) => "steps",
            (false, 1) => "iteration",
            (false, _) => "iterations",
        },
        s.cost.cpu_seconds,
        s.cost.cpu_ms_per_particle,
        s.cost.bytes_per_particle,
    )
}

/// How many steps missed their goal; nothing where all met it.
fn missed(s: &Summary) -> String {
    match s.convergence.unconverged_steps {
        0 => String::new(),
        n => format!(", inner iterations of {n} of them short of their goal"),
    }
}

const LOADS: &str = "                      CL         CD         CM\n";

fn row(name: &str, c: &Coefficients) -> String {
    let [cl, cd, cm] = [c.cl, c.cd, c.cm].map(|load| fixed(load, 5));
    format!("{name:<16}{cl:>9}  {cd:>9}  {cm:>9}\n")
}

/// Loads of a steady state, or at the end of a march without a period; nothing without bodies.
fn loads(s: &Summary) -> String {
    let (all, momentum) = (&s.loads.total, &s.loads.momentum_balance);
    if all.cl == 0.0 && all.cd == 0.0 {
        return String::new();
    }
    let mut text = s.conditions.loads_at.map_or_else(String::new, |t| format!("at t = {t:.4}\n")) + LOADS;
    text += &row("wall pressure", s.loads.pressure.as_ref().unwrap_or(all));
    if let Some(friction) = &s.loads.friction {
        text += &(row("wall friction", friction) + &row("both", all));
    }
    text += &momentum.as_ref().map_or_else(String::new, |b| row("momentum", b));
    text += &s.grid.loads_error.as_ref().map_or_else(String::new, |bar| row("error bar ±", bar));
    text + &in_space(s)
}

/// Drag from the wake and of the load along the span, and what acts at the roots of wings and fins.
fn in_space(s: &Summary) -> String {
    let mut text = String::new();
    if let Some(w) = s.loads.wake_planes.first() {
        text += &format!(
            "{:<16}{:9.5}  {:9.5}  {:.2} chords behind: induced {:.5}, entropy {:.5}\n",
            "wake", w.cl, w.cd, w.distance, w.cd_induced, w.cd_entropy
        );
    }
    if let Some(l) = &s.loads.span_load {
        text += &format!(
            "{:<16}{:9.5}  {:9.5}  induced drag of the load along the span, efficiency {:.3}\n",
            "span load", l.cl, l.cd_induced, l.efficiency
        );
        text += &l.left_out.iter().map(|told| format!("{:<16}{told}\n", "")).collect::<String>();
    }
    if !s.loads.root_loads.is_empty() {
        text += "at the root          shear    bending    torsion  in the units of the case; over q S and q S c\n";
    }
    for r in &s.loads.root_loads {
        let place = format!("{} {} {:.4}", r.body, if r.axis == Span::Lying { "y" } else { "z" }, r.root);
        text += &format!("{place:<16}{:10.4e} {:10.4e} {:10.4e}  ", r.shear, r.bending, r.torsion);
        text += &format!("{:9.5} {:9.5} {:9.5}\n", r.shear_coefficient, r.bending_coefficient, r.torsion_coefficient);
    }
    if !s.loads.hinge_moments.is_empty() {
        text += "hinge moment       moment  coefficient     area      chord  in the units of the case; over q S c behind the hinge\n";
    }
    for h in &s.loads.hinge_moments {
        text +=
            &format!("{:<16}{:10.4e}  {:9.5} {:10.4e} {:10.4e}\n", h.name, h.moment, h.coefficient, h.area, h.chord);
    }
    text
}

/// Means and first harmonics of loads that repeat.
fn periodic_loads(p: &PeriodicLoads) -> String {
    let phase = &p.phase_deg;
    let phases =
        format!("{:<16}{:9.2}  {:9.2}  {:9.2}  degrees before {}\n", "phase", phase.cl, phase.cd, phase.cm, p.motion);
    let head = LOADS.replacen(&" ".repeat(15), "the last period", 1);
    let harmonic = match p.harmonic {
        1 => "first harmonic".to_owned(),
        n => format!("harmonic {n}"),
    };
    let per = match p.motion.as_str() {
        "angle" => "  per radian",
        "mode" => "  per unit of the mode",
        _ => "  per length of the motion",
    };
    let over = row("over the motion", &p.per_motion).trim_end().to_owned() + per + "\n";
    head + &row("mean", &p.mean) + &row(&harmonic, &p.amplitude) + &over + &phases
}

/// How the last period of a march differs from the one before; nothing of a balance, which is periodic.
fn change_of_period(s: &Summary) -> String {
    if !s.is_march() {
        return String::new();
    }
    match &s.periodic.periodic_change {
        Some(c) => format!(
            "from the period before it differs by {:.1e} (means) and {:.1e} (first harmonics) of the first harmonics\n",
            c.mean, c.first_harmonic
        ),
        None => "no period before confirms it: march two or more\n".into(),
    }
}

/// Loads at the instant that fields and pictures are of.
fn instant(s: &Summary) -> String {
    s.conditions.loads_at.map_or_else(String::new, |t| row(&format!("at t = {t:.4}"), &s.loads.total))
}

/// Cycles that the lift of a march goes through of itself.
fn cycles(s: &Summary) -> String {
    let Some(c) = s.periodic.lift_cycles.as_ref().filter(|_| s.is_march()) else { return String::new() };
    format!(
        "the last {} cycles of the lift, {:.5} in a unit of time (they differ by {:.1} %): CL {:.5} ± {:.5}, CD {:.5} ± {:.5}\n",
        c.cycles,
        c.frequency,
        100.0 * c.spread,
        c.mean_cl,
        c.amplitude_cl,
        c.mean_cd,
        c.amplitude_cd
    )
}

/// The points of a polar, one a row; bars only where there are some.
fn polar(points: &[PolarPoint]) -> String {
    let bars = points.iter().any(|p| p.loads_error.is_some());
    let mut text = String::from("    M    alpha");
    for name in ["CL", "CD", "CM"] {
        text += &format!("{name:>10}{}", if bars { "        ±" } else { "" });
    }
    for p in points {
        text += &format!("\n{:5.3} {:>8}", p.mach, fixed(p.alpha_deg, 3));
        let Some(c) = &p.loads else {
            text += &format!("  {}", p.reason);
            continue;
        };
        let all = [c.cl, c.cd, c.cm].into_iter().zip(p.loads_error.map_or([None; 3], |e| [e.cl, e.cd, e.cm].map(Some)));
        for (value, bar) in all {
            text += &format!(" {:>9}{}", fixed(value, 5), bar.map_or_else(String::new, |b| format!(" {b:8.5}")));
        }
        text += if p.converged { "" } else { "  not converged" };
        text += &if p.is_short() { format!("  {}", p.long_in_words()) } else { String::new() };
    }
    let short = points.iter().filter(|p| p.is_short()).count();
    text += "\n";
    if short > 0 {
        let of = |name: &str| points.iter().filter(|p| p.long_bars.iter().any(|long| long == name)).count();
        let each = ["CL", "CD", "CM"].map(|name| (name, of(name))).into_iter().filter(|(_, n)| *n > 0);
        let each = each.map(|(name, n)| format!("{name} at {n}")).collect::<Vec<_>>().join(", ");
        text += &format!(
            "error bars of {short} of {} points are longer than asked for ({each}): raise `accuracy.particles`, or loosen `accuracy.loads`\n",
            points.len()
        );
    }
    text
}

/// Name of a run after its case file: the file's own, or that of its folder when the file is called `case.toml`.
pub(crate) fn name_of(case: &Path) -> String {
    let stem = |p: &Path| p.file_stem().map(|s| s.to_string_lossy().into_owned());
    let own = stem(case).unwrap_or_else(|| "run".into());
    let folder = case.parent().and_then(Path::file_name).map(|s| s.to_string_lossy().into_owned());
    if own == "case" { folder.unwrap_or(own) } else { own }
}
