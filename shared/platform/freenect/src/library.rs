//! Search and loading of the C library.

#![expect(unsafe_code, reason = "loading a library runs its initialisers")]

use crate::mapped_file::mapped_file;
use crate::raw::Api;
use crate::{Error, LibraryKind};
use std::path::{Path, PathBuf};
use std::{env, fmt, fs};

/// File names of the library in order of preference: Debian's, then those of other versions and
/// of development packages.
const FILE_NAMES: [&str; 3] = ["libfreenect.so.0.5", "libfreenect.so.0", "libfreenect.so"];
/// Folder of fakenect, next to the real library.
const FAKE_FOLDER: &str = "fakenect";

/// Loaded library. It stays loaded until the last camera opened with it is dropped.
#[derive(Debug)]
pub struct Library {
    api: Api,
    kind: LibraryKind,
    file: Option<PathBuf>,
    // Declared last, so that the functions above never outlive it.
    _loaded: libloading::Library,
}

impl fmt::Debug for Api {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.optional_symbols()).finish()
    }
}

impl Library {
    /// Searches the system's folders for the library and loads it.
    ///
    /// The real library is requested by name from the dynamic linker, then searched for in the
    /// multi-arch folders; fakenect only in their `fakenect/` sub-folders.
    ///
    /// # Errors
    /// If there is none, with every place tried, or if the file found is not libfreenect 0.5.
    pub fn load(kind: LibraryKind) -> Result<Self, Error> {
        let mut tried = Vec::new();
        for candidate in candidates(kind, &library_folders()) {
            // SAFETY: the names are those of libfreenect, installed by the machine's
            // administrator, whose libraries this process trusts as it trusts libc.
            match unsafe { Self::load_file(&candidate, kind) } {
                Ok(library) if library.is_of_its_kind() => return Ok(library),
                Ok(library) => tried.push((candidate, library.mismatch())),
                Err(LoadError::NotLoaded(error)) => tried.push((candidate, error.to_string())),
                Err(LoadError::Unusable(error)) => return Err(error),
            }
        }
        Err(Error::LibraryMissing { kind, tried })
    }

    /// Loads a self-built libfreenect.
    ///
    /// # Errors
    /// If it cannot be loaded or is not libfreenect 0.5.
    ///
    /// # Safety
    /// The file must be a build of libfreenect 0.5, or behave like one: its
    /// initialisers run now, its functions are called with that interface.
    pub unsafe fn load_from(file: &Path, kind: LibraryKind) -> Result<Self, Error> {
        // SAFETY: the caller vouches for the file.
        unsafe { Self::load_file(file, kind) }.map_err(|error| match error {
            LoadError::NotLoaded(error) => Error::LibraryMissing {
                kind,
                tried: vec![(file.to_owned(), error.to_string())],
            },
            LoadError::Unusable(error) => error,
        })
    }

    /// Loads a library file and looks up its functions.
    ///
    /// # Safety
    /// As for [`Self::load_from`].
    unsafe fn load_file(file: &Path, kind: LibraryKind) -> Result<Self, LoadError> {
        // SAFETY: the caller vouches for the library's initialisers.
        let loaded = unsafe { libloading::Library::new(file) }.map_err(LoadError::NotLoaded)?;
        // SAFETY: the caller vouches for the signatures.
        let api = unsafe { Api::look_up(&loaded) }.map_err(|(symbol, source)| {
            let library = file.to_owned();
            LoadError::Unusable(Error::SymbolMissing {
                library,
                symbol,
                source,
            })
        })?;
        let mapped = mapped_file(api.init as *const () as usize);
        Ok(Self {
            api,
            kind,
            file: mapped,
            _loaded: loaded,
        })
    }

    /// Kind of the library: libfreenect or fakenect.
    pub fn kind(&self) -> LibraryKind {
        self.kind
    }

    /// File the library was loaded from, if the kernel reports it.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Version parsed from the file name, such as `0.5.3` for Debian's. The library itself has no
    /// function for it.
    pub fn version(&self) -> Option<&str> {
        self.file()?
            .file_name()?
            .to_str()?
            .split_once(".so.")
            .map(|(_, version)| version)
    }

    /// Optional functions with their availability.
    pub fn optional_symbols(&self) -> Vec<(&'static str, bool)> {
        self.api.optional_symbols()
    }

    pub(crate) fn api(&self) -> &Api {
        &self.api
    }

    /// `true` if the linker loaded the requested kind. Both libraries have the same name, so a
    /// search path in the environment, or fakenect loaded earlier, can yield the wrong one.
    fn is_of_its_kind(&self) -> bool {
        let is_fake = |file: &Path| {
            file.parent()
                .is_some_and(|folder| folder.ends_with(FAKE_FOLDER))
        };
        self.file()
            .is_none_or(|file| is_fake(file) == (self.kind == LibraryKind::Fake))
    }

    fn mismatch(&self) -> String {
        let file = self.file.as_deref().unwrap_or(Path::new("?"));
        format!(
            "the linker gave {} instead; is LD_LIBRARY_PATH set?",
            file.display()
        )
    }
}

/// Reason for rejecting a library file.
enum LoadError {
    /// Library that was not found or is not a library: the next place is tried.
    NotLoaded(libloading::Error),
    /// Library that was found but is unusable.
    Unusable(Error),
}

/// Library files to try in order.
fn candidates(kind: LibraryKind, folders: &[PathBuf]) -> Vec<PathBuf> {
    let in_folders = |sub: &'static str| {
        folders.iter().flat_map(move |folder| {
            FILE_NAMES
                .iter()
                .map(move |name| folder.join(sub).join(name))
        })
    };
    match kind {
        LibraryKind::Real => FILE_NAMES
            .iter()
            .map(PathBuf::from)
            .chain(in_folders(""))
            .collect(),
        LibraryKind::Fake => in_folders(FAKE_FOLDER).collect(),
    }
}

/// Library folders of this machine: Debian's multi-arch folder and the classic ones.
fn library_folders() -> Vec<PathBuf> {
    let multi_arch = format!("/usr/lib/{}-linux-gnu", env::consts::ARCH);
    let mut folders = vec![PathBuf::from(multi_arch)];
    // Covers architectures whose triplet is spelled differently, such as 32-bit ARM.
    if let Ok(entries) = fs::read_dir("/usr/lib") {
        let name_of = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
        let mut others: Vec<PathBuf> = entries
            .flatten()
            .filter(|entry| name_of(entry).contains("-linux-gnu"))
            .map(|entry| entry.path())
            .filter(|path| !folders.contains(path))
            .collect();
        others.sort();
        folders.append(&mut others);
    }
    folders.extend(["/usr/lib64", "/usr/lib", "/usr/local/lib"].map(PathBuf::from));
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_real_library_is_asked_by_name_first() {
        let folders = [PathBuf::from("/usr/lib/x86_64-linux-gnu")];
        let places = candidates(LibraryKind::Real, &folders);
        assert_eq!(places[0], Path::new("libfreenect.so.0.5"));
        assert_eq!(
            places[3],
            Path::new("/usr/lib/x86_64-linux-gnu/libfreenect.so.0.5")
        );
    }

    #[test]
    fn the_fake_library_is_only_taken_from_its_folder() {
        let folders = [PathBuf::from("/usr/lib"), PathBuf::from("/usr/local/lib")];
        let places = candidates(LibraryKind::Fake, &folders);
        assert_eq!(places.len(), 6);
        assert!(
            places
                .iter()
                .all(|place| place.parent().unwrap().ends_with("fakenect"))
        );
    }

    #[test]
    fn a_missing_library_names_the_places_and_the_package() {
        // SAFETY: there is no such file.
        let result =
            unsafe { Library::load_from(Path::new("/nonexistent/libx.so"), LibraryKind::Fake) };
        let sentence = result.unwrap_err().to_string();
        for part in [
            "fakenect",
            "/nonexistent/libx.so",
            "install the Debian package libfreenect0.5",
        ] {
            assert!(sentence.contains(part), "{sentence}");
        }
    }

    #[test]
    fn a_library_without_the_functions_is_named() {
        // SAFETY: the C library is loaded anyway; none of its functions is called.
        let result = unsafe { Library::load_from(Path::new("libc.so.6"), LibraryKind::Real) };
        let sentence = result.unwrap_err().to_string();
        assert!(
            sentence.contains("libc.so.6 is not libfreenect 0.5"),
            "{sentence}"
        );
        assert!(sentence.contains("freenect_init"), "{sentence}");
    }
}
