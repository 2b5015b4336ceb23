//! An hour of an axis at 10 kHz in eight channels: 36 million rows of eight doubles, 2.3 GB.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::Path;

use froude_carriage::servo::{Chain, Friction, LongServo, ServoCoefficient};

use crate::Outcome;
use crate::make::Normal;
use crate::meter::{Row, measure};

const FILE: &str = "hour.f64";
const RATE_HZ: f64 = 10_000.0;
const CHANNELS: usize = 8;
/// Rows read at a time.
const CHUNK: usize = 16_384;

/// Sum of tones in position, its force with friction, and what else a rig records: current, force at the sensor, voltage
/// of the supply, temperature, reference, clock.
pub fn make(dir: &Path, seconds: f64) -> Outcome<()> {
    std::fs::create_dir_all(dir)?;
    let mut file = BufWriter::with_capacity(1 << 20, File::create(dir.join(FILE))?);
    let mut normal = Normal::seeded(3);
    let tones = [(0.20, 0.11), (0.08, 0.53), (0.01, 2.3), (1e-3, 7.9)];
    // A disturbance that nobody records, correlated over 20 ms.
    let mut disturbance_n = 0.0;
    for i in 0..(seconds * RATE_HZ) as usize {
        let t = i as f64 / RATE_HZ;
        let (mut y, mut v, mut a) = (0.0, 0.0, 0.0);
        for (size_m, hz) in tones {
            let (w, (s, c)) = (TAU * hz, (TAU * hz * t).sin_cos());
            (y, v, a) = (y + size_m * s, v + size_m * w * c, a - size_m * w * w * s);
        }
        disturbance_n += 5e-3 * (0.05 * normal.next() * 20.0 - disturbance_n);
        let force_n = 6.0 * a + 12.0 * v + 2.5 * v.signum() + 0.3 + disturbance_n;
        let volts = force_n / 6.0;
        // The encoder's counts, 16 µm.
        let position_m = (y / 1.6e-5).round() * 1.6e-5;
        let current_a = 0.8 * volts + 0.01 * normal.next();
        let sensor_n = force_n - 6.0 * a + 0.1 * normal.next();
        let row = [position_m, volts, current_a, sensor_n, 24.0 - 0.1 * current_a.abs(), 20.0 + 1e-3 * t, y, t];
        for value in row {
            file.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(file.flush()?)
}

/// M, F_v, F_c, offset and their standard deviations, classical and HAC, read as the file goes by.
pub fn identify(dir: &Path) -> Outcome<Row> {
    let mut chain = Chain::new(6.0, Friction::symmetric());
    chain.hac_lag_s = Some(1.0);
    measure(3, || {
        let mut file = File::open(dir.join(FILE))?;
        let mut servo = LongServo::new(&chain, RATE_HZ)?;
        let mut bytes = vec![0; CHUNK * CHANNELS * 8];
        let (mut position_m, mut command_v) = (Vec::new(), Vec::new());
        loop {
            let taken = fill(&mut file, &mut bytes)?;
            let rows = bytes[..taken].as_chunks::<8>().0.as_chunks::<CHANNELS>().0;
            position_m.clear();
            command_v.clear();
            position_m.extend(rows.iter().map(|row| f64::from_le_bytes(row[0])));
            command_v.extend(rows.iter().map(|row| f64::from_le_bytes(row[1])));
            servo.push(&position_m, &command_v)?;
            if taken < bytes.len() {
                break;
            }
        }
        let found = servo.finish()?.coefficients;
        let of = |number: fn(&ServoCoefficient) -> f64| found.iter().map(number).collect::<Vec<f64>>();
        Ok([of(|c| c.value), of(|c| c.classical_std), of(|c| c.hac_std)].concat())
    })
}

/// Fills the buffer as far as the file goes.
fn fill(file: &mut File, bytes: &mut [u8]) -> Outcome<usize> {
    let mut taken = 0;
    while taken < bytes.len() {
        match file.read(&mut bytes[taken..])? {
            0 => break,
            n => taken += n,
        }
    }
    Ok(taken)
}
