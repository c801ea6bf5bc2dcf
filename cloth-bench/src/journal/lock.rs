//! A folder of results belongs to one process at a time.

use super::about;
use crate::error::BenchError;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::Path;

/// Trials before a folder counts as taken, and the pause between two.
const TRIALS: u32 = 20;
const PAUSE: std::time::Duration = std::time::Duration::from_millis(25);

/// Name of the file that is locked; it stays, with the number of the last process.
const FILE_NAME: &str = "journal.lock";

/// Held for as long as this lives. The system lets go of it when the process ends, however it ends.
#[derive(Debug)]
pub(super) struct Lock {
    _file: File,
}

impl Lock {
    /// The folder, if no other process works in it.
    pub(super) fn take(folder: &Path) -> Result<Self, BenchError> {
        let path = folder.join(FILE_NAME);
        let failed = |error: std::io::Error| about(&path, &error);
        let mut options = OpenOptions::new();
        let options = options.write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(failed)?;
        // A process that another thread is just starting holds on to all files for a moment.
        let mut taken = file.try_lock();
        for _ in 0..TRIALS {
            if !matches!(taken, Err(TryLockError::WouldBlock)) {
                break;
            }
            std::thread::sleep(PAUSE);
            taken = file.try_lock();
        }
        match taken {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let process = std::fs::read_to_string(&path).unwrap_or_default();
                return Err(BenchError::Failed(format!(
                    "{}: another run works in this folder (process {}): wait until it ends, or give another folder with --out",
                    folder.display(),
                    process.trim()
                )));
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        file.set_len(0).map_err(failed)?;
        writeln!(file, "{}", std::process::id()).map_err(failed)?;
        Ok(Self { _file: file })
    }
}
