//! From 64-bit hashes to numbers.

/// The numbers of things that are counted from 0, found by their hashes: a table of open addressing with linear probing.
///
/// A slot holds the upper half of a hash and a number, so that a probe looks at a thing only where it almost surely is the
/// one that is looked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    /// A power of two of slots, at most half of them taken; [`FREE`] where free.
    slots: Vec<u64>,
}

/// A slot without a number. Nothing has the number that it would hold: fewer than `u32::MAX` things are ever counted.
const FREE: u64 = u64::MAX;

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
        let mut place = hash as usize & mask;
        loop {
            let found = self.slots[place];
            if found == FREE {
                return Err(place);
            }
            if (found ^ hash) >> 32 == 0 && is(found as u32) {
                return Ok(found as u32);
            }
            place = (place + 1) & mask;
        }
    }

    /// Puts `number` into the slot that a probe for `hash` found to be free.
    #[inline]
    pub(crate) fn take(&mut self, place: usize, hash: u64, number: u32) {
        self.slots[place] = (hash & !u64::from(u32::MAX)) | u64::from(number);
    }

    /// Sees to it that there is a slot for one more than the things that have these hashes.
    #[inline]
    pub(crate) fn make_room(&mut self, hashes: &[u64]) {
        if 2 * hashes.len() >= self.slots.len() {
            self.rebuild(hashes, 2 * hashes.len());
        }
    }

    /// Makes the index anew: of the things that have these hashes, with room for `count`.
    #[cold]
    pub(crate) fn rebuild(&mut self, hashes: &[u64], count: usize) {
        self.slots.clear();
        self.slots.resize((2 * count.max(8)).next_power_of_two(), FREE);
        for (number, &hash) in hashes.iter().enumerate() {
            if let Err(place) = self.probe(hash, |_| false) {
                self.take(place, hash, number as u32);
            }
        }
    }
}
