//! `alula resume`.
use crate::arguments;
use crate::outcome::Outcome;

/// Goes on with an interrupted run.
pub(crate) fn resume(args: &arguments::Resume) -> Outcome {
    if alula::run::flutter::is_interrupted(&args.run) {
        return super::flutter::resume(&args.run, args.verbosity);
    }
    let mut watch = super::run::watched(&args.run, args.verbosity);
    let ended = alula::run::resume(&args.run, &mut watch);
    super::run::tell(ended, &args.run, &mut watch, args.verbosity)
}
