//! A disk that is soon full.

use std::path::Path;
use std::process::Command;

/// A small file system of its own, unmounted at the end; `None` where this user may not mount.
pub struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    /// `size` as `mount` takes it: `40k`.
    pub fn mount(size: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let done = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"])
            .arg(folder.path())
            .output();
        done.is_ok_and(|o| o.status.success()).then_some(Self(folder))
    }

    /// Where it is mounted.
    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}
