// What the stages of a frame tell each other, and the host, in numbers. Indices into an array of
// u32; `rust-core/gpu/src/layout.rs` has the same list.

/// Splats that the frame draws, after culling.
const VISIBLE: u32 = 0u;
/// Pairs of a splat and a tile in the region at hand; 2³² − 1 stands for more than can be counted.
const ENTRIES: u32 = 1u;
/// Entries that the tile sort works on: ENTRIES, or 0 when they do not fit.
const SORTED_ENTRIES: u32 = 2u;
/// Splats that the network moves in this frame.
const DYNAMIC: u32 = 3u;
/// Most ENTRIES of any region since the host last cleared it.
const MOST_ENTRIES: u32 = 4u;
/// In training: 1 from a frame whose entries did not fit until the host clears it. Meanwhile no frame
/// is drawn, and no kernel may change what outlives a frame.
const HALTED: u32 = 5u;
/// In training: frames drawn since the host last cleared it.
const DRAWN_FRAMES: u32 = 6u;
