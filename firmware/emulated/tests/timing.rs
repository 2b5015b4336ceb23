//! Timer, overrun, ring and host watchdog on the emulated board, with nothing from outside: two runs are equal to the byte.

use froude_emulated::run_alone;

/// The numbers of the line that starts with `key`.
fn numbers(text: &str, key: &str) -> Vec<u32> {
    let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_else(|| panic!("no {key} in:\n{text}"));
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn ticks_overruns_the_ring_and_a_silent_host_are_noticed_and_two_runs_are_equal() {
    let text = run_alone("timing", 2, &[]).unwrap();
    print!("{text}");
    assert_eq!(text, run_alone("timing", 2, &[]).unwrap(), "two runs differ");

    assert_eq!(numbers(&text, "ticks"), [32_000, 32_000], "every tick of the timer is accounted for");
    // The main loop hung over two ticks; the second of them was still in time for the loop's next turn.
    let [overruns, told] = numbers(&text, "overruns")[..] else { panic!("{text}") };
    assert!((1..=2).contains(&overruns), "{overruns}");
    assert_eq!(overruns, told, "all were reported to the host");
    let worst_us = numbers(&text, "worst_step_us")[0];
    assert!(worst_us < 100, "{worst_us} µs from tick to command");
    assert_eq!(numbers(&text, "accepted"), [8, 0]);

    // The line stalled for 1500 ticks, the ring holds 1024: the rest is missing, counted, and marked once.
    let [_, missing, marked, lost] = numbers(&text, "telemetry")[..] else { panic!("{text}") };
    assert_eq!(missing, lost + overruns, "what is missing is what was lost or skipped");
    assert!((470..=480).contains(&lost), "{lost}");
    assert_eq!(marked, 1);

    // 200 ms of silence are 800 ticks; the last sign of life may be 40 ticks older than the silence, and the frame takes one.
    let [silent, fault, at_rest] = numbers(&text, "silent_at")[..] else { panic!("{text}") };
    assert!((silent + 760..=silent + 802).contains(&fault), "silent from {silent}, fault at {fault}");
    // At most 0.5 m/s with 1 m/s²: half a second, a shaper's delay, and the quarter second until rest is believed.
    assert!(at_rest > fault && at_rest <= fault + 4_000, "fault at {fault}, at rest at {at_rest}");
    assert!(text.contains("cleared true"));
    assert_eq!(numbers(&text, "fed"), [32_000 - overruns], "the watchdog is fed once a step");
}
