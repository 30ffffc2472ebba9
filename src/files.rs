//! The one door to the outside: every scene, include, model and image is read through [`Files`].
//!
//! [`DiskFiles`] reads the disk, [`MemoryFiles`] serves tests and embedded scenes. Both record what was
//! opened, which proves that what a scene does not use is not loaded.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// Read access to named files.
pub trait Files: Sync + Send {
    /// The whole content. Fails as the file system does; directories are an error.
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>>;

    /// Whether a file (not a directory) of this name can be read.
    fn exists(&self, path: &Path) -> bool;

    /// How many bytes a file has, found out without opening it; `None` if there is no such file.
    fn size(&self, path: &Path) -> Option<u64>;

    /// Names of the entries of a directory, for tolerant look-up (letter case, backslashes); empty if unreadable.
    fn list(&self, dir: &Path) -> Vec<String>;

    /// The paths given to [`Files::read`] so far that were read, in order.
    fn opened(&self) -> Vec<PathBuf>;
}

/// The files of the machine. Inputs above `max_bytes` are refused.
pub struct DiskFiles {
    opened: Mutex<Vec<PathBuf>>,
    max_bytes: u64,
}

impl Default for DiskFiles {
    fn default() -> Self {
        DiskFiles {
            opened: Mutex::default(),
            max_bytes: 4 << 30,
        }
    }
}

impl Files for DiskFiles {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        let meta = std::fs::metadata(path)?;
        if meta.is_dir() {
            return Err(io::Error::other("is a directory, expected a file"));
        }
        if meta.len() > self.max_bytes {
            let (found, most) = (meta.len(), self.max_bytes);
            return Err(io::Error::other(format!(
                "is {found} bytes long, at most {most} are read"
            )));
        }
        let data = read_whole(path, meta.len())?;
        self.opened
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .push(path.to_owned());
        Ok(data)
    }

    fn exists(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn size(&self, path: &Path) -> Option<u64> {
        let meta = std::fs::metadata(path).ok()?;
        meta.is_file().then_some(meta.len())
    }

    fn list(&self, dir: &Path) -> Vec<String> {
        let dir = if dir.as_os_str().is_empty() {
            Path::new(".")
        } else {
            dir
        };
        let Ok(entries) = std::fs::read_dir(dir) else {
            return Vec::new();
        };
        let mut names: Vec<String> = entries
            .flatten()
            .map(|e| e.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.opened.lock().unwrap_or_else(|e| e.into_inner()).clone()
    }
}

/// The content of a file of (most likely) `length` bytes, which is held only once.
fn read_whole(path: &Path, length: u64) -> io::Result<Arc<[u8]>> {
    let mut file = std::fs::File::open(path)?;
    let length = usize::try_from(length).map_err(io::Error::other)?;
    let mut data: Arc<[u8]> = std::iter::repeat_n(0, length).collect();
    let buffer = Arc::get_mut(&mut data).unwrap_or(&mut []);
    let is_whole = file.read_exact(buffer).is_ok() && file.read(&mut [0])? == 0;
    // Devices and files that change have another length than they say.
    if is_whole {
        Ok(data)
    } else {
        Ok(std::fs::read(path)?.into())
    }
}

/// Files held in memory, by path.
#[derive(Default)]
pub struct MemoryFiles {
    files: BTreeMap<PathBuf, Arc<[u8]>>,
    opened: Mutex<Vec<PathBuf>>,
}

impl MemoryFiles {
    /// Adds or replaces a file.
    pub fn insert(&mut self, path: impl Into<PathBuf>, data: impl Into<Arc<[u8]>>) {
        self.files.insert(path.into(), data.into());
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        let data = self.files.get(path).cloned();
        let data = data.ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "no such file"))?;
        self.opened
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .push(path.to_owned());
        Ok(data)
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.contains_key(path)
    }

    fn size(&self, path: &Path) -> Option<u64> {
        self.files.get(path).map(|data| data.len() as u64)
    }

    fn list(&self, dir: &Path) -> Vec<String> {
        let inside = self.files.keys().filter_map(|p| p.strip_prefix(dir).ok());
        let first = inside.filter_map(|p| p.iter().next());
        let mut names: Vec<String> = first.map(|n| n.to_string_lossy().into_owned()).collect();
        names.dedup();
        names
    }

    fn opened(&self) -> Vec<PathBuf> {
        self.opened.lock().unwrap_or_else(|e| e.into_inner()).clone()
    }
}
