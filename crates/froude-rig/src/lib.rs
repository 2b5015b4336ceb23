//! Digital twin of the towing carriage, and the drivers of the real one.
