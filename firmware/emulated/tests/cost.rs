//! What a tick costs on the Cortex-A8, held against its budget; and 10⁵ commands bit-equal to the host's.

use froude_board::rig::CONFIG;
use froude_board::scenario::{Scenario, TICKS};
use froude_control::Controller;
use froude_emulated::trace::{CLASSES, Followed, follow};

/// The tick is 250 µs: at 1 GHz 250,000 cycles. The step may take a tenth of them.
const BUDGET_CYCLES: u32 = 25_000;

/// The number after `key` in what the image printed.
fn number(text: &str, key: &str) -> u32 {
    let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_else(|| panic!("no {key} in:\n{text}"));
    line[key.len()..].split_whitespace().next().unwrap().parse().unwrap()
}

fn hash_on_the_host() -> u64 {
    let (mut controller, mut story) = (Controller::new(CONFIG).unwrap(), Scenario::default());
    while story.number() < TICKS {
        let output = controller.step(&story.tick());
        story.follow(&output);
    }
    story.hash
}

#[test]
fn a_tick_stays_within_a_tenth_of_its_period_and_every_command_is_the_hosts() {
    let (followed, text) = follow("cost", "traced_step").unwrap();
    print!("{text}");
    let hash = format!("hash {:016x}", hash_on_the_host());
    assert!(text.contains(&hash), "the host has {hash}");
    assert!(text.contains(&hash.replace("hash", "again")), "the second pass differs");

    let costliest = |key: fn(&Followed) -> u32| *followed.iter().max_by_key(|step| key(step)).unwrap();
    let by_count = costliest(Followed::instructions);
    let by_cycles = costliest(|step| step.cycles);
    println!("{} steps followed", followed.len());
    for (name, step) in [("most instructions", by_count), ("most cycles", by_cycles)] {
        let mix: Vec<_> = CLASSES.iter().zip(step.count).map(|((class, _), n)| format!("{class} {n}")).collect();
        println!("{name}: {} instructions, at most {} cycles ({})", step.instructions(), step.cycles, mix.join(", "));
    }
    // The step that was counted and the one that was followed are the same, but for the call around it.
    let counted = number(&text, "worst ");
    assert!(counted.abs_diff(by_count.instructions()) <= 40, "{counted} counted, {} followed", by_count.instructions());
    println!("SPI: two words of 24 bits at 12 MHz, 4.0 us on the wire, not waited for");
    let most_a_piece = followed.iter().map(|s| f64::from(s.cycles) / f64::from(s.instructions())).fold(0.0, f64::max);
    println!(
        "median {} instructions, worst {counted}; at most {:.1} cycles an instruction in any step followed",
        number(&text, "median "),
        most_a_piece
    );
    let bound = by_cycles.cycles.max((most_a_piece * f64::from(counted)) as u32);
    println!("bound {bound} cycles of {BUDGET_CYCLES}");
    assert!(bound <= BUDGET_CYCLES);
}
