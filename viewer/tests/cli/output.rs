//! Disks that are full, and files that may not grow.
#![cfg(target_os = "linux")]

use crate::common::{Folder, PROGRAM, Ran};
use crate::reference::folder;
use std::process::Command;

/// Every command that writes, each 256 x 256 pixels to `disk/out.exr`.
const COMMANDS: [&str; 3] = [
    "render scene.toml --environment none --size 256x256 -o disk/out.exr",
    "reference scene.toml --size 256x256 --spp 1 -o disk/out.exr",
    "merge whole.exr -o disk/out.exr",
];

/// A folder with the scene, a reference, and an empty folder `disk`.
fn folder_with_disk() -> Folder {
    let folder = folder();
    std::fs::create_dir(folder.path().join("disk")).unwrap();
    folder
        .run(&["reference", "scene.toml", "--size", "256x256", "--spp", "1", "-o", "whole.exr"])
        .expect(0, &[]);
    folder
}

/// Runs a script there; `$SHEEN` is the program.
fn script(folder: &Folder, text: &str) -> Ran {
    let mut command = Command::new("sh");
    command.args(["-c", text]).current_dir(folder.path()).env("SHEEN", PROGRAM);
    Ran(command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap())
}

#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let folder = folder_with_disk();
    for command in COMMANDS {
        // In a mount namespace of its own, so that nobody else sees the disk.
        let ran = script(
            &folder,
            &format!(
                "exec 2>&1; unshare -rm sh -c 'mount -t tmpfs -o size=64k none disk || exit 77; echo old > disk/out.exr; \
             \"$SHEEN\" {command}; echo status $?; ls -A disk; cat disk/out.exr'"
            ),
        );
        if ran.status() != 0 {
            eprintln!("skipped: no file system can be mounted here: {}", ran.out());
            return;
        }
        ran.expect(0, &["status 1\nout.exr\nold\n", "error: disk/out.exr: output: found No space left"]);
    }
}

#[test]
fn a_read_only_disk_is_found_before_the_work() {
    let folder = folder_with_disk();
    for command in COMMANDS {
        let ran = script(
            &folder,
            &format!(
                "exec 2>&1; unshare -rm sh -c 'mount -t tmpfs -o ro none disk || exit 77; \
             \"$SHEEN\" {command}; echo status $?; ls -A disk'"
            ),
        );
        if ran.status() != 0 {
            eprintln!("skipped: no file system can be mounted here: {}", ran.out());
            return;
        }
        ran.expect(0, &["error: disk/out.exr: output: found Read-only file system"]);
        assert!(ran.out().ends_with("status 1\n"), "{}", ran.out());
    }
}

#[test]
fn a_limit_on_file_sizes_leaves_nothing_half_written() {
    let folder = folder_with_disk();
    for command in COMMANDS {
        // The signal of the limit is ignored, so that writing fails as on a full disk.
        let ran = script(
            &folder,
            &format!(
                "exec 2>&1; trap '' XFSZ; ulimit -f 4; \"$SHEEN\" {command}; echo status $?; ls -A disk"
            ),
        );
        ran.expect(0, &["error: disk/out.exr: output: found File too large"]);
        assert!(ran.out().ends_with("status 1\n"), "nothing is left: {}", ran.out());
        // Without, the program is killed in the middle.
        let ran = script(
            &folder,
            &format!(
                "exec 2>&1; ulimit -c 0; ulimit -f 4; \"$SHEEN\" {command}; ls disk; rm -f disk/.sheen-*"
            ),
        );
        assert!(!ran.out().contains("out.exr\n"), "{}", ran.out());
    }
}
