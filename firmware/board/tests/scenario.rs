//! The story does what it is for: it leads the controller through its states.

use std::collections::BTreeSet;

use froude_board::rig::CONFIG;
use froude_board::scenario::{CHAPTER, Scenario, TICKS};
use froude_control::Controller;
use froude_control::fault::Fault;

#[test]
fn the_story_visits_every_phase_and_every_break_is_noticed_in_its_chapter() {
    let (mut controller, mut story) = (Controller::new(CONFIG).unwrap(), Scenario::default());
    let mut before = controller.step(&story.tick());
    let (mut faults, mut phases) = (vec![], BTreeSet::new());
    while story.number() < TICKS {
        let number = story.number();
        let output = controller.step(&story.tick());
        if let (None, Some((fault, _))) = (before.status.fault, output.status.fault) {
            faults.push((number / CHAPTER, fault));
        }
        phases.extend(output.status.axes.map(|axis| axis.phase as u8));
        before = output;
        story.follow(&output);
    }
    let expected =
        [Fault::EncoderJump, Fault::EmergencyStop, Fault::TickLate, Fault::HostSilent, Fault::AmplifierNotReady];
    assert_eq!(faults, (0..).zip(expected).collect::<Vec<_>>());
    assert_eq!(phases, (0..=6).collect(), "all phases of status::Phase");
}
