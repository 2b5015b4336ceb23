//! Memory for long records.
//!
//! The first touch of a page costs more than a filter does: 20,000 pages of 4 KiB a column of 10⁷ samples, some 5 ns a
//! sample. On pages of 2 MiB, asked for where the system grants them on request (as numpy does), it is a tenth of that.

/// Bytes from which on large pages are asked for.
#[cfg(target_os = "linux")]
const LARGE: usize = 4 << 20;

/// A record of zeros to be written to.
pub(crate) fn zeros(samples: usize) -> Vec<f64> {
    #[allow(unused_mut)]
    let mut record = vec![0.0; samples]; // a long one is mapped, not written: its pages are still untouched
    #[cfg(target_os = "linux")]
    if size_of_val(record.as_slice()) >= LARGE {
        ask_for_large_pages(&mut record);
    }
    record
}

#[cfg(target_os = "linux")]
fn ask_for_large_pages(record: &mut [f64]) {
    use rustix::mm::{Advice, madvise};

    const PAGE: usize = 64 << 10; // a multiple of every page size in use
    let range = record.as_mut_ptr_range();
    let start = range.start.cast::<core::ffi::c_void>();
    let to_page = start.align_offset(PAGE);
    let whole = (size_of_val(record) - to_page) / PAGE * PAGE;
    #[allow(unsafe_code)]
    // SAFETY: the pages lie inside the record, and this advice does not change what they hold. A system that knows no
    // large pages says so, and nothing is lost.
    unsafe {
        let _ = madvise(start.wrapping_byte_add(to_page), whole, Advice::LinuxHugepage);
    }
}
