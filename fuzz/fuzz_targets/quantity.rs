//! Quantities: no panic, finite, and the text reads back to the same bits.
#![no_main]

use froude_records::units::parse_quantity;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(quantity) = parse_quantity(text) {
        assert!(quantity.value_si.is_finite(), "{quantity:?}");
        let again = parse_quantity(&quantity.to_string()).expect("a written quantity is a quantity");
        assert_eq!(again.value.to_bits(), quantity.value.to_bits());
        assert_eq!(again, quantity);
    }
});
