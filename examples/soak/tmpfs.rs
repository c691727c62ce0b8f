//! A small disk in memory, where this may be mounted.

use crate::program::Told;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A mounted disk; unmounted when dropped.
#[derive(Debug)]
pub(crate) struct Tmpfs(PathBuf);

impl Tmpfs {
    /// A disk of so many KiB at a folder; `None` where that is not allowed here.
    pub(crate) fn mount(at: &Path, kib: u64) -> Option<Tmpfs> {
        std::fs::create_dir_all(at).ok()?;
        let mounted = quietly("mount").args(["-t", "tmpfs", "-o", &format!("size={kib}k"), "tmpfs"]).arg(at).status();
        mounted.is_ok_and(|status| status.success()).then(|| Tmpfs(at.to_owned()))
    }

    /// Changes the disk: `size=64m`, `ro`, `rw`.
    pub(crate) fn remount(&self, options: &str) -> Told<()> {
        let mounted = quietly("mount").args(["-o", &format!("remount,{options}")]).arg(&self.0).status();
        match mounted {
            Ok(status) if status.success() => Ok(()),
            other => Err(format!("mount -o remount,{options} {}: {other:?}", self.0.display())),
        }
    }
}

impl Drop for Tmpfs {
    fn drop(&mut self) {
        drop(quietly("umount").arg("-l").arg(&self.0).status());
    }
}

fn quietly(program: &str) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}
