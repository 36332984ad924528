//! How memory is asked for and given back.

/// Size in bytes from which an array has pages of its own, which go back to the system when it is dropped.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: i32 = 1 << 18;

/// Has the memory of every large array go back to the system as soon as it is dropped.
///
/// The allocator of GNU systems learns otherwise: once an array of so many bytes was dropped it keeps the memory of all smaller ones for
/// later, and what a cloud was built with then stays resident beside the solver. Hot loops do not allocate, so that nothing is lost.
pub(crate) fn give_back_large_arrays() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[allow(unsafe_code, reason = "sets a number of the allocator before there is a second thread")]
    // SAFETY: `mallopt` takes two numbers and touches no memory of ours; no other thread runs yet
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
    }
}
