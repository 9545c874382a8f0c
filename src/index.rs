//! From 64-bit hashes to numbers.

/// The numbers of things that are counted from 0, found by their hashes: a table of open addressing with linear probing.
///
/// A slot holds the whole hash beside the number, so that a probe reads one place in memory and looks at a thing only where it almost
/// surely is the one that is looked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    /// A power of two of slots, at most three quarters of them taken; [`FREE`] where free.
    slots: Vec<Slot>,
}

/// The lower and the upper half of a hash, and a number. Three small numbers, because they then take 12 bytes and not 16.
type Slot = [u32; 3];

/// A slot without a number. Nothing has the number that it would hold: fewer than `u32::MAX` things are ever counted.
const FREE: Slot = [u32::MAX; 3];

/// What of a hash stands in a slot.
#[inline]
fn halves(hash: u64) -> [u32; 2] {
    [hash as u32, (hash >> 32) as u32]
}

impl Index {
    /// The number of the thing with this hash that `is` the right one, if it has one.
    #[inline]
    pub(crate) fn find(&self, hash: u64, is: impl Fn(u32) -> bool) -> Option<u32> {
        if self.slots.is_empty() { None } else { self.probe(hash, is).ok() }
    }

    /// The same, or else the free slot where the number belongs. Some slot must be free.
    #[inline]
    pub(crate) fn probe(&self, hash: u64, is: impl Fn(u32) -> bool) -> Result<u32, usize> {
        let mask = self.slots.len() - 1;
        let [low, high] = halves(hash);
        let mut place = hash as usize & mask;
        loop {
            let [l, h, number] = self.slots[place];
            if number == FREE[2] {
                return Err(place);
            }
            if l == low && h == high && is(number) {
                return Ok(number);
            }
            place = (place + 1) & mask;
        }
    }

    /// Puts `number` into the slot that a probe for `hash` found to be free.
    #[inline]
    pub(crate) fn take(&mut self, place: usize, hash: u64, number: u32) {
        let [low, high] = halves(hash);
        self.slots[place] = [low, high, number];
    }

    /// Sees to it that there is a slot for one more than the things that have these hashes.
    #[inline]
    pub(crate) fn make_room(&mut self, hashes: &[u64]) {
        if 4 * hashes.len() >= 3 * self.slots.len() {
            self.rebuild(hashes, 2 * hashes.len());
        }
    }

    /// Makes the index anew: of the things that have these hashes, with room for `count`.
    #[cold]
    pub(crate) fn rebuild(&mut self, hashes: &[u64], count: usize) {
        self.slots.clear();
        self.slots.resize((count.max(8) * 4).div_ceil(3).next_power_of_two(), FREE);
        for (number, &hash) in hashes.iter().enumerate() {
            if let Err(place) = self.probe(hash, |_| false) {
                self.take(place, hash, number as u32);
            }
        }
    }
}
