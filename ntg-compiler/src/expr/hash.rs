//! Maps and sets by node: looked up, never iterated, so that their order cannot show.
//!
//! The standard library's hasher defends servers against chosen keys and takes most of
//! the time of a pass; ours mixes each word by one multiplication, as ids deserve.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// A map that is looked up and never iterated.
pub type Map<K, V> = HashMap<K, V, BuildHasherDefault<Mixer>>;

/// A set that is asked and never iterated.
pub type Set<K> = HashSet<K, BuildHasherDefault<Mixer>>;

/// An odd number near 2^64 divided by the golden ratio: multiples of it spread evenly
/// (D. E. Knuth, The Art of Computer Programming, vol. 3, section 6.4).
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// How far the state is turned before each word, so that the order of words matters.
const TURN: u32 = 26;

/// The hasher; see the module's header.
#[derive(Clone, Copy, Default)]
pub struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        // The table takes low bits, and multiplication mixes upwards.
        self.0.rotate_left(TURN) ^ self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(size_of::<u64>()) {
            let mut word = [0; size_of::<u64>()];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u32(&mut self, word: u32) {
        self.write_u64(u64::from(word));
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(TURN) ^ word).wrapping_mul(SPREAD);
    }

    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }

    fn write_i32(&mut self, word: i32) {
        self.write_u64(u64::from(word.cast_unsigned()));
    }

    fn write_isize(&mut self, word: isize) {
        self.write_u64(word.cast_unsigned() as u64);
    }
}
