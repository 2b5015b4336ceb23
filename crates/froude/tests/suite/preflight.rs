//! What the pre-flight asks of a run is what the reduction needs of it.

use froude::methods::carriage::drag::steady::SteadySettings;
use froude::rig::campaign::preflight::{SHORTEST_STEADY_S, SHORTEST_STILL_S};

#[test]
fn the_preflight_asks_for_the_steady_part_and_the_stand_still_that_the_reduction_needs() {
    let s = SteadySettings::default();
    assert_eq!(SHORTEST_STEADY_S, s.settle_s + s.corner_s + s.shortest_s);
    assert_eq!(SHORTEST_STILL_S, s.still_settle_s + s.shortest_s);
}
