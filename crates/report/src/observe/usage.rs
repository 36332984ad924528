//! What the process has used, as the operating system tells it.
use std::fs;
use std::path::Path;

/// Clock ticks per second in `/proc`: fixed on Linux.
const TICKS: f64 = 100.0;

/// Greatest number of threads: starting more takes longer than what they do.
pub const MOST_THREADS: usize = 256;

/// Threads that the environment variable `RAYON_NUM_THREADS` asks for, [`MOST_THREADS`] at most; 0, one for each core, where it asks for
/// none.
pub fn threads_of_environment() -> usize {
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.trim().parse::<usize>().ok());
    asked.unwrap_or(0).min(MOST_THREADS)
}

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
    kilobytes(&status, "VmHWM:").unwrap_or(0)
}

/// Bytes of memory that this process may still take: what is free, what its group and its address space allow; `None` where the
/// system does not tell.
pub fn available_bytes() -> Option<u64> {
    let limits = [free_bytes(), group_bytes(), address_bytes()];
    limits.into_iter().flatten().min()
}

/// Bytes that this user may still write where `folder` is, which exists; `None` where the system does not tell.
#[cfg(unix)]
pub fn free_disk_bytes(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    disk.f_bavail.checked_mul(disk.f_frsize)
}

/// Bytes that this user may still write where `folder` is: this system is not asked.
#[cfg(not(unix))]
pub fn free_disk_bytes(_: &Path) -> Option<u64> {
    None
}

/// Memory that is free or can be freed.
fn free_bytes() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    kilobytes(&text, "MemAvailable:")
}

/// What a control group leaves of its limit, which stands in a file of its own in version 2.
fn group_bytes() -> Option<u64> {
    let number = |name: &str| fs::read_to_string(name).ok()?.trim().parse::<u64>().ok();
    Some(number("/sys/fs/cgroup/memory.max")?.saturating_sub(number("/sys/fs/cgroup/memory.current")?))
}

/// What `ulimit -v` leaves.
fn address_bytes() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|l| l.strip_prefix("Max address space"))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    let used = kilobytes(&fs::read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some(most.saturating_sub(used))
}

/// The number of bytes in the line of `text` that begins with `name` and counts kilobytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(name))?;
    Some(1024 * line.split_whitespace().next()?.parse::<u64>().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kilobytes_are_read_from_the_line_of_a_name() {
        assert_eq!(kilobytes("MemTotal: 9 kB\nMemAvailable:   12 kB\n", "MemAvailable:"), Some(12 * 1024));
        assert_eq!(kilobytes("MemTotal: 9 kB\n", "MemAvailable:"), None);
    }
}
