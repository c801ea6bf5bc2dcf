//! How much memory the program has taken.

/// The most memory (bytes) that this process has held at a time, where the system tells it (Linux).
#[must_use]
pub fn peak() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM:").map(|kb| 1024 * kb)
}

/// Memory (bytes) that programs could still take, where the system tells it (Linux).
#[must_use]
pub fn available() -> Option<u64> {
    kilobytes("/proc/meminfo", "MemAvailable:").map(|kb| 1024 * kb)
}

/// The number behind a name in one of the system's tables.
fn kilobytes(table: &str, name: &str) -> Option<u64> {
    let text = std::fs::read_to_string(table).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_at_least_what_is_held() {
        let Some(before) = peak() else {
            return; // another system
        };
        let held = vec![1_u8; 64 << 20];
        assert!(peak().unwrap() >= before.max(64 << 20), "{before}");
        assert!(available().unwrap() > 0);
        drop(std::hint::black_box(held));
    }
}
