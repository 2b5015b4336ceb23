//! Two processes and one port: the second is refused, whoever it runs as, and comes in when the first has died.
//!
//! Without a harness, because the second process is this program again: `port PATH` opens the port, says how that went, and holds it
//! until it is killed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[cfg(unix)]
fn main() {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    match asked.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["port", path] => unix::hold(path),
        ["--list", ..] => {}
        _ => unix::two_processes_and_one_port(),
    }
}

#[cfg(not(unix))]
fn main() {}

#[cfg(unix)]
mod unix {
    use std::io::{BufRead, BufReader};
    use std::os::fd::AsRawFd;
    use std::process::{Child, Command, Stdio};

    use froude_rig::drive::RigError;
    use froude_rig::drive::port::Port;

    pub fn hold(path: &str) {
        match Port::open(path, 115_200) {
            Ok(_port) => {
                println!("opened");
                loop {
                    std::thread::park();
                }
            }
            Err(error) => println!("{error}"),
        }
    }

    fn another(path: &str) -> (Child, String) {
        let mut child =
            Command::new(std::env::current_exe().unwrap()).args(["port", path]).stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        (child, line.trim().to_owned())
    }

    pub fn two_processes_and_one_port() {
        let (_far, near) = serial2::SerialPort::pair().unwrap();
        let path = std::fs::read_link(format!("/proc/self/fd/{}", near.as_raw_fd())).unwrap();
        let path = path.to_str().unwrap();
        let is_root = rustix::process::geteuid().is_root();
        let refusal = format!(
            "{path} is in use by another program, and only one may drive a board; end that one (`fuser {path}` names it), then run again"
        );

        let (mut first, said) = another(path);
        assert_eq!(said, "opened");
        let settings = near.get_configuration().unwrap().get_baud_rate().unwrap();
        assert_eq!(settings, 115_200);
        let error = Port::open(path, 9_600).map(|_| ()).unwrap_err();
        assert!(matches!(error, RigError::InUse { .. }), "{error}");
        assert_eq!(error.to_string(), refusal);
        // The first one's settings are as they were.
        assert_eq!(near.get_configuration().unwrap().get_baud_rate().unwrap(), 115_200);
        let (mut second, said) = another(path);
        assert_eq!(said, refusal);
        second.wait().unwrap();

        // TIOCEXCL keeps out every other program, except root's.
        let opened = std::fs::OpenOptions::new().read(true).write(true).open(path);
        assert_eq!(opened.is_ok(), is_root, "{opened:?}");

        first.kill().unwrap();
        first.wait().unwrap();
        let (mut third, said) = another(path);
        assert_eq!(said, "opened", "the lock dies with its process");
        third.kill().unwrap();
        third.wait().unwrap();
        println!("two processes and one port (root: {is_root}): ok");
    }
}
