//! Return of freed memory to the operating system.

/// Returns the free pages of all heaps to the operating system. The allocator of glibc returns freed memory by itself
/// only at the end of a heap and from large blocks; below a block that is still in use, the many short lines of a dropped
/// solver would stay resident while pictures are drawn. Without glibc nothing happens.
pub(super) fn release_free_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: the call takes the locks of the allocator, has no other precondition and leaves blocks in use as they are.
    // Its result says whether any page has been returned.
    unsafe {
        libc::malloc_trim(0);
    }
}
