//! Units: no panic, and the text of a unit and of its dimension read back the same.
#![no_main]

use froude_records::units::{Dimension, parse_unit, parse_unit_for, question};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(unit) = parse_unit(text) {
        assert!(unit.factor.is_finite() && unit.factor > 0.0, "{unit:?}");
        assert_eq!(parse_unit(&unit.to_string()).as_ref(), Ok(&unit));
        let si = parse_unit(&unit.dimension.to_string()).expect("the SI unit of a dimension is a unit");
        assert_eq!((si.dimension, si.factor), (unit.dimension, 1.0));
        let _ = (question("w_z", &unit), question("angle", &unit));
    }
    for dimension in [Dimension::FORCE, Dimension::MOMENT, Dimension::PRESSURE, Dimension::ANGULAR_SPEED] {
        if let Ok((unit, _)) = parse_unit_for(text, dimension) {
            assert_eq!(unit.dimension, dimension);
            assert_eq!(parse_unit(&unit.to_string()).as_ref(), Ok(&unit));
        }
    }
});
