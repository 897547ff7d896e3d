//! Memory that is reserved once and then given out: an allocator for libraries that may not allocate while they run.
//!
//! [`Reserve`] is a library's global allocator. Between [`Pool::enter`] and the end of its guard, everything that the
//! thread allocates comes from that pool, and outside from the system. A pool grows while it is open. Once it is
//! [sealed](Pool::seal) it has room for as much again as it has given out so far, and asks the system for nothing more;
//! should that not suffice after all, the system helps out and the pool counts it ([`Pool::counts`]).
//!
//! Blocks come in sizes of four steps a doubling, each with a list of free ones: taking and giving back cost the same few
//! instructions whatever has happened before, and a solve that repeats itself finds the blocks of the one before.
//! Before each block stands which pool it is of, so that it is given back to where it came from by whoever drops it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ptr::{self, NonNull};

/// The smallest block. A law: quarters of it are multiples of [`ALIGN`].
const SMALLEST: usize = 64;
/// What every block is aligned to, and room for its header.
const ALIGN: usize = 16;
/// Sizes of blocks: four for each power of two.
const CLASSES: usize = 4 * 48;
/// Larger blocks than needed that are looked at before a sealed pool turns to the system.
const LARGER: usize = 8;
/// The first piece of memory that a pool takes from the system.
const FIRST_CHUNK: usize = 1 << 20;
/// Pieces of memory at most: each is as large as all before together.
const CHUNKS: usize = 40;

/// The global allocator of a library whose solvers reserve their memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reserve;

/// What stands before every block.
#[derive(Clone, Copy)]
#[repr(C)]
struct Header {
    /// The pool; null for a block of the system.
    pool: *mut Pool,
    /// The class of the block's size.
    class: u32,
    /// How far the header's end is from the block's beginning.
    offset: u32,
}

/// A block that is not in use.
struct Free {
    next: *mut Free,
}

/// Memory for one solver.
pub struct Pool {
    free: [*mut Free; CLASSES],
    /// What of the last chunk was never given out.
    rest: *mut u8,
    end: *mut u8,
    chunks: [(*mut u8, usize); CHUNKS],
    count: usize,
    reserved: usize,
    /// Bytes of blocks that were ever cut from chunks.
    used: usize,
    /// Blocks in use.
    live: usize,
    is_sealed: bool,
    helped_out: u64,
}

thread_local! {
    /// The pool from which this thread allocates; null for the system.
    static CURRENT: Cell<*mut Pool> = const { Cell::new(ptr::null_mut()) };
}

/// Until it is dropped, the thread allocates from a pool.
pub struct Entered {
    before: *mut Pool,
}

impl Drop for Entered {
    fn drop(&mut self) {
        CURRENT.set(self.before);
    }
}

/// How much memory a pool has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Bytes taken from the system.
    pub reserved: usize,
    /// Bytes that were in use at some time, sizes rounded up.
    pub used: usize,
    /// Blocks that the system has given to a sealed pool.
    pub helped_out: u64,
}

impl Pool {
    /// An open pool without memory; none where the system has none for it.
    pub fn create() -> Option<NonNull<Self>> {
        let layout = Layout::new::<Self>();
        // SAFETY: a pool is not of size zero.
        let place = NonNull::new(unsafe { System.alloc(layout) }.cast::<Self>())?;
        let empty = Self {
            free: [ptr::null_mut(); CLASSES],
            rest: ptr::null_mut(),
            end: ptr::null_mut(),
            chunks: [(ptr::null_mut(), 0); CHUNKS],
            count: 0,
            reserved: 0,
            used: 0,
            live: 0,
            is_sealed: false,
            helped_out: 0,
        };
        // SAFETY: the place is new, and of this layout.
        unsafe { place.as_ptr().write(empty) };
        Some(place)
    }

    /// From now on this thread allocates from the pool.
    ///
    /// # Safety
    /// The pool was created and not released, and no other thread has entered it.
    pub unsafe fn enter(pool: NonNull<Self>) -> Entered {
        Entered { before: CURRENT.replace(pool.as_ptr()) }
    }

    /// Whether this thread allocates from a pool.
    pub fn is_entered() -> bool {
        !CURRENT.get().is_null()
    }

    /// Reserves as much again as was used, and closes the pool.
    ///
    /// # Safety
    /// As for [`Pool::enter`].
    pub unsafe fn seal(pool: NonNull<Self>) {
        // SAFETY: the caller has the pool for himself.
        let pool = unsafe { &mut *pool.as_ptr() };
        if (pool.end as usize) - (pool.rest as usize) < pool.used {
            pool.grow(pool.used);
        }
        pool.is_sealed = true;
    }

    /// How much memory it has.
    ///
    /// # Safety
    /// As for [`Pool::enter`].
    pub unsafe fn counts(pool: NonNull<Self>) -> Counts {
        // SAFETY: the caller has the pool for himself.
        let Self { reserved, used, helped_out, .. } = unsafe { pool.as_ref() };
        Counts { reserved: *reserved, used: *used, helped_out: *helped_out }
    }

    /// Gives all memory back to the system. A pool with blocks in use, which something keeps beyond its solver, stays.
    ///
    /// # Safety
    /// As for [`Pool::enter`], and the pool is not used again.
    pub unsafe fn release(pool: NonNull<Self>) {
        // SAFETY: the caller has the pool for himself.
        let own = unsafe { pool.as_ref() };
        if own.live > 0 {
            return;
        }
        for &(place, size) in &own.chunks[..own.count] {
            // SAFETY: each chunk was allocated with this layout, and holds no block in use.
            unsafe { System.dealloc(place, chunk_layout(size)) };
        }
        // SAFETY: allocated with this layout by `create`.
        unsafe { System.dealloc(pool.as_ptr().cast(), Layout::new::<Self>()) };
    }

    /// Another chunk, of at least some size; whether there is one.
    fn grow(&mut self, least: usize) -> bool {
        let size = least.max(self.reserved).max(FIRST_CHUNK).next_multiple_of(ALIGN);
        if self.count == CHUNKS {
            return false;
        }
        // SAFETY: the size is not zero.
        let place = unsafe { System.alloc(chunk_layout(size)) };
        if place.is_null() {
            return false;
        }
        self.chunks[self.count] = (place, size);
        self.count += 1;
        self.reserved += size;
        self.rest = place;
        self.end = place.wrapping_add(size);
        true
    }

    /// A block of some size and its class; none where the system has to help out.
    fn take(&mut self, size: usize) -> Option<(*mut u8, usize)> {
        let (class, size) = class_of(size)?;
        let last = if self.is_sealed { (class + LARGER).min(CLASSES - 1) } else { class };
        let fresh = |pool: &mut Self| {
            let has_room = (pool.end as usize) - (pool.rest as usize) >= size;
            (has_room || (!pool.is_sealed && pool.grow(size))).then(|| {
                let block = pool.rest;
                pool.rest = pool.rest.wrapping_add(size);
                pool.used += size;
                (block, class)
            })
        };
        let exact = self.pop(class).map(|block| (block, class));
        let found = exact.or_else(|| fresh(self));
        let found = found.or_else(|| (class + 1..=last).find_map(|class| Some((self.pop(class)?, class))));
        self.live += usize::from(found.is_some());
        found
    }

    fn pop(&mut self, class: usize) -> Option<*mut u8> {
        let head = NonNull::new(self.free[class])?;
        // SAFETY: blocks of the list are not in use, and were written by `give`.
        self.free[class] = unsafe { head.as_ref() }.next;
        Some(head.as_ptr().cast())
    }

    /// Takes a block back.
    ///
    /// # Safety
    /// The block was given out by `take` with this class, and is not used again.
    unsafe fn give(&mut self, block: *mut u8, class: usize) {
        let free = block.cast::<Free>();
        // SAFETY: the block is at least `SMALLEST` bytes, aligned to `ALIGN`, and nobody's.
        unsafe { free.write(Free { next: self.free[class] }) };
        self.free[class] = free;
        self.live -= 1;
    }
}

fn chunk_layout(size: usize) -> Layout {
    // SAFETY: the alignment is a power of two, and sizes come from `grow`, which the system accepted or refuses.
    unsafe { Layout::from_size_align_unchecked(size, ALIGN) }
}

/// The class of blocks that have room for a size, and their size; none beyond all classes.
fn class_of(size: usize) -> Option<(usize, usize)> {
    let below = size.max(SMALLEST) - 1;
    let shift = below.ilog2() - 2;
    let quarters = (below >> shift) + 1;
    let class = 4 * (shift as usize) + (quarters - 5);
    (class < CLASSES).then_some((class, quarters << shift))
}

/// The room before a block for its header, and for its alignment.
fn room_before(layout: Layout) -> usize {
    layout.align().max(ALIGN)
}

// SAFETY: blocks are disjoint, of the size and alignment that is asked for, and stay until they are given back: those of
// the system by its word, those of a pool because a chunk is cut only once, a free block is of one list only, and a pool
// with blocks in use is never released. Nothing here unwinds.
unsafe impl GlobalAlloc for Reserve {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let before = room_before(layout);
        let Some(size) = layout.size().checked_add(before + layout.align()) else { return ptr::null_mut() };
        let current = CURRENT.get();
        if !current.is_null() {
            // SAFETY: a pool is entered by one thread, and not released before that has left it.
            let pool = unsafe { &mut *current };
            if let Some((block, class)) = pool.take(size) {
                let place = (block as usize + ALIGN).next_multiple_of(before) - block as usize;
                let header = Header { pool: current, class: class as u32, offset: (place - ALIGN) as u32 };
                // SAFETY: the header and the wanted bytes lie within the block.
                return unsafe { write_header(block.add(place), header) };
            }
            pool.helped_out += u64::from(pool.is_sealed);
        }
        let Ok(outer) = Layout::from_size_align(size, before) else { return ptr::null_mut() };
        // SAFETY: the size is not zero.
        let block = unsafe { System.alloc(outer) };
        if block.is_null() {
            return block;
        }
        // SAFETY: `before` bytes for the header are followed by the wanted ones.
        unsafe { write_header(block.add(before), Header { pool: ptr::null_mut(), class: 0, offset: 0 }) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: `alloc` has written a header before every place.
        let Header { pool, class, offset } = unsafe { place.cast::<Header>().sub(1).read() };
        if pool.is_null() {
            let before = room_before(layout);
            // SAFETY: the layout is the one that was accepted in `alloc`.
            unsafe {
                let outer = Layout::from_size_align_unchecked(layout.size() + before + layout.align(), before);
                System.dealloc(place.sub(before), outer);
            }
        } else if pool == CURRENT.get() {
            // SAFETY: the pool is this thread's, and the block is one of its.
            unsafe { (*pool).give(place.sub(ALIGN + offset as usize), class as usize) };
        }
        // A block that is dropped where its pool is not entered stays its pool's, which is then not released.
    }
}

/// # Safety
/// There is room for a header before the place, which is aligned to [`ALIGN`].
unsafe fn write_header(place: *mut u8, header: Header) -> *mut u8 {
    const { assert!(size_of::<Header>() <= ALIGN && align_of::<Header>() <= ALIGN) };
    // SAFETY: as above.
    unsafe { place.cast::<Header>().sub(1).write(header) };
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a pattern (Marsaglia, xorshift).
    fn next(state: &mut u64) -> usize {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 20) as usize
    }

    #[test]
    fn a_class_has_room_and_wastes_at_most_a_quarter() {
        let mut last = 0;
        for size in (1..5000).chain((13..40).map(|k| (1usize << k) + 1)) {
            let (class, room) = class_of(size).expect("a class");
            assert!(room >= size && room % ALIGN == 0);
            assert!(room <= SMALLEST.max(size + size / 4 + 1), "{size} takes {room}");
            assert_eq!(class_of(room), Some((class, room)));
            assert!(class >= last);
            last = class;
        }
        assert_eq!(class_of(usize::MAX), None);
    }

    /// Takes and gives back blocks of many sizes and alignments; each keeps what was written into it.
    fn exercise(rounds: usize) {
        let (mut state, mut held): (u64, Vec<(*mut u8, Layout, u8)>) = (0x1234_5678_9abc_def1, vec![]);
        for round in 0..rounds {
            if held.len() < 200 && !next(&mut state).is_multiple_of(3) {
                let layout = Layout::from_size_align(next(&mut state) % 3000 + 1, 1 << (next(&mut state) % 8));
                let layout = layout.expect("a layout");
                let mark = round as u8;
                // SAFETY: the size is not zero, and only those bytes are written.
                let place = unsafe { Reserve.alloc(layout) };
                assert!(!place.is_null() && (place as usize).is_multiple_of(layout.align()));
                // SAFETY: as above.
                unsafe { place.write_bytes(mark, layout.size()) };
                held.push((place, layout, mark));
            } else if !held.is_empty() {
                let at = next(&mut state) % held.len();
                let (place, layout, mark) = held.swap_remove(at);
                // SAFETY: the bytes were written above, and the block is dropped once.
                unsafe {
                    assert!(std::slice::from_raw_parts(place, layout.size()).iter().all(|byte| *byte == mark));
                    Reserve.dealloc(place, layout);
                }
            }
        }
        for (place, layout, _) in held {
            // SAFETY: the block is dropped once.
            unsafe { Reserve.dealloc(place, layout) };
        }
    }

    #[test]
    fn what_is_repeated_in_a_sealed_pool_asks_the_system_for_nothing() {
        exercise(2000); // Without a pool.
        let pool = Pool::create().expect("memory");
        // SAFETY: the pool is this test's alone.
        unsafe {
            let entered = Pool::enter(pool);
            exercise(5000);
            Pool::seal(pool);
            let sealed = Pool::counts(pool);
            for _ in 0..20 {
                exercise(5000);
            }
            assert_eq!(Pool::counts(pool), sealed);
            assert_eq!(pool.as_ref().live, 0);
            drop(entered);
            Pool::release(pool);
        }
    }

    #[test]
    fn a_pool_that_is_full_is_helped_out_and_says_so() {
        let pool = Pool::create().expect("memory");
        let layout = Layout::from_size_align(1 << 20, 8).expect("a layout");
        // SAFETY: the pool is this test's alone, and every block is dropped once.
        unsafe {
            let entered = Pool::enter(pool);
            Pool::seal(pool);
            let place = Reserve.alloc(layout);
            assert!(!place.is_null());
            assert_eq!(Pool::counts(pool).helped_out, 1);
            Reserve.dealloc(place, layout);
            drop(entered);
            Pool::release(pool);
        }
    }
}
