//! A real Slurm on this machine, for as long as a value lives: munge, a controller, and virtual nodes, all in a temporary folder, without cgroups, systemd or a database.

use std::collections::BTreeMap;
use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const NODES: usize = 2;

pub struct Lab {
    folder: tempfile::TempDir,
    munged: Child,
    controller: Child,
    nodes: Vec<Child>,
}

impl Lab {
    /// Starts it; `None` where it is not installed, which on the pipeline is an error.
    pub fn start() -> Option<Self> {
        let tools = ["munged", "slurmctld", "slurmd", "sbatch"];
        if let Some(absent) = tools.into_iter().find(|tool| program(tool).is_none()) {
            assert!(std::env::var_os("CI").is_none(), "{absent} is not installed: packages slurm-wlm and munge");
            println!("left out: {absent} is not installed");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        for name in ["munge", "state", "spool", "log"] {
            fs::create_dir(root.join(name)).unwrap();
        }
        for open in [root.to_owned(), root.join("munge")] {
            fs::set_permissions(open, fs::Permissions::from_mode(0o755)).unwrap();
        }
        let key = root.join("munge/key");
        fs::write(&key, [7; 128]).unwrap();
        fs::set_permissions(&key, fs::Permissions::from_mode(0o600)).unwrap();
        let arg = |name: &str, file: &str| format!("--{name}={}", root.join("munge").join(file).display());
        let munged = spawn(
            Command::new(program("munged").unwrap()).args(["--foreground", "--force", "--num-threads=2"]).args([
                arg("key-file", "key"),
                arg("socket", "socket"),
                arg("pid-file", "pid"),
                arg("log-file", "log"),
                arg("seed-file", "seed"),
            ]),
        );
        wait("munged", || root.join("munge/socket").exists());
        let ports: Vec<TcpListener> = (0..=NODES).map(|_| TcpListener::bind("127.0.0.1:0").unwrap()).collect();
        let numbers: Vec<u16> = ports.iter().map(|p| p.local_addr().unwrap().port()).collect();
        fs::write(root.join("slurm.conf"), configuration(root, &numbers)).unwrap();
        drop(ports);
        let conf = root.join("slurm.conf");
        let daemon = |name: &str| {
            let mut command = Command::new(program(name).unwrap());
            command.env("SLURM_CONF", &conf);
            command
        };
        let controller = spawn(daemon("slurmctld").args(["-D", "-c"]));
        let nodes = (1..=NODES).map(|n| spawn(daemon("slurmd").args(["-D", "-N", &format!("lab{n}")]))).collect();
        let lab = Self { folder, munged, controller, nodes };
        wait("the nodes", || lab.ask("sinfo", &["-h", "-N", "-t", "idle", "-o", "%N"]).lines().count() == NODES);
        Some(lab)
    }

    pub fn conf(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    /// What a program of Slurm says.
    pub fn ask(&self, name: &str, arguments: &[&str]) -> String {
        let output = Command::new(name).args(arguments).env("SLURM_CONF", self.conf()).output().unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Ends a node's daemon, the shepherds of its jobs, which outlive it, and the jobs, at one blow.
    pub fn kill_node(&mut self, name: &str) {
        let number: usize = name.strip_prefix("lab").unwrap().parse().unwrap();
        let log = self.folder.path().join("log").join(format!("{name}.log"));
        let _ = self.nodes[number - 1].kill();
        let _ = self.nodes[number - 1].wait();
        kill_shepherds(&|path| path == log);
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        let root = self.folder.path().to_owned();
        for child in self.nodes.iter_mut().chain([&mut self.controller, &mut self.munged]) {
            let _ = child.kill();
            let _ = child.wait();
        }
        kill_shepherds(&|path| path.starts_with(&root));
    }
}

fn configuration(root: &Path, ports: &[u16]) -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap().trim().to_owned();
    let host = host.split('.').next().unwrap().to_owned();
    let root = root.display();
    let nodes: String = (1..=NODES)
        .map(|n| {
            let port = ports[n];
            format!("NodeName=lab{n} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=8 RealMemory=1000\n")
        })
        .collect();
    let user = if rustix::process::geteuid().is_root() { "root".to_owned() } else { std::env::var("USER").unwrap() };
    format!(
        "ClusterName=lab
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={root}/munge/socket,cred_expire=5
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0,bf_interval=1,defer_batch=0
PriorityType=priority/basic
KillWait=2
UnkillableStepTimeout=20
MessageTimeout=2
SlurmctldTimeout=10
SlurmdTimeout=6
ReturnToService=2
JobRequeue=1
SlurmdParameters=config_overrides
MinJobAge=300
MaxArraySize=5
AccountingStorageType=accounting_storage/none
StateSaveLocation={root}/state
SlurmdSpoolDir={root}/spool/%n
SlurmctldPidFile={root}/slurmctld.pid
SlurmdPidFile={root}/%n.pid
SlurmctldLogFile={root}/log/slurmctld.log
SlurmdLogFile={root}/log/%n.log
{nodes}PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
",
        ports[0]
    )
}

fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/sbin".into()]);
    folders.map(|folder| folder.join(name)).find(|file| file.is_file())
}

fn spawn(command: &mut Command) -> Child {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

pub fn wait(what: &str, is_done: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_done() {
        assert!(start.elapsed() < Duration::from_secs(40), "{what}: not after 40 s");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Kills the shepherds that write to such a log, with all below them.
fn kill_shepherds(is_its_log: &dyn Fn(&Path) -> bool) {
    let mut children: BTreeMap<i32, Vec<i32>> = BTreeMap::new();
    let mut doomed = Vec::new();
    for entry in fs::read_dir("/proc").unwrap().flatten() {
        let Some(pid) = entry.file_name().to_str().and_then(|n| n.parse::<i32>().ok()) else { continue };
        let Ok(stat) = fs::read_to_string(entry.path().join("stat")) else { continue };
        let Some((name, behind)) = stat.rsplit_once(')') else { continue };
        let parent = behind.split_whitespace().nth(1).and_then(|p| p.parse().ok()).unwrap_or(0);
        children.entry(parent).or_default().push(pid);
        let logs = fs::read_dir(entry.path().join("fd")).into_iter().flatten().flatten();
        let mut targets = logs.filter_map(|fd| fs::read_link(fd.path()).ok());
        if name.ends_with("(slurmstepd") && targets.any(|path| is_its_log(&path)) {
            doomed.push(pid);
        }
    }
    while let Some(pid) = doomed.pop() {
        doomed.extend(children.remove(&pid).unwrap_or_default());
        if let Some(pid) = rustix::process::Pid::from_raw(pid) {
            let _ = rustix::process::kill_process(pid, rustix::process::Signal::KILL);
        }
    }
}
