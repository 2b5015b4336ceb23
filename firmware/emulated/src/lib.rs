//! Runs the images in QEMU and talks to them over an emulated serial line.
//!
//! QEMU connects to a Unix socket that the test listens on, so nothing has to be waited for or guessed. What passes through a
//! socket proves commands, not timing: virtual time goes on while the host thinks.

use std::io::{self, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE, Received};
use froude_link::{FromBoard, ToBoard};

pub mod noise;
pub mod trace;

/// The image of this name, as `cargo xtask firmware` leaves it.
///
/// # Panics
///
/// When it has not been built.
#[must_use]
pub fn image(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/armv7a-none-eabihf/release").join(name);
    assert!(path.exists(), "{} is missing: build the images with `cargo xtask firmware`", path.display());
    path
}

/// The emulator with an image, its serial port and counting still open.
#[must_use]
pub fn emulator(image_name: &str) -> Command {
    let mut command = Command::new("qemu-system-arm");
    command.args([
        "-M",
        "realview-pb-a8",
        "-display",
        "none",
        "-audiodev",
        "none,id=n",
        "-monitor",
        "none",
        "-semihosting",
    ]);
    command.arg("-kernel").arg(image(image_name)).stdin(Stdio::null());
    command
}

/// Runs an image without a host until it ends itself, counting instructions: one takes 2^`shift` ns of virtual time.
///
/// # Errors
///
/// When the emulator cannot be started.
///
/// # Panics
///
/// When the image says that something failed.
pub fn run_alone(image_name: &str, shift: u8, arguments: &[&str]) -> io::Result<String> {
    let output = emulator(image_name)
        .args(["-serial", "null", "-icount", &format!("shift={shift},sleep=off,align=off")])
        .args(arguments)
        .output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{image_name} ended with {}:\n{text}", output.status);
    Ok(text)
}

/// A board in the emulator at the other end of a serial line.
pub struct Board {
    child: Child,
    stream: UnixStream,
    socket: PathBuf,
    reader: FrameReader<FromBoard>,
    writer: FrameWriter,
    bytes: Vec<u8>,
    taken: usize,
    /// As which session the host speaks.
    pub session: u32,
    /// What happens to frames on their way to the board.
    pub outward: noise::Line,
    /// What happens to frames on their way to the host.
    pub inward: noise::Line,
}

impl Board {
    /// Starts an image and waits until the emulator has connected.
    ///
    /// # Errors
    ///
    /// When the emulator cannot be started or does not connect.
    pub fn start(image_name: &str) -> io::Result<Self> {
        static NEXT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let socket = std::env::temp_dir().join(format!("froude-{}-{number}.socket", std::process::id()));
        let listener = UnixListener::bind(&socket)?;
        let child = emulator(image_name)
            .arg("-chardev")
            .arg(format!("socket,id=line,path={}", socket.display()))
            .args(["-serial", "chardev:line"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let (stream, _) = listener.accept()?;
        stream.set_read_timeout(Some(Duration::from_millis(4)))?;
        Ok(Self {
            child,
            stream,
            socket,
            reader: FrameReader::new(),
            writer: FrameWriter::default(),
            bytes: Vec::new(),
            taken: 0,
            session: 1,
            outward: noise::Line::clean(),
            inward: noise::Line::clean(),
        })
    }

    /// Sends a message, through whatever the line does to it.
    ///
    /// # Errors
    ///
    /// When the emulator is gone.
    pub fn send(&mut self, message: &ToBoard) -> io::Result<()> {
        let mut wire = [0; MAX_WIRE];
        let frame = self.writer.write(&message.from_session(self.session), &mut wire);
        let bytes = self.outward.pass(frame);
        self.stream.write_all(&bytes)
    }

    /// The next message, if one comes within 4 ms.
    ///
    /// # Errors
    ///
    /// When the emulator is gone.
    pub fn receive(&mut self) -> io::Result<Option<Received<FromBoard>>> {
        loop {
            while let Some(&byte) = self.bytes.get(self.taken) {
                self.taken += 1;
                if let Some(received) = self.reader.feed(byte) {
                    return Ok(Some(received));
                }
            }
            let mut chunk = [0; 4096];
            let len = match self.stream.read(&mut chunk) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(len) => len,
                Err(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => return Ok(None),
                Err(e) => return Err(e),
            };
            (self.bytes, self.taken) = (self.inward.pass_stream(&chunk[..len]), 0);
        }
    }

    /// The first message that `wanted` takes, sending `message` again when 4 ms bring nothing, then 8, and so on, until it comes.
    ///
    /// # Errors
    ///
    /// When the emulator is gone, or nothing comes for a minute.
    pub fn ask<T>(&mut self, message: &ToBoard, wanted: impl Fn(&FromBoard) -> Option<T>) -> io::Result<T> {
        let started = Instant::now();
        // A busy host slows the emulator: asking again too soon would only bury the first question.
        let mut patience = Duration::from_millis(4);
        while started.elapsed() < Duration::from_mins(1) {
            self.send(message)?;
            let sent = Instant::now();
            let mut heard = sent;
            while heard.elapsed() < patience && sent.elapsed() < 25 * patience {
                if let Some(received) = self.receive()? {
                    if let Some(answer) = wanted(&received.message) {
                        return Ok(answer);
                    }
                    heard = Instant::now();
                }
            }
            patience = (2 * patience).min(Duration::from_secs(2));
        }
        Err(io::Error::new(io::ErrorKind::TimedOut, format!("no answer to {message:?}")))
    }

    /// What the host's reader has counted.
    #[must_use]
    pub fn counts(&self) -> froude_link::frame::LinkCounts {
        self.reader.counts()
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_file(&self.socket);
    }
}
