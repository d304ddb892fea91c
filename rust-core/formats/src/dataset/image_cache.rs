//! Decoded images within a byte budget, fetched ahead on a background thread.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use super::{Dataset, Image, View, load_image};
use crate::ReadError;

/// The images of a dataset, decoded when they are needed or a little earlier.
///
/// At most the budget is kept, least recently used images leaving first; an image that was fetched
/// ahead stays until it has been asked for once. What [`get`](Self::get) returns is the decoded
/// file whatever is cached: threads and timing change when an image is decoded, never what it is.
///
/// The budget counts images held by the cache. Not counted are the two that may be in the middle
/// of decoding (one on the background thread, one in `get`) and those a caller still holds.
#[derive(Debug)]
pub struct ImageCache {
    shared: Arc<Shared>,
    background: Option<JoinHandle<()>>,
}

impl ImageCache {
    /// A cache of `budget` bytes for the dataset's images, nothing decoded yet.
    ///
    /// # Panics
    /// When the operating system cannot start a thread.
    #[must_use]
    pub fn new(dataset: &Dataset, budget: usize) -> Self {
        let views = dataset.views.clone();
        let slots = views.iter().map(|_| Slot::Empty).collect();
        let state = State { slots, ..State::default() };
        let shared =
            Arc::new(Shared { views, budget, state: Mutex::new(state), changed: Condvar::new() });
        let for_thread = Arc::clone(&shared);
        let background = std::thread::Builder::new()
            .name("image decoder".into())
            .spawn(move || for_thread.fetch_ahead())
            .expect("a thread can be started");
        Self { shared, background: Some(background) }
    }

    /// The image of a view; decoded now if it is not there yet.
    ///
    /// # Errors
    /// [`ReadError`] names the file that cannot be read. It comes again on every call, and only
    /// here: images fetched ahead fail when they are asked for.
    ///
    /// # Panics
    /// When the dataset has no view of that index.
    pub fn get(&self, view: usize) -> Result<Arc<Image>, ReadError> {
        self.shared.get(view)
    }

    /// Says which views will be asked for next, in order, in place of what was said before.
    ///
    /// # Panics
    /// When the dataset has no view of one of the indices.
    pub fn prefetch(&self, order: &[usize]) {
        self.shared.prefetch(order);
    }

    /// Bytes of the images that are in the cache.
    #[must_use]
    pub fn resident_bytes(&self) -> usize {
        self.shared.lock().bytes
    }
}

impl Drop for ImageCache {
    fn drop(&mut self) {
        self.shared.lock().stopping = true;
        self.shared.changed.notify_all();
        if let Some(background) = self.background.take() {
            // A panic there has been printed, and the images it left out were decoded by `get`.
            let _ = background.join();
        }
    }
}

#[derive(Debug)]
struct Shared {
    views: Vec<View>,
    budget: usize,
    state: Mutex<State>,
    /// Signalled when an image arrives or failed, when one is used, and when the queue changes.
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// One slot for each view.
    slots: Vec<Slot>,
    /// Views to fetch ahead.
    queue: VecDeque<usize>,
    /// Sum of the sizes of the images in `slots`.
    bytes: usize,
    /// Counts calls of `get`: the time for "least recently used".
    clock: u64,
    stopping: bool,
}

#[derive(Debug)]
enum Slot {
    Empty,
    /// Being decoded by one of the threads.
    Decoding,
    Ready {
        image: Arc<Image>,
        last_used: u64,
        awaited: bool,
    },
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // No code that can fail runs while the lock is held, so a poisoned state is still whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    fn get(&self, view: usize) -> Result<Arc<Image>, ReadError> {
        let mut state = self.lock();
        state.clock += 1;
        let now = state.clock;
        loop {
            match &mut state.slots[view] {
                Slot::Ready { image, last_used, awaited } => {
                    (*last_used, *awaited) = (now, false);
                    let image = Arc::clone(image);
                    // There may be room now for the next image in the queue.
                    self.changed.notify_all();
                    return Ok(image);
                }
                Slot::Decoding => state = self.wait(state),
                Slot::Empty => break,
            }
        }
        state.forget_queued(view);
        self.decode(state, view, false)
    }

    fn prefetch(&self, order: &[usize]) {
        assert!(order.iter().all(|&view| view < self.views.len()), "a view of the dataset");
        let mut state = self.lock();
        for (view, slot) in state.slots.iter_mut().enumerate() {
            if let Slot::Ready { awaited, .. } = slot {
                *awaited &= order.contains(&view);
            }
        }
        state.queue = order.iter().copied().collect();
        self.changed.notify_all();
    }

    /// The background thread: decodes the queue in order, as far as the budget goes.
    fn fetch_ahead(&self) {
        let mut state = self.lock();
        while !state.stopping {
            match state.queue.front().copied() {
                Some(view) if !matches!(state.slots[view], Slot::Empty) => {
                    state.queue.pop_front();
                }
                Some(view) if self.has_room_for(&state, view) => {
                    state.queue.pop_front();
                    // An unreadable image is reported when it is asked for.
                    let _ = self.decode(state, view, true);
                    state = self.lock();
                }
                _ => state = self.wait(state),
            }
        }
    }

    /// Whether an image fits beside those that were fetched ahead and not used yet.
    fn has_room_for(&self, state: &State, view: usize) -> bool {
        // Four channels and a weight: what an image has at most is known before it is decoded.
        const MAX_BYTES_PER_PIXEL: u64 = 5;
        let camera = &self.views[view].camera;
        let size = u64::from(camera.width) * u64::from(camera.height) * MAX_BYTES_PER_PIXEL;
        let awaited: u64 = state.slots.iter().map(|slot| slot.awaited_bytes() as u64).sum();
        awaited + size <= self.budget as u64
    }

    /// Decodes without holding the lock, and keeps the image if there is room.
    fn decode(
        &self,
        mut state: MutexGuard<'_, State>,
        view: usize,
        awaited: bool,
    ) -> Result<Arc<Image>, ReadError> {
        state.slots[view] = Slot::Decoding;
        drop(state);
        let decoding = Decoding { shared: self, view };
        let image = Arc::new(load_image(&self.views[view])?);
        self.lock().keep(view, &image, self.budget, awaited);
        drop(decoding);
        Ok(image)
    }
}

/// Ends the decoding of a view: whoever waits for it must not wait forever, even after an error
/// or a panic.
struct Decoding<'a> {
    shared: &'a Shared,
    view: usize,
}

impl Drop for Decoding<'_> {
    fn drop(&mut self) {
        let slot = &mut self.shared.lock().slots[self.view];
        if matches!(slot, Slot::Decoding) {
            *slot = Slot::Empty;
        }
        self.shared.changed.notify_all();
    }
}

impl Slot {
    fn awaited_bytes(&self) -> usize {
        match self {
            Slot::Ready { image, awaited: true, .. } => image.byte_size(),
            _ => 0,
        }
    }

    /// When the image was last used, if it is here and may leave.
    fn evictable_since(&self) -> Option<u64> {
        match self {
            Slot::Ready { last_used, awaited: false, .. } => Some(*last_used),
            _ => None,
        }
    }
}

impl State {
    /// Takes a view that is about to be decoded off the queue.
    fn forget_queued(&mut self, view: usize) {
        if let Some(place) = self.queue.iter().position(|&queued| queued == view) {
            self.queue.remove(place);
        }
    }

    /// Puts an image in its slot after making room; not if the images that must stay leave none.
    fn keep(&mut self, view: usize, image: &Arc<Image>, budget: usize, awaited: bool) {
        let size = image.byte_size();
        let must_stay: usize = self.slots.iter().map(Slot::awaited_bytes).sum();
        if must_stay + size > budget {
            return;
        }
        while self.bytes + size > budget {
            self.evict_least_recently_used();
        }
        self.bytes += size;
        let last_used = self.clock;
        self.slots[view] = Slot::Ready { image: Arc::clone(image), last_used, awaited };
    }

    fn evict_least_recently_used(&mut self) {
        let oldest = self
            .slots
            .iter_mut()
            .filter_map(|slot| slot.evictable_since().map(|since| (since, slot)))
            .min_by_key(|(since, _)| *since);
        if let Some((_, slot)) = oldest
            && let Slot::Ready { image, .. } = std::mem::replace(slot, Slot::Empty)
        {
            self.bytes -= image.byte_size();
        }
    }
}
