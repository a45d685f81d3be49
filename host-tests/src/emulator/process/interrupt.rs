//! What is put back when this process is interrupted. Its children end because it does.

use std::path::Path;
use std::process::{ExitCode, exit};
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::{io, thread};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag::register_usize;
use signal_hook::iterator::Signals;

/// The signals that interrupt a command: Ctrl-C, a request to end, a terminal that is closed.
const INTERRUPTS: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];

/// The exit code that the shell has for a command ended by a signal, 130 after Ctrl-C; success for 0, which is none.
pub fn interrupted_by(signal: usize) -> ExitCode {
    ExitCode::from(if signal == 0 { 0 } else { 128 + signal as u8 })
}

/// The signal that has interrupted this process since, 0 as long as none has; it goes on meanwhile.
pub fn interrupted() -> io::Result<Arc<AtomicUsize>> {
    let signal = Arc::default();
    for each in INTERRUPTS {
        register_usize(each, Arc::clone(&signal), each as usize)?;
    }
    Ok(signal)
}

/// Runs `hook` when this process is interrupted, before it exits: for what must be put back, such as the terminal's mode.
pub fn on_interrupt(hook: impl FnOnce() + Send + 'static) {
    type Hook = Box<dyn FnOnce() + Send>;
    static HOOKS: Mutex<Vec<Hook>> = Mutex::new(Vec::new());
    static HANDLER: Once = Once::new();
    // A panic elsewhere must not keep a hook from running, so a poisoned lock is as good as any.
    let hooks = || HOOKS.lock().unwrap_or_else(PoisonError::into_inner);
    HANDLER.call_once(|| {
        // Fails only for signals that no program may handle.
        let Ok(mut signals) = Signals::new(INTERRUPTS) else { return };
        thread::spawn(move || {
            let Some(signal) = signals.forever().next() else { return };
            hooks().drain(..).for_each(|hook| hook());
            exit(128 + signal);
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
