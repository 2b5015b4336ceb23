//! Which of several hosts has the board.

use froude_link::session::{AFTER_SILENCE_US, Greeting, Holder, NOBODY};
use proptest::prelude::*;

/// The controller's limit of its host's silence, µs.
const SILENCE_US: u32 = 200_000;

#[derive(Debug, Clone, Copy)]
enum Happens {
    Hello(u32),
    Says(u32),
    Passes(u32),
}

fn anything() -> impl Strategy<Value = Happens> {
    prop_oneof![
        (0..4_u32).prop_map(Happens::Hello),
        (0..4_u32).prop_map(Happens::Says),
        prop_oneof![Just(250_u32), 1..400_000_u32, Just(SILENCE_US), Just(AFTER_SILENCE_US)].prop_map(Happens::Passes),
    ]
}

proptest! {
    /// Whatever is said in whatever order: the board changes hands only by a hello after the holder's full silence, nobody never has
    /// it, and a host that is refused changes nothing.
    #[test]
    fn the_board_changes_hands_only_after_silence(story in prop::collection::vec(anything(), 1..200)) {
        let mut holder = Holder::nobody();
        // Time since the holder's last word, in a number that does not saturate.
        let mut silent_us = 0_u64;
        for event in story {
            let before = holder;
            match event {
                Happens::Passes(us) => {
                    holder.pass(us);
                    silent_us += u64::from(us);
                    prop_assert_eq!(holder.session(), before.session());
                }
                Happens::Says(session) => {
                    let is_holder = session != NOBODY && session == before.session();
                    prop_assert_eq!(holder.hear(session), is_holder);
                    prop_assert_eq!(holder.session(), before.session());
                    if is_holder { silent_us = 0 } else { prop_assert_eq!(holder, before) }
                }
                Happens::Hello(session) => {
                    let may = before.session() == NOBODY || silent_us >= u64::from(SILENCE_US + AFTER_SILENCE_US);
                    let expected = match session {
                        NOBODY => Greeting::Refused,
                        _ if session == before.session() => Greeting::Again,
                        _ if may => Greeting::Taken,
                        _ => Greeting::Refused,
                    };
                    prop_assert_eq!(holder.greet(session, SILENCE_US), expected);
                    match expected {
                        Greeting::Refused => prop_assert_eq!(holder, before),
                        _ => {
                            prop_assert_eq!(holder.session(), session);
                            silent_us = 0;
                        }
                    }
                }
            }
            let left_us = u64::from(SILENCE_US + AFTER_SILENCE_US).saturating_sub(silent_us);
            let expected = if holder.session() == NOBODY { 0 } else { left_us };
            prop_assert_eq!(u64::from(holder.free_in_us(SILENCE_US)), expected);
        }
    }
}

#[test]
fn a_silence_longer_than_the_clock_counts_is_silence_still() {
    let mut holder = Holder::nobody();
    assert_eq!(holder.greet(5, u32::MAX), Greeting::Taken);
    for _ in 0..3 {
        holder.pass(u32::MAX);
    }
    assert_eq!(holder.free_in_us(u32::MAX), 0);
    assert_eq!(holder.greet(6, u32::MAX), Greeting::Taken);
}
