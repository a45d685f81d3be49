//! What is put back when this process is interrupted. Its children end because it does.

use std::path::Path;
use std::process::exit;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

/// The shell's exit code for a command ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

type Hooks = Vec<Box<dyn FnOnce() + Send>>;

/// Runs `hook` when this process is interrupted, before it exits with code 130: for what must be put back, such as the
/// terminal's mode.
pub fn on_interrupt(hook: impl FnOnce() + Send + 'static) {
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        // Fails only if the program has a handler of its own already, which then has the say.
        let _ = ctrlc::set_handler(|| {
            hooks().drain(..).for_each(|hook| hook());
            exit(INTERRUPTED);
        });
    });
    hooks().push(Box::new(hook));
}

/// An interrupt takes this folder away too, which no value is dropped for.
pub fn remove_on_interrupt(folder: &Path) {
    let folder = folder.to_owned();
    // It may be gone already.
    on_interrupt(move || drop(std::fs::remove_dir_all(folder)));
}

/// A panic elsewhere must not keep a hook from running, so a poisoned lock is as good as any.
fn hooks() -> MutexGuard<'static, Hooks> {
    static HOOKS: Mutex<Hooks> = Mutex::new(Vec::new());
    HOOKS.lock().unwrap_or_else(PoisonError::into_inner)
}
