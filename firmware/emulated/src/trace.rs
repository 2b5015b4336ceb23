//! Follows single steps of the controller, instruction by instruction, and bounds the cycles that they take on a Cortex-A8.
//!
//! QEMU's debugger stub stops at `traced_step`; from there every instruction is executed alone until it returns. Each program
//! counter is looked up in the disassembly, and each instruction belongs to a class with a worst-case cost:
//!
//! | class | cycles | why |
//! | --- | --- | --- |
//! | integer, branch | 2 | dual issue takes half a cycle at best, load-use and mispredictions cost more: 2 is the bound of the budget |
//! | load or store of several registers | 2 + one each | two registers a cycle at best |
//! | double add, subtract | 10 | VFPLite is not pipelined; ARM DDI 0344, table 16.25, upper ends |
//! | double multiply | 17 | " |
//! | double multiply-accumulate | 26 | " |
//! | double divide, square root | 65 | " |
//! | compare, absolute value, negate, move within the unit | 7 | " |
//! | conversion | 8 | " |
//! | flags or registers from the unit to the core | 21 | the core waits until the unit's pipeline is empty |
//! | other NEON | 4 | |
//!
//! Caches are on and warm; a miss is not in the bound.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::process::{Command, Stdio};

/// Classes of instructions and what each costs at most, cycles.
pub const CLASSES: [(&str, u32); 9] = [
    ("integer", 2),
    ("add", 10),
    ("multiply", 17),
    ("multiply-accumulate", 26),
    ("divide", 65),
    ("compare", 7),
    ("convert", 8),
    ("to core", 21),
    ("neon", 4),
];

/// Class and cost of an instruction, from its mnemonic and operands.
#[must_use]
pub fn class(mnemonic: &str, operands: &str) -> (usize, u32) {
    let registers = || operands.split(['{', '}']).nth(1).map_or(1, count_registers);
    let fixed = |class: usize| (class, CLASSES[class].1);
    let base = mnemonic.split('.').next().unwrap_or(mnemonic);
    if !base.starts_with('v') {
        let is_multiple = ["push", "pop", "ldm", "stm"].iter().any(|multiple| base.starts_with(multiple));
        return (0, if is_multiple { 2 + registers() } else { 2 });
    }
    let is = |names: &[&str]| names.iter().any(|name| base.starts_with(name));
    if is(&["vldm", "vstm", "vpush", "vpop"]) {
        (0, 2 + 2 * registers()) // a double is two words
    } else if is(&["vldr", "vstr"]) {
        (0, 3)
    } else if is(&["vmrs"]) || is(&["vmov"]) && operands.starts_with('r') {
        fixed(7)
    } else if !mnemonic.contains(".f") && !is(&["vmov"]) {
        fixed(8)
    } else if is(&["vmla", "vmls", "vnmla", "vnmls"]) {
        fixed(3)
    } else if is(&["vmul", "vnmul"]) {
        fixed(2)
    } else if is(&["vadd", "vsub"]) {
        fixed(1)
    } else if is(&["vdiv", "vsqrt"]) {
        fixed(4)
    } else if is(&["vcvt"]) {
        fixed(6)
    } else {
        fixed(5) // vcmp, vabs, vneg, vmov
    }
}

/// How many registers `r4, r6-r8` names.
fn count_registers(list: &str) -> u32 {
    let number = |name: &str| match name.trim() {
        "sl" => 10,
        "fp" => 11,
        "ip" => 12,
        "sp" => 13,
        "lr" => 14,
        "pc" => 15,
        other => other.trim_start_matches(|c: char| c.is_ascii_alphabetic()).parse::<u32>().unwrap_or(0),
    };
    list.split(',').map(|part| part.split_once('-').map_or(1, |(from, to)| number(to) - number(from) + 1)).sum()
}

/// Class and cost of the instruction at each address.
pub type Listing = BTreeMap<u32, (usize, u32)>;

/// The disassembly: what stands at each address, and where `symbol` is.
///
/// # Errors
///
/// When the disassembler cannot be run.
pub fn disassemble(image: &Path, symbol: &str) -> io::Result<(Listing, u32)> {
    let output = Command::new("arm-none-eabi-objdump").args(["-d", "--no-show-raw-insn"]).arg(image).output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut instructions = BTreeMap::new();
    let mut found = 0;
    for line in text.lines() {
        if let Some((address, name)) = line.split_once(" <").filter(|(_, name)| name.ends_with(">:")) {
            if name.trim_end_matches(">:") == symbol {
                found = u32::from_str_radix(address, 16).unwrap_or(0);
            }
            continue;
        }
        let Some((address, rest)) = line.split_once(":\t") else { continue };
        let Ok(address) = u32::from_str_radix(address.trim(), 16) else { continue };
        let mut parts = rest.splitn(2, '\t');
        let (mnemonic, operands) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
        instructions.insert(address, class(mnemonic.trim(), operands));
    }
    Ok((instructions, found))
}

/// One step, followed.
#[derive(Debug, Clone, Copy, Default)]
pub struct Followed {
    /// Instructions of each class.
    pub count: [u32; CLASSES.len()],
    /// Cycles that they take at most.
    pub cycles: u32,
}

impl Followed {
    /// All instructions.
    #[must_use]
    pub fn instructions(&self) -> u32 {
        self.count.iter().sum()
    }
}

/// Runs an image and follows every call of `symbol`. What the image printed comes with it.
///
/// # Errors
///
/// When emulator or disassembler cannot be run, or the emulator says what is not understood.
pub fn follow(image_name: &str, symbol: &str) -> io::Result<(Vec<Followed>, String)> {
    let (instructions, start) = disassemble(&crate::image(image_name), symbol)?;
    let socket = std::env::temp_dir().join(format!("froude-{}-debugger.socket", std::process::id()));
    let listener = UnixListener::bind(&socket)?;
    let child = crate::emulator(image_name)
        .args(["-serial", "null", "-icount", "shift=10,sleep=off,align=off", "-S", "-chardev"])
        .arg(format!("socket,id=debugger,path={}", socket.display()))
        .args(["-gdb", "chardev:debugger"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let (stream, _) = listener.accept()?;
    let _ = std::fs::remove_file(&socket);
    let mut debugger = Debugger { stream, bytes: Vec::new() };
    debugger.ask("qXfer:features:read:target.xml:0,ff")?; // from now on it answers for single registers
    debugger.ask(&format!("Z0,{start:x},4"))?;
    let mut all = Vec::new();
    loop {
        let stopped = debugger.ask("c")?;
        if !stopped.starts_with('T') {
            break; // it has ended
        }
        let back = debugger.register(14)?;
        let mut followed = Followed::default();
        let mut at = debugger.register(15)?;
        while at != back {
            let &(class, cycles) =
                instructions.get(&at).ok_or_else(|| io::Error::other(format!("no instruction at {at:#x}")))?;
            followed.count[class] += 1;
            followed.cycles += cycles;
            debugger.ask("s")?;
            at = debugger.register(15)?;
        }
        all.push(followed);
    }
    let output = child.wait_with_output()?;
    Ok((all, String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)))
}

/// GDB's remote protocol, as much as is needed.
struct Debugger {
    stream: UnixStream,
    bytes: Vec<u8>,
}

impl Debugger {
    fn ask(&mut self, what: &str) -> io::Result<String> {
        let sum = what.bytes().fold(0_u8, u8::wrapping_add);
        self.stream.write_all(format!("${what}#{sum:02x}").as_bytes())?;
        loop {
            let begin = self.bytes.iter().position(|&b| b == b'$');
            let end = self.bytes.iter().position(|&b| b == b'#');
            if let (Some(begin), Some(end)) = (begin, end)
                && self.bytes.len() >= end + 3
            {
                let answer = String::from_utf8_lossy(&self.bytes[begin + 1..end]).into_owned();
                self.bytes.drain(..end + 3);
                // An emulator that ends says so and goes: nobody is left to hear that it was heard.
                let is_last = answer.starts_with(['W', 'X']);
                return match self.stream.write_all(b"+") {
                    Err(e) if !(is_last && e.kind() == io::ErrorKind::BrokenPipe) => Err(e),
                    _ => Ok(answer),
                };
            }
            let mut chunk = [0; 512];
            match self.stream.read(&mut chunk)? {
                0 => return Ok(String::new()),
                len => self.bytes.extend_from_slice(&chunk[..len]),
            }
        }
    }

    fn register(&mut self, number: u32) -> io::Result<u32> {
        let answer = self.ask(&format!("p{number:x}"))?;
        u32::from_str_radix(&answer, 16)
            .map(u32::swap_bytes)
            .map_err(|_| io::Error::other(format!("register {number}: {answer:?}")))
    }
}
