//! Peak resident memory.

/// The greatest resident set of this process so far, in bytes.
///
/// Linux says it in `/proc/self/status` (`VmHWM`, in kibibytes); elsewhere `None`.
#[must_use]
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    high_water_mark(&status)
}

fn high_water_mark(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_read_from_its_line() {
        let status = "Name:\tqsplat\nVmPeak:\t  999 kB\nVmHWM:\t   12345 kB\nVmRSS:\t 1 kB\n";
        assert_eq!(high_water_mark(status), Some(12_345 * 1024));
        assert_eq!(high_water_mark("Name:\tqsplat\n"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_has_one() {
        let block = std::hint::black_box(vec![1_u8; 32 << 20]);
        let peak = peak_bytes().unwrap_or(0);
        assert!(peak > std::hint::black_box(&block).len() as u64, "{peak}");
    }
}
