//! Broken files for every parser: mutates good files and checks that a parser answers each with a
//! scene or a one-line error, without a panic and in bounded memory.
//!
//! Memory is measured for the whole process. A test binary that uses this module should therefore
//! hold mutation tests only; they wait for each other.

use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use fastrand::Rng;
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// One at a time, or the memory of one parser would be charged to another.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// What a parser may allocate for any input, …
const MEMORY_FLOOR: usize = 64 << 20;
/// … and for each byte of it: the widest that a legal file grows (a bit or two becomes a float).
const MEMORY_PER_BYTE: usize = 64;
/// Far more than any input of some kilobytes takes on a busy machine; a loop over 2⁶³ takes longer.
const TIME_LIMIT: Duration = Duration::from_secs(20);

/// Feeds `runs` mutations of the `corpus` to `parse`, always the same ones for the same name.
///
/// Every corpus entry must be a file that parses: what is refused at its first byte tests nothing.
///
/// # Panics
/// With the number of the run, and the input written to the temporary folder, when `parse` panics,
/// takes too much memory or time, or gives an error that is not one line.
pub(crate) fn mutate_and_parse<T, E: Display>(
    name: &str,
    corpus: &[Vec<u8>],
    runs: usize,
    parse: impl Fn(&[u8]) -> Result<T, E>,
) {
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    for (i, good) in corpus.iter().enumerate() {
        if let Err(error) = parse(good) {
            panic!("{name}: corpus entry {i} does not parse: {error}");
        }
    }
    let mut rng = Rng::with_seed(seed_of(name));
    let mut accepted = 0;
    for run in 0..runs {
        let input = mutated(corpus, &mut rng);
        match check(&input, &parse) {
            Ok(parsed) => accepted += usize::from(parsed),
            Err(complaint) => {
                let path = std::env::temp_dir().join(format!("{name}-{run}.bin"));
                std::fs::write(&path, &input).expect("the temporary folder is writable");
                panic!("{name}, run {run}: {complaint}; the input is in {}", path.display());
            }
        }
    }
    println!("{name}: {runs} mutated files, {accepted} still a scene, the others refused");
}

fn seed_of(name: &str) -> u64 {
    name.bytes().fold(7, |seed: u64, b| seed.wrapping_mul(31).wrapping_add(u64::from(b)))
}

/// Whether the input was accepted, or what is wrong with how it was handled.
fn check<T, E: Display>(
    input: &[u8],
    parse: &impl Fn(&[u8]) -> Result<T, E>,
) -> Result<bool, String> {
    ALLOCATOR.reset_peak_usage();
    let before = ALLOCATOR.current_usage();
    let start = Instant::now();
    let result =
        catch_unwind(AssertUnwindSafe(|| parse(input).map(drop).map_err(|e| e.to_string())));
    let (elapsed, memory) = (start.elapsed(), ALLOCATOR.peak_usage().saturating_sub(before));
    let message = match result {
        Err(_) => return Err("panicked".into()),
        Ok(Ok(())) => None,
        Ok(Err(message)) => Some(message),
    };
    if memory > MEMORY_FLOOR + MEMORY_PER_BYTE * input.len() {
        return Err(format!("took {memory} bytes for a file of {}", input.len()));
    }
    if elapsed > TIME_LIMIT {
        return Err(format!("took {elapsed:?}"));
    }
    match &message {
        Some(m) if m.is_empty() || m.chars().any(char::is_control) || m.chars().count() > 400 => {
            Err(format!("the error is not one short line: {m:?}"))
        }
        _ => Ok(message.is_none()),
    }
}

/// A corpus entry after one to four random changes.
fn mutated(corpus: &[Vec<u8>], rng: &mut Rng) -> Vec<u8> {
    let mut bytes = corpus[rng.usize(..corpus.len())].clone();
    for _ in 0..rng.usize(1..=4) {
        match rng.usize(..6) {
            0 => flip_bytes(&mut bytes, rng),
            1 => bytes.truncate(rng.usize(..=bytes.len())),
            2 => edit_decimal(&mut bytes, rng),
            3 => edit_binary_count(&mut bytes, rng),
            4 => splice(&mut bytes, &corpus[rng.usize(..corpus.len())], rng),
            _ => remove_or_repeat(&mut bytes, rng),
        }
    }
    bytes
}

fn flip_bytes(bytes: &mut [u8], rng: &mut Rng) {
    for _ in 0..rng.usize(1..=8) {
        if let Some(byte) = rng.choice(bytes.iter_mut()) {
            *byte = if rng.bool() { rng.u8(..) } else { *byte ^ (1 << rng.usize(..8)) };
        }
    }
}

/// Replaces a decimal number in a text header.
fn edit_decimal(bytes: &mut Vec<u8>, rng: &mut Rng) {
    const NUMBERS: [&str; 10] = [
        "0",
        "1",
        "-1",
        "255",
        "4294967296",
        "9223372036854775807",
        "9223372036854775808",
        "18446744073709551615",
        "99999999999999999999999",
        "1e308",
    ];
    let starts: Vec<usize> = (0..bytes.len())
        .filter(|&i| bytes[i].is_ascii_digit() && (i == 0 || !bytes[i - 1].is_ascii_digit()))
        .collect();
    if let Some(start) = rng.choice(starts) {
        let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
        let number = NUMBERS[rng.usize(..NUMBERS.len())];
        bytes.splice(start..start + digits, number.bytes());
    }
}

/// Overwrites two, four or eight bytes with a count that tends to hurt.
fn edit_binary_count(bytes: &mut [u8], rng: &mut Rng) {
    const COUNTS: [u64; 9] =
        [0, 1, 0x7fff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 1 << 32, 1 << 63, u64::MAX];
    let count = COUNTS[rng.usize(..COUNTS.len())];
    let width = [2, 4, 8][rng.usize(..3)];
    let encoded = if rng.bool() {
        count.to_le_bytes()
    } else {
        count.rotate_left(64 - 8 * width).to_be_bytes()
    };
    if let Some(last) = bytes.len().checked_sub(width as usize) {
        // Most counts are near the start of a file.
        let at = if rng.bool() { rng.usize(..=last) } else { rng.usize(..=last.min(64)) };
        bytes[at..at + width as usize].copy_from_slice(&encoded[..width as usize]);
    }
}

/// Copies a piece of another file over or into this one.
fn splice(bytes: &mut Vec<u8>, other: &[u8], rng: &mut Rng) {
    let from = random_range(other.len(), rng);
    let at = rng.usize(..=bytes.len());
    let replaced = if rng.bool() { from.len().min(bytes.len() - at) } else { 0 };
    bytes.splice(at..at + replaced, other[from].iter().copied());
}

fn remove_or_repeat(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let range = random_range(bytes.len(), rng);
    if rng.bool() {
        bytes.drain(range);
    } else {
        let (piece, at) = (bytes[range.clone()].to_vec(), range.end);
        bytes.splice(at..at, piece);
    }
}

/// Up to 256 bytes somewhere.
fn random_range(len: usize, rng: &mut Rng) -> std::ops::Range<usize> {
    let start = rng.usize(..=len);
    start..start + rng.usize(..=(len - start).min(256))
}
