//! The hand-over between the rig's thread and the campaign's, and the operator's stop, on explored schedules.
//!
//! What is explored is the code that drives (the same two files), with shuttle's primitives in the place of the system's: at every
//! access to a lock, a condition or a flag any other thread may go first. A deadlock, a lost wake-up or a broken promise in any schedule
//! fails with the schedule that shows it.
#![allow(missing_docs, dead_code, clippy::unwrap_used, clippy::panic, clippy::pedantic)]

/// What the two files are made of here.
mod sync {
    pub use shuttle::sync::atomic::{AtomicBool, AtomicU8, Ordering};
    pub use shuttle::sync::{Arc, Condvar, Mutex, MutexGuard};
    pub use std::sync::{PoisonError, TryLockError};
}
#[path = "../src/campaign/hand_over.rs"]
mod hand_over;
#[path = "../src/campaign/stop.rs"]
mod stop;

use hand_over::{Engine, Helm, Next, Pace, hand_over};
use shuttle::thread;
use stop::{Asked, StopSwitch};
use sync::{Arc, AtomicBool, AtomicU8, Mutex, Ordering};

/// Schedules a test: half of them at random, half with few changes of thread at the worst moments.
const SCHEDULES: usize = 4_000;

fn explore(test: impl Fn() + Send + Sync + Clone + 'static) {
    let random = test.clone();
    shuttle::check_random(random, SCHEDULES / 2);
    shuttle::check_pct(test, SCHEDULES / 2, 3);
}

/// What is ordered, and what comes back.
#[derive(Debug, PartialEq)]
enum Said {
    Tick(u32),
    Ended(bool),
}

/// As the rig's thread does it: `ticks` ticks an order, a stop asked for before each; `true` when all were done.
fn attend(mut engine: Engine<u32, Said>, switch: StopSwitch, rig: Arc<Rig>) {
    loop {
        match engine.next() {
            Next::Over => break,
            Next::Nothing => rig.tick(false),
            Next::Order(ticks) => {
                let mut done = 0;
                while done < ticks && switch.asked() == Asked::Nothing && !engine.is_unrecorded() {
                    rig.tick(true);
                    engine.offer(Said::Tick(done));
                    done += 1;
                }
                rig.rest();
                engine.put(Said::Ended(done == ticks));
            }
        }
    }
    rig.rest();
}

/// What a rig does here: it moves or it does not.
#[derive(Default)]
struct Rig {
    moves: AtomicBool,
    idle_ticks: AtomicU8,
}

impl Rig {
    fn tick(&self, is_moving: bool) {
        self.moves.store(is_moving, Ordering::SeqCst);
        if !is_moving {
            let _ = self.idle_ticks.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |n| Some(n.saturating_add(1)));
        }
        thread::yield_now();
    }

    fn rest(&self) {
        self.moves.store(false, Ordering::SeqCst);
    }

    fn is_moving(&self) -> bool {
        self.moves.load(Ordering::SeqCst)
    }
}

fn begin(pace: Pace, capacity: usize) -> (Helm<u32, Said>, StopSwitch, Arc<Rig>, thread::JoinHandle<()>) {
    let (helm, engine) = hand_over(pace, capacity);
    let (switch, rig) = (StopSwitch::default(), Arc::new(Rig::default()));
    let (theirs, their_rig) = (switch.clone(), Arc::clone(&rig));
    let thread = thread::spawn(move || attend(engine, theirs, their_rig));
    (helm, switch, rig, thread)
}

/// Everything that an order gives, up to its end.
fn carried_out(helm: &Helm<u32, Said>, ticks: u32) -> (Vec<u32>, bool) {
    helm.order(ticks);
    let (mut entries, mut seen) = (Vec::new(), Vec::new());
    while helm.take(&mut entries) {
        for entry in entries.drain(..) {
            match entry {
                Said::Tick(number) => seen.push(number),
                Said::Ended(is_done) => return (seen, is_done),
            }
        }
    }
    panic!("the engine ended without an answer");
}

#[test]
fn every_order_is_answered_once_and_nothing_is_lost_or_turned_around() {
    for pace in [Pace::RealTime, Pace::OnDemand] {
        explore(move || {
            let (helm, _, _, thread) = begin(pace, 100);
            for ticks in [3, 0, 2] {
                assert_eq!(carried_out(&helm, ticks), ((0..ticks).collect(), true));
            }
            drop(helm);
            thread.join().unwrap();
        });
    }
}

/// More than the engine may hand over at once, with room for two: a twin waits for who records.
#[test]
fn a_twin_waits_rather_than_lose_a_sample_and_never_runs_ahead() {
    let test = || {
        let (helm, engine) = hand_over::<u32, Said>(Pace::OnDemand, 2);
        let thread = thread::spawn(move || attend(engine, StopSwitch::default(), Arc::new(Rig::default())));
        assert_eq!(carried_out(&helm, 200), ((0..200).collect(), true));
        // Gone in the middle of an order: it ends, waiting for nobody.
        helm.order(200);
        drop(helm);
        thread.join().unwrap();
    };
    shuttle::check_random(test, SCHEDULES / 8);
}

/// The person at the prompt answers at any moment, and so does the stop come: after it nothing moves, whatever the answer.
#[test]
fn no_motion_begins_after_a_stop_whatever_the_answer() {
    explore(|| {
        let (helm, switch, rig, thread) = begin(Pace::RealTime, 100);
        let answered = Arc::new(AtomicBool::new(false));
        let person = {
            let answered = Arc::clone(&answered);
            thread::spawn(move || answered.store(true, Ordering::SeqCst))
        };
        let is_stopped = Arc::new(AtomicBool::new(false));
        let hand = {
            let (switch, is_stopped) = (switch.clone(), Arc::clone(&is_stopped));
            thread::spawn(move || {
                ctrl_c(&switch);
                is_stopped.store(true, Ordering::SeqCst);
            })
        };
        // The prompt: it waits for the answer or for the stop.
        while !answered.load(Ordering::SeqCst) && !switch.is_asked() {
            thread::yield_now();
        }
        let was_stopped = is_stopped.load(Ordering::SeqCst);
        let (seen, is_done) = carried_out(&helm, 3);
        if was_stopped {
            assert!(seen.is_empty() && !is_done, "moved after a stop: {seen:?}");
        }
        assert!(!rig.is_moving());
        drop(helm);
        for other in [hand, person, thread] {
            other.join().unwrap();
        }
    });
}

/// As the handlers of Ctrl-C do, in their order.
fn ctrl_c(switch: &StopSwitch) {
    switch.stop_flag().store(true, Ordering::SeqCst);
    switch.press_flag().store(true, Ordering::SeqCst);
}

/// While others look on, the rig's thread counts: the second press cuts at its next tick, and a hang-up never does.
#[test]
fn two_presses_are_two_and_any_number_of_hang_ups_is_one_stop() {
    explore(|| {
        let switch = StopSwitch::default();
        let (seen, look) = (Arc::new(AtomicU8::new(0)), switch.clone());
        let rig = {
            let (switch, seen) = (switch.clone(), Arc::clone(&seen));
            thread::spawn(move || {
                while switch.asked() != Asked::Cut {
                    seen.store(u8::from(switch.asked() == Asked::Stop), Ordering::SeqCst);
                    thread::yield_now();
                }
            })
        };
        let terminal = thread::spawn(move || {
            while !look.is_asked() {
                thread::yield_now()
            }
        });
        for _ in 0..3 {
            switch.stop_flag().store(true, Ordering::SeqCst);
        }
        ctrl_c(&switch);
        while switch.press_flag().load(Ordering::SeqCst) || seen.load(Ordering::SeqCst) == 0 {
            thread::yield_now();
        }
        assert_ne!(switch.asked(), Asked::Cut, "hang-ups and one press are one stop");
        ctrl_c(&switch);
        rig.join().unwrap();
        terminal.join().unwrap();
    });
}

/// The campaign's side waits for something that only comes when the rig is at rest, a terminal that takes no more or a disk: the rig must not wait
/// for it in turn.
#[test]
fn a_stop_is_carried_out_while_nobody_takes_what_comes() {
    explore(|| {
        let (helm, switch, rig, thread) = begin(Pace::RealTime, 1_000);
        let terminal = Arc::new(Mutex::new(()));
        let blocked = terminal.lock().unwrap();
        let campaign = {
            let (terminal, switch) = (Arc::clone(&terminal), switch.clone());
            thread::spawn(move || {
                helm.order(u32::MAX);
                let mut entries = Vec::new();
                helm.take(&mut entries);
                drop(terminal.lock().unwrap());
                while switch.is_asked() && !entries.iter().any(|e| matches!(e, Said::Ended(_))) {
                    entries.clear();
                    assert!(helm.take(&mut entries));
                }
            })
        };
        while !rig.is_moving() {
            thread::yield_now();
        }
        switch.stop_flag().store(true, Ordering::SeqCst);
        while rig.is_moving() {
            thread::yield_now();
        }
        drop(blocked);
        campaign.join().unwrap();
        thread.join().unwrap();
    });
}

#[test]
fn what_is_no_longer_recorded_stops_the_rig_and_its_end_still_arrives() {
    explore(|| {
        // Room for two samples, and nobody takes any.
        let (helm, _, rig, thread) = begin(Pace::RealTime, 2);
        helm.order(u32::MAX);
        while !rig.is_moving() {
            thread::yield_now();
        }
        while rig.is_moving() {
            thread::yield_now();
        }
        let (mut entries, mut all) = (Vec::new(), Vec::new());
        while all.last() != Some(&Said::Ended(false)) {
            assert!(helm.take(&mut entries));
            all.append(&mut entries);
        }
        assert!(all.len() <= 5, "bounded: {all:?}");
        drop(helm);
        thread.join().unwrap();
    });
}

#[test]
fn a_recorder_that_gives_up_or_a_campaign_that_goes_away_stops_the_rig() {
    for is_dropped in [false, true] {
        explore(move || {
            let (helm, _, rig, thread) = begin(Pace::RealTime, 1_000);
            helm.order(u32::MAX);
            if is_dropped {
                drop(helm);
            } else {
                helm.give_up();
                let (mut entries, mut last) = (Vec::new(), None);
                while last != Some(Said::Ended(false)) {
                    assert!(helm.take(&mut entries));
                    last = entries.drain(..).next_back();
                }
                drop(helm);
            }
            thread.join().unwrap();
            assert!(!rig.is_moving());
        });
    }
}

/// Between orders a real rig is ticked on, and trouble there ends a prompt.
#[test]
fn while_a_person_is_asked_the_rig_is_ticked_and_its_trouble_is_heard() {
    explore(|| {
        let (helm, mut engine) = hand_over::<u32, Said>(Pace::RealTime, 10);
        let ticks = Arc::new(AtomicU8::new(0));
        let rig = {
            let ticks = Arc::clone(&ticks);
            thread::spawn(move || {
                loop {
                    match engine.next() {
                        Next::Over => return,
                        Next::Order(_) => engine.put(Said::Ended(false)),
                        Next::Nothing => {
                            if ticks.fetch_add(1, Ordering::SeqCst) == 2 {
                                // The port is gone: nothing is left to tick, so that it may wait for the order that asks why.
                                engine.wait_from_now_on();
                                engine.call();
                            }
                            thread::yield_now();
                        }
                    }
                }
            })
        };
        while !helm.is_in_trouble() {
            thread::yield_now();
        }
        assert_eq!(carried_out(&helm, 1), (vec![], false));
        assert_eq!(ticks.load(Ordering::SeqCst), 3);
        drop(helm);
        rig.join().unwrap();
    });
}
