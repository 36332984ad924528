//! What helps against a warning of a flutter boundary, or where more about it is found.

/// A steady flow that did not converge.
pub const STEADY: &str = "raise `iterations`, or lower `orders`, in `[time.steady]`";
/// Motions that grow at the lowest speed at which forces are known.
pub const LOWEST: &str = "give higher `reduced_frequencies` in `[flutter]`: they reach lower speeds";
/// No motion within the frequencies at which forces are known.
pub const HIGHER: &str = "give higher `reduced_frequencies` in `[flutter]`";
/// Motions that grow at any density.
pub const DAMPING: &str = "give the structure its damping, `damping_ratio`";
/// Growth that depends on the spacing of the cloud.
pub const SPACING: &str = "lower `spacing` in `[cloud]`: the range of speed is that of `doubts` in `flutter.json`";
/// Crossings with an error bar that more frequencies make shorter.
pub const FREQUENCIES: &str = "raise `frequencies` in `[flutter]`";
/// Limit cycles with an error bar that more harmonics make shorter.
pub const HARMONICS: &str = "raise `harmonics` in `[lco]`";
/// Static equilibria that do not come to the crossing.
pub const EQUILIBRIA: &str = "give the structure a speed nearer to the crossing, from which the equilibria are sought";
/// The march of a limit cycle.
pub const MARCH: &str = "leave `march` out of `[lco]`, or compute that march with a case of its own";
/// Limit cycles.
pub const CYCLES: &str = "see the branches in `lco.csv`; other amplitudes are given in `[lco]`";
/// All other warnings.
pub const SEE: &str = "see `warnings` and the crossings in `flutter.json`";
