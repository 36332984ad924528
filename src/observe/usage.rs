//! What the process has used, as the operating system tells it.
use std::fs;

/// Clock ticks per second in `/proc`: fixed on Linux.
const TICKS: f64 = 100.0;

/// Processor seconds of this process over all threads; 0 where the system does not tell.
pub fn cpu_seconds() -> f64 {
    // fine-grained where available: nanoseconds of every thread
    if let Some(ns) = thread_nanoseconds() {
        return ns * 1e-9;
    }
    let Ok(stat) = fs::read_to_string("/proc/self/stat") else { return 0.0 };
    let after = stat.rsplit(')').next().unwrap_or("");
    let ticks = |k: usize| after.split_whitespace().nth(k).and_then(|f| f.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / TICKS
}

fn thread_nanoseconds() -> Option<f64> {
    let mut sum = 0.0;
    for task in fs::read_dir("/proc/self/task").ok()? {
        let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += text.split_whitespace().next()?.parse::<f64>().ok()?;
    }
    (sum > 0.0).then_some(sum)
}

/// Greatest resident memory of this process in bytes; 0 where the system does not tell.
pub fn peak_bytes() -> u64 {
    let Ok(status) = fs::read_to_string("/proc/self/status") else { return 0 };
    let line = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap_or("");
    let kilobytes: u64 = line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).unwrap_or(0);
    kilobytes * 1024
}
