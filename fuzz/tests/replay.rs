//! The corpus and bytes of a seeded generator through all targets, on the ordinary toolchain.
//!
//! `ASPERITY_FUZZ_INPUTS` is another number of them, `ASPERITY_FUZZ_SEED` takes
//! others, `ASPERITY_FUZZ_PATIENCE` are the seconds after which one counts as hanging.

use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use asperity_fuzz::TARGETS;

/// Time after which an input counts as one that hangs; ordinary ones take some milliseconds.
const HANGS: Duration = Duration::from_secs(120);

/// Inputs that take longer are listed in the folder `ASPERITY_FUZZ_FINDINGS`, with all findings.
const SLOW: Duration = Duration::from_millis(200);

/// Inputs per target beside the corpus: some seconds each.
const INPUTS: usize = 1000;

#[test]
fn sets_keep_their_word() {
    replay("sets");
}

#[test]
fn one_contact_keeps_its_word() {
    replay("one_contact");
}

#[test]
fn many_contacts_keep_their_word() {
    replay("many_contacts");
}

#[test]
fn events_keep_their_word() {
    replay("events");
}

#[test]
fn steps_keep_their_word() {
    replay("steps");
}

fn setting(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().expect("a whole number"))
}

fn replay(name: &str) {
    let check = TARGETS.iter().find(|(target, _)| *target == name).unwrap().1;
    let count = setting("ASPERITY_FUZZ_INPUTS").map_or(INPUTS, |n| n as usize);
    let watch = Watch::default();
    let (mut findings, mut slow) = (Vec::new(), Vec::new());
    std::thread::scope(|scope| {
        scope.spawn(|| watch.guard(name));
        let mut inputs = corpus(name);
        inputs.sort();
        let mut random = Random(setting("ASPERITY_FUZZ_SEED").unwrap_or(1) ^ hash(name));
        let total = inputs.len() + count;
        for k in 0..total {
            let input = match inputs.get(k) {
                Some((_, bytes)) => bytes.clone(),
                None => random.bytes(),
            };
            watch.begin(&input);
            let began = Instant::now();
            if let Err(cause) = std::panic::catch_unwind(|| check(&input)) {
                let text = cause
                    .downcast_ref::<String>()
                    .cloned()
                    .or_else(|| cause.downcast_ref::<&str>().map(|s| (*s).to_owned()))
                    .unwrap_or_default();
                findings.push(format!("{}: {text}", hex(&input)));
            }
            if began.elapsed() > SLOW {
                slow.push(format!("{:?} {}", began.elapsed(), hex(&input)));
            }
        }
        watch.done.store(true, Ordering::Relaxed);
    });
    if let Ok(folder) = std::env::var("ASPERITY_FUZZ_FINDINGS") {
        for (kind, lines) in [("findings", &findings), ("slow", &slow)] {
            let file = Path::new(&folder).join(format!("{name}.{kind}"));
            std::fs::write(file, lines.join("\n")).unwrap();
        }
    }
    assert!(findings.is_empty(), "{} findings, the first: {}", findings.len(), findings[0]);
}

/// Name and content of the committed inputs of a target.
fn corpus(name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let files = std::fs::read_dir(folder).expect("every target has a corpus");
    files
        .map(|file| {
            let path = file.unwrap().path();
            (path.display().to_string(), std::fs::read(&path).unwrap())
        })
        .collect()
}

/// Ends the process, with the input, when one does not end.
#[derive(Default)]
struct Watch {
    current: Mutex<Option<(Instant, Vec<u8>)>>,
    done: AtomicBool,
}

impl Watch {
    fn begin(&self, input: &[u8]) {
        *self.current.lock().unwrap() = Some((Instant::now(), input.to_vec()));
    }

    fn guard(&self, name: &str) {
        while !self.done.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(100));
            let patience = setting("ASPERITY_FUZZ_PATIENCE").map_or(HANGS, Duration::from_secs);
            if let Some((since, input)) = &*self.current.lock().unwrap()
                && since.elapsed() > patience
            {
                // Not `eprintln!`, which tests keep to themselves.
                let _ = writeln!(std::io::stderr(), "{name} hangs at {}", hex(input));
                std::process::exit(1);
            }
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

fn hash(name: &str) -> u64 {
    name.bytes().fold(1469598103934665603, |h, b| (h ^ u64::from(b)).wrapping_mul(1099511628211))
}

/// A 64-bit linear congruential generator: the same bytes everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        self.0 >> 16
    }

    fn bytes(&mut self) -> Vec<u8> {
        let length = 40 + self.next() % 360;
        (0..length).map(|_| self.next() as u8).collect()
    }
}
