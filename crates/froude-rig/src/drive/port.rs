//! A serial port for one program alone.
//!
//! On Unix the port is locked with `flock` before anything is changed on it, and then made exclusive (TIOCEXCL). The first keeps out
//! every other Froude, whoever runs it; the second every other program but root's. Both end with the process, however it ends.
//! Elsewhere a port opens once.

use std::io::{Read, Write};
use std::time::Duration;

use serial2::SerialPort;

use super::RigError;

/// A read or a write returns after so long at the latest.
const WAIT: Duration = Duration::from_millis(2);

/// An open port.
#[derive(Debug)]
pub struct Port(SerialPort);

impl Port {
    /// Opens a port, 8N1, raw, with empty buffers.
    ///
    /// # Errors
    ///
    /// [`RigError::InUse`] when another program has it, else [`RigError::Port`].
    pub fn open(port: &str, baud: u32) -> Result<Self, RigError> {
        let failed = |e: std::io::Error| match e.kind() {
            std::io::ErrorKind::WouldBlock | std::io::ErrorKind::ResourceBusy => {
                RigError::InUse { port: port.to_owned() }
            }
            _ => RigError::Port { port: port.to_owned(), reason: e.to_string() },
        };
        let mut line = alone(port, baud).map_err(failed)?;
        line.set_read_timeout(WAIT).map_err(failed)?;
        line.set_write_timeout(WAIT).map_err(failed)?;
        line.discard_buffers().map_err(failed)?;
        Ok(Self(line))
    }
}

/// Locked first and set up afterwards: the settings of a port that another program has stay as they are.
#[cfg(unix)]
fn alone(port: &str, baud: u32) -> std::io::Result<SerialPort> {
    use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
    use serial2::IntoSettings;

    let flags = OFlags::RDWR | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    let fd = open(port, flags, Mode::empty())?;
    flock(&fd, FlockOperation::NonBlockingLockExclusive)?;
    rustix::termios::ioctl_tiocexcl(&fd)?;
    let mut line = SerialPort::from(fd);
    let mut settings = line.get_configuration()?;
    baud.apply_to_settings(&mut settings)?;
    line.set_configuration(&settings)?;
    Ok(line)
}

#[cfg(not(unix))]
fn alone(port: &str, baud: u32) -> std::io::Result<SerialPort> {
    SerialPort::open(port, baud)
}

impl Read for Port {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(bytes)
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}
