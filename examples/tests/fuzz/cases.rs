//! The cases of a target.

use auv_types::{ChaCha8Rng, Seed};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// No case may take longer, however busy the machine is.
const LONGEST: Duration = Duration::from_secs(20);
/// Most memory that the process may ever have reserved, bytes.
const MOST_MEMORY: u64 = 4 << 30;

fn number(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(
        text.parse()
            .unwrap_or_else(|_| panic!("{name} is not a number")),
    )
}

/// The most memory that the process has reserved so far, bytes, where the system tells.
fn reserved() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmPeak:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches(" kB").parse().ok()?;
    Some(1024 * kilobytes)
}

/// Runs the cases of a target: `usual` of them, or `AUV_FUZZ_RUNS`. Case `k` depends on `k` alone.
#[expect(
    clippy::disallowed_methods,
    reason = "the test measures how long a case takes"
)]
pub(crate) fn each_case(usual: u64, mut run: impl FnMut(&mut ChaCha8Rng)) {
    let first = number("AUV_FUZZ_FIRST").unwrap_or(0);
    let runs = number("AUV_FUZZ_RUNS").unwrap_or(usual);
    for case in first..first + runs {
        let mut random = Seed(case).stream(0);
        let began = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| run(&mut random)));
        let took = began.elapsed();
        let again = format!("AUV_FUZZ_FIRST={case} AUV_FUZZ_RUNS=1 runs it again");
        assert!(outcome.is_ok(), "case {case} failed: {again}");
        assert!(took < LONGEST, "case {case} took {took:?}: {again}");
    }
    let reserved = reserved();
    assert!(
        reserved.is_none_or(|bytes| bytes < MOST_MEMORY),
        "{reserved:?} bytes"
    );
}
