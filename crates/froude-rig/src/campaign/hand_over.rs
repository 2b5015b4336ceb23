//! The hand-over between the thread that ticks a rig and the one that records, asks and prints.
//!
//! The [`Helm`] gives orders and takes what came of them; the [`Engine`] carries them out, one at a time. How an engine waits is
//! the whole difference between a real rig and a twin:
//!
//! | pace                  | a lock that is held          | nobody takes entries             | between orders          |
//! |-----------------------|------------------------------|----------------------------------|-------------------------|
//! | [`Pace::RealTime`]    | is passed over, until later  | they are kept up to the capacity, then dropped, and [`Engine::is_unrecorded`] says so | goes on ticking |
//! | [`Pace::OnDemand`]    | is waited for                | it waits: its time stands still   | waits for the next order |
//!
//! So whatever the helm's side waits for, a disk, a terminal, a person, an engine in real time never waits for it. What may be
//! asked at any moment without a lock: that the helm has given up ([`Engine::is_unrecorded`]), that the engine is in trouble
//! ([`Helm::is_in_trouble`]).
//!
//! This file is built twice: here, and in `tests/hand_over.rs` on primitives whose schedules are explored.

use super::sync::{Arc, AtomicBool, Condvar, Mutex, MutexGuard, Ordering, PoisonError, TryLockError};

/// How an engine waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Time passes by itself: never wait.
    RealTime,
    /// Time passes only when ticked: wait rather than lose an entry.
    OnDemand,
}

/// Entries that an engine on demand hands over at once: waking the other thread for each would cost more than a tick.
const BATCH: usize = 64;

/// What an engine is to do next.
#[derive(Debug)]
pub enum Next<O> {
    /// Carry this out.
    Order(O),
    /// Nothing was ordered yet; tick on.
    Nothing,
    /// The helm is gone and will order nothing more.
    Over,
}

struct State<O, E> {
    order: Option<O>,
    entries: Vec<E>,
    is_helm_gone: bool,
    is_engine_gone: bool,
}

struct Shared<O, E> {
    state: Mutex<State<O, E>>,
    /// Wakes the helm.
    news: Condvar,
    /// Wakes an engine on demand.
    call: Condvar,
    has_given_up: AtomicBool,
    is_in_trouble: AtomicBool,
}

impl<O, E> Shared<O, E> {
    /// A thread that panicked while it held the lock left whole values behind: every change of them is a single step.
    fn state(&self) -> MutexGuard<'_, State<O, E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Both ends; an engine that finds more than `capacity` entries waiting is behind.
#[must_use]
pub fn hand_over<O, E>(pace: Pace, capacity: usize) -> (Helm<O, E>, Engine<O, E>) {
    let state = State { order: None, entries: Vec::new(), is_helm_gone: false, is_engine_gone: false };
    let shared = Arc::new(Shared {
        state: Mutex::new(state),
        news: Condvar::new(),
        call: Condvar::new(),
        has_given_up: AtomicBool::new(false),
        is_in_trouble: AtomicBool::new(false),
    });
    let helm = Helm { shared: Arc::clone(&shared) };
    (helm, Engine { shared, pace, capacity, kept: Vec::new(), is_behind: false })
}

/// The end that orders, records and asks.
pub struct Helm<O, E> {
    shared: Arc<Shared<O, E>>,
}

impl<O, E> Helm<O, E> {
    /// Gives an order. The one before it must have ended.
    pub fn order(&self, order: O) {
        self.shared.state().order = Some(order);
        self.shared.call.notify_all();
    }

    /// Waits for entries and takes all there are into `entries`, which is empty; `false` when the engine has ended and nothing is left.
    pub fn take(&self, entries: &mut Vec<E>) -> bool {
        let mut state = self.shared.state();
        while state.entries.is_empty() && !state.is_engine_gone {
            state = self.shared.news.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        std::mem::swap(entries, &mut state.entries);
        drop(state);
        self.shared.call.notify_all();
        !entries.is_empty()
    }

    /// Says that nothing is recorded any more.
    pub fn give_up(&self) {
        self.shared.has_given_up.store(true, Ordering::SeqCst);
    }

    /// Whether the engine has something to say that cannot wait for the next order.
    #[must_use]
    pub fn is_in_trouble(&self) -> bool {
        self.shared.is_in_trouble.load(Ordering::SeqCst)
    }
}

impl<O, E> Drop for Helm<O, E> {
    fn drop(&mut self) {
        self.give_up();
        self.shared.state().is_helm_gone = true;
        self.shared.call.notify_all();
    }
}

/// The end that ticks the rig.
pub struct Engine<O, E> {
    shared: Arc<Shared<O, E>>,
    pace: Pace,
    capacity: usize,
    /// Not yet handed over.
    kept: Vec<E>,
    is_behind: bool,
}

impl<O, E> Engine<O, E> {
    /// What to do next. On demand it waits for an order; in real time it does not.
    pub fn next(&mut self) -> Next<O> {
        let shared = Arc::clone(&self.shared);
        let mut state = match self.pace {
            Pace::OnDemand => shared.state(),
            Pace::RealTime => match shared.state.try_lock() {
                Ok(state) => state,
                Err(TryLockError::Poisoned(left)) => left.into_inner(),
                Err(TryLockError::WouldBlock) => return Next::Nothing,
            },
        };
        self.hand(&mut state);
        loop {
            if let Some(order) = state.order.take() {
                return Next::Order(order);
            }
            if state.is_helm_gone {
                return Next::Over;
            }
            if self.pace == Pace::RealTime {
                return Next::Nothing;
            }
            state = shared.call.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Hands an entry over. In real time it is dropped where too many wait already.
    pub fn offer(&mut self, entry: E) {
        if self.is_behind {
            return;
        }
        self.kept.push(entry);
        if self.pace == Pace::RealTime || self.kept.len() >= BATCH {
            self.hand_over();
        }
    }

    /// Hands an entry over that must arrive: at once, or in real time as soon as the lock is free.
    pub fn put(&mut self, entry: E) {
        self.kept.push(entry);
        self.hand_over();
    }

    /// Whether what happens now is no longer recorded: the helm has given up or is gone, or too much waits for it.
    #[must_use]
    pub fn is_unrecorded(&self) -> bool {
        self.is_behind || self.shared.has_given_up.load(Ordering::SeqCst)
    }

    /// Tells the helm, which may be waiting for a person, that something cannot wait.
    pub fn call(&self) {
        self.shared.is_in_trouble.store(true, Ordering::SeqCst);
    }

    /// Nothing is left to be ticked: from now on it may wait.
    pub fn wait_from_now_on(&mut self) {
        self.pace = Pace::OnDemand;
    }

    fn hand_over(&mut self) {
        let shared = Arc::clone(&self.shared);
        match self.pace {
            Pace::RealTime => {
                match shared.state.try_lock() {
                    Ok(mut state) => self.hand(&mut state),
                    Err(TryLockError::Poisoned(left)) => self.hand(&mut left.into_inner()),
                    Err(TryLockError::WouldBlock) => {}
                }
                self.is_behind |= self.kept.len() > self.capacity;
            }
            Pace::OnDemand => {
                let mut state = shared.state();
                while state.entries.len() >= self.capacity && !state.is_helm_gone {
                    state = shared.call.wait(state).unwrap_or_else(PoisonError::into_inner);
                }
                self.hand(&mut state);
            }
        }
    }

    fn hand(&mut self, state: &mut State<O, E>) {
        if self.kept.is_empty() {
            return;
        }
        state.entries.append(&mut self.kept);
        self.is_behind |= self.pace == Pace::RealTime && state.entries.len() > self.capacity;
        self.shared.news.notify_all();
    }
}

impl<O, E> Drop for Engine<O, E> {
    /// Nothing is ticked any more, so that the lock may be waited for.
    fn drop(&mut self) {
        let shared = Arc::clone(&self.shared);
        let mut state = shared.state();
        state.entries.append(&mut self.kept);
        state.is_engine_gone = true;
        drop(state);
        shared.news.notify_all();
    }
}
