//! What there is of drivers where no adapter comes of them: a broken driver is not a missing one.

use super::adapters::Adapter;
use super::error::GpuError;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The variables by which the Vulkan loader is told which drivers there are.
const DRIVER_VARIABLES: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];
/// Where it looks for them otherwise.
const FOLDERS: [&str; 4] =
    ["/etc/vulkan/icd.d", "/usr/share/vulkan/icd.d", "/usr/local/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
/// The variable that says what of an NVIDIA driver a container gets.
const NVIDIA_VARIABLE: &str = "NVIDIA_DRIVER_CAPABILITIES";
/// What is there where the kernel module of an NVIDIA card is.
const NVIDIA_NODE: &str = "/dev/nvidiactl";

/// The traces that drivers leave on a machine, whether or not they work.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drivers {
    /// Files that name a Vulkan driver, without their folders.
    pub manifests: Vec<String>,
    /// An NVIDIA card has its kernel module.
    pub nvidia: bool,
    /// The value of `NVIDIA_DRIVER_CAPABILITIES`.
    pub capabilities: Option<String>,
}

impl Drivers {
    /// Those of this machine; none where Vulkan is not looked for in files.
    pub fn found() -> Self {
        if cfg!(not(target_os = "linux")) {
            return Self::default();
        }
        let told = DRIVER_VARIABLES.iter().find_map(std::env::var_os);
        let places: Vec<PathBuf> = match &told {
            Some(list) => std::env::split_paths(list).collect(),
            None => FOLDERS.iter().map(PathBuf::from).collect(),
        };
        Self {
            manifests: manifests(&places),
            nvidia: Path::new(NVIDIA_NODE).exists(),
            capabilities: std::env::var(NVIDIA_VARIABLE).ok(),
        }
    }

    /// What to do where an NVIDIA card is there and Vulkan does not show it.
    pub fn hint(&self, adapters: &[Adapter]) -> Option<String> {
        let shown = |a: &Adapter| a.name.to_lowercase().contains("nvidia") || a.driver.to_lowercase().contains("nvidia");
        if !self.nvidia || adapters.iter().any(shown) {
            return None;
        }
        let is = match &self.capabilities {
            Some(value) if value.split(',').any(|part| matches!(part.trim(), "all" | "graphics")) => {
                return Some(format!("An NVIDIA card is there ({NVIDIA_NODE}), and its driver shows it to no Vulkan program."));
            }
            Some(value) => format!("it is {value}"),
            None => "it is not set".to_owned(),
        };
        Some(format!(
            "An NVIDIA card is there ({NVIDIA_NODE}), and Vulkan does not show it: in a container {NVIDIA_VARIABLE} has to \
             contain graphics ({is})."
        ))
    }

    /// The error of a machine on which no adapter was found.
    pub fn nothing_found(&self) -> GpuError {
        match self.hint(&[]) {
            None if self.manifests.is_empty() => GpuError::NoAdapter,
            hint => GpuError::BrokenDriver {
                drivers: if self.manifests.is_empty() { NVIDIA_NODE.to_owned() } else { self.manifests.join(", ") },
                hint: hint.map_or_else(String::new, |hint| format!(" {hint}")),
            },
        }
    }
}

/// The names of the files that name drivers, of which `places` are some, or folders that hold some.
fn manifests(places: &[PathBuf]) -> Vec<String> {
    let is_manifest = |path: &Path| path.extension() == Some(OsStr::new("json"));
    let mut found = Vec::new();
    for place in places {
        let inside = std::fs::read_dir(place).into_iter().flatten().flatten().map(|entry| entry.path());
        let named = place.is_file().then(|| place.clone());
        found.extend(inside.chain(named).filter(|path| is_manifest(path)).filter_map(|path| {
            let name = path.file_name()?;
            Some(name.to_string_lossy().into_owned())
        }));
    }
    found.sort_unstable();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_driver_is_not_a_missing_one() {
        assert_eq!(Drivers::default().nothing_found(), GpuError::NoAdapter);
        let broken = Drivers { manifests: vec!["nvidia_icd.json".into()], ..Drivers::default() };
        let text = broken.nothing_found().to_string();
        assert!(
            text.contains("installed (nvidia_icd.json) and none of them opens a device") && !text.contains("NVIDIA_"),
            "{text}"
        );
    }

    #[test]
    fn a_container_without_graphics_is_told_so() {
        let card = |capabilities: Option<&str>| Drivers {
            nvidia: true,
            capabilities: capabilities.map(str::to_owned),
            ..Drivers::default()
        };
        let text = card(Some("compute,utility")).nothing_found().to_string();
        assert!(text.contains("NVIDIA_DRIVER_CAPABILITIES has to contain graphics (it is compute,utility)"), "{text}");
        assert!(card(None).hint(&[]).unwrap().contains("(it is not set)"));
        for enough in ["all", "compute,graphics"] {
            assert!(!card(Some(enough)).hint(&[]).unwrap().contains("NVIDIA_DRIVER_CAPABILITIES"), "{enough}");
        }
        assert_eq!(Drivers::default().hint(&[]), None);
    }

    #[test]
    fn files_that_name_drivers_are_found_in_folders_and_by_name() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["b.json", "a.json", "notes.txt"] {
            std::fs::write(dir.path().join(name), "{}").unwrap();
        }
        assert_eq!(manifests(&[dir.path().to_owned(), dir.path().join("a.json")]), ["a.json", "b.json"]);
        assert!(manifests(&["/dev/null".into(), dir.path().join("none.json")]).is_empty());
    }
}
