//! Whether the tests will find a graphics adapter, and installing one where that is allowed.
//!
//! Nothing here links a graphics library. A Vulkan adapter is taken to exist where both the loader
//! (`libvulkan.so.1`) and a driver's manifest (`vulkan/icd.d/*.json`, in the folders in which the
//! loader itself looks) are installed; an OpenGL one where `libEGL.so.1` and a vendor's manifest
//! (`glvnd/egl_vendor.d/*.json`) are. Mesa's software drivers count: they are what machines
//! without a GPU have. Outside of Linux the system brings its own drivers.

use crate::steps::run;
use std::{
    env,
    path::{Path, PathBuf},
    process::Command,
};

/// Debian's package of Vulkan drivers; it brings the loader and a software adapter.
const PACKAGE: &str = "mesa-vulkan-drivers";

/// What is known of this machine.
#[derive(Clone, Copy, Debug)]
struct Machine {
    /// A Vulkan loader and a driver are installed.
    vulkan: bool,
    /// EGL and a driver are installed.
    opengl: bool,
    /// There is `apt-get`, and this program runs as root.
    may_install: bool,
}

/// What to do before the tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Plan {
    /// A Vulkan adapter is there.
    Ready,
    /// None, but the package that brings one may be installed.
    Install,
    /// None, but OpenGL will do.
    OpenGl,
    /// No adapter at all.
    Fail,
}

fn plan(machine: Machine) -> Plan {
    match machine {
        Machine { vulkan: true, .. } => Plan::Ready,
        Machine { may_install: true, .. } => Plan::Install,
        Machine { opengl: true, .. } => Plan::OpenGl,
        _ => Plan::Fail,
    }
}

/// Makes sure that the tests find an adapter; false, with a message, where they cannot.
pub(crate) fn set_up() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let mut machine = Machine::look();
    if plan(machine) == Plan::Install {
        if !install() {
            eprintln!("warning: {PACKAGE} could not be installed");
        }
        // Tried once: from here on the machine counts as one that may not install.
        machine = Machine { may_install: false, ..Machine::look() };
    }
    match plan(machine) {
        Plan::Ready => true,
        Plan::OpenGl => {
            eprintln!("note: no Vulkan driver is installed, so the tests use OpenGL. {}", advice());
            true
        }
        Plan::Install | Plan::Fail => {
            eprintln!("error: the tests need a graphics adapter and none is installed. {}", advice());
            false
        }
    }
}

/// The one command that installs a Vulkan adapter.
fn advice() -> String {
    format!(
        "Install a software Vulkan driver: sudo apt-get install --yes {PACKAGE} \
         (elsewhere than on Debian and Ubuntu: Mesa's Vulkan drivers, by whatever name)"
    )
}

/// Installs the package, with fresh package lists where the present ones do not serve.
fn install() -> bool {
    let apt = |arguments: &[&str]| {
        run(Command::new("apt-get").args(arguments).env("DEBIAN_FRONTEND", "noninteractive"))
    };
    let install = || apt(&["install", "--yes", "--no-install-recommends", PACKAGE]);
    install() || (apt(&["update"]) && install())
}

impl Machine {
    fn look() -> Self {
        let environment = |name: &str| env::var(name).ok().filter(|value| !value.is_empty());
        let libraries = library_folders(&environment);
        let holds = |library: &str| libraries.iter().any(|folder| folder.join(library).exists());
        Self {
            vulkan: holds("libvulkan.so.1") && has_driver(&environment),
            opengl: holds("libEGL.so.1")
                && egl_folders(&environment).iter().any(|folder| has_manifest(folder)),
            may_install: Path::new("/usr/bin/apt-get").exists() && is_root(),
        }
    }
}

fn is_root() -> bool {
    let user = Command::new("id").arg("-u").output();
    user.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

/// Where the dynamic linker finds libraries: the user's folders, the system's and, one level
/// deeper, those of each architecture.
fn library_folders(environment: &impl Fn(&str) -> Option<String>) -> Vec<PathBuf> {
    let mut folders = paths(environment("LD_LIBRARY_PATH"));
    for root in ["/usr/local/lib", "/usr/lib64", "/lib64", "/usr/lib", "/lib"] {
        folders.push(root.into());
        folders.extend(entries(Path::new(root)).into_iter().filter(|entry| entry.is_dir()));
    }
    folders
}

/// Whether the Vulkan loader would find a driver's manifest. Variables that name manifests (or
/// folders of them) replace its search.
fn has_driver(environment: &impl Fn(&str) -> Option<String>) -> bool {
    let named = environment("VK_DRIVER_FILES").or_else(|| environment("VK_ICD_FILENAMES"));
    if named.is_some() {
        return paths(named).iter().any(|path| path.is_file() || has_manifest(path));
    }
    vulkan_folders(environment).iter().any(|folder| has_manifest(folder))
}

/// The folders of drivers' manifests, as the Vulkan loader documents them.
fn vulkan_folders(environment: &impl Fn(&str) -> Option<String>) -> Vec<PathBuf> {
    let home = |folder: &str| environment("HOME").map(|home| format!("{home}/{folder}"));
    let or = |name: &str, default: &str| environment(name).or_else(|| Some(default.to_owned()));
    [
        environment("XDG_CONFIG_HOME").or_else(|| home(".config")),
        or("XDG_CONFIG_DIRS", "/etc/xdg"),
        Some("/usr/local/etc:/etc".to_owned()),
        environment("XDG_DATA_HOME").or_else(|| home(".local/share")),
        or("XDG_DATA_DIRS", "/usr/local/share:/usr/share"),
    ]
    .into_iter()
    .flat_map(paths)
    .map(|folder| folder.join("vulkan/icd.d"))
    .collect()
}

fn egl_folders(environment: &impl Fn(&str) -> Option<String>) -> Vec<PathBuf> {
    let named = paths(environment("__EGL_VENDOR_LIBRARY_DIRS"));
    if named.is_empty() {
        return vec!["/etc/glvnd/egl_vendor.d".into(), "/usr/share/glvnd/egl_vendor.d".into()];
    }
    named
}

/// The paths of a colon-separated list.
fn paths(list: Option<String>) -> Vec<PathBuf> {
    let list = list.unwrap_or_default();
    list.split(':').filter(|part| !part.is_empty()).map(PathBuf::from).collect()
}

fn has_manifest(folder: &Path) -> bool {
    entries(folder).iter().any(|entry| entry.extension().is_some_and(|extension| extension == "json"))
}

/// What a folder holds; nothing where it cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = folder.read_dir() else { return Vec::new() };
    entries.filter_map(|entry| Some(entry.ok()?.path())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_to_do_follows_from_what_is_there() {
        let plan = |vulkan, opengl, may_install| plan(Machine { vulkan, opengl, may_install });
        for (opengl, may_install) in [(false, false), (false, true), (true, false), (true, true)] {
            assert_eq!(plan(true, opengl, may_install), Plan::Ready);
        }
        assert_eq!(plan(false, false, true), Plan::Install);
        assert_eq!(plan(false, true, true), Plan::Install);
        assert_eq!(plan(false, true, false), Plan::OpenGl);
        assert_eq!(plan(false, false, false), Plan::Fail);
    }

    #[test]
    fn the_advice_is_a_command() {
        assert!(advice().contains("sudo apt-get install --yes mesa-vulkan-drivers"));
    }

    /// An environment of one variable.
    fn only<'a>(name: &'a str, value: &'a str) -> impl Fn(&str) -> Option<String> + 'a {
        move |asked| (asked == name).then(|| value.to_owned())
    }

    #[test]
    fn the_folders_of_drivers_follow_the_environment() {
        let folders = vulkan_folders(&|_| None);
        assert!(folders.contains(&"/etc/vulkan/icd.d".into()));
        assert!(folders.contains(&"/usr/share/vulkan/icd.d".into()));
        let folders = vulkan_folders(&only("XDG_DATA_DIRS", "/a::/b"));
        assert!(folders.contains(&"/a/vulkan/icd.d".into()) && folders.contains(&"/b/vulkan/icd.d".into()));
        assert!(!folders.contains(&"/usr/share/vulkan/icd.d".into()));
        let folders = vulkan_folders(&only("HOME", "/home/u"));
        assert!(folders.contains(&"/home/u/.local/share/vulkan/icd.d".into()));
    }

    #[test]
    fn a_driver_is_a_manifest_where_the_loader_looks() {
        let data = env::temp_dir().join(format!("sheen-xtask-{}", std::process::id()));
        let folder = data.join("vulkan/icd.d");
        fs::create_dir_all(&folder).unwrap();
        let has_driver = |name: &str, path: &Path| has_driver(&only(name, path.to_str().unwrap()));
        fs::write(folder.join("readme.txt"), "").unwrap();
        let manifest = folder.join("driver.json");
        assert!(!has_driver("VK_DRIVER_FILES", &folder));
        assert!(!has_driver("VK_ICD_FILENAMES", &manifest));
        fs::write(&manifest, "{}").unwrap();
        assert!(has_driver("VK_DRIVER_FILES", &folder));
        assert!(has_driver("VK_ICD_FILENAMES", &manifest));
        assert!(has_driver("XDG_DATA_DIRS", &data));
        fs::remove_dir_all(data).unwrap();
    }
}
