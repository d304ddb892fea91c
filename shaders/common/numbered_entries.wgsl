// Tile entries as the backward pass needs them: (tile, number), in the order of splats; the number
// names a slot that is the entry's own, whatever the tile sort does, and the slots of a splat
// follow each other.

@group(0) @binding(6) var<storage, read_write> entry_tiles: array<u32>;
@group(0) @binding(7) var<storage, read_write> entry_slots: array<u32>;
/// The splat of each slot.
@group(0) @binding(8) var<storage, read_write> slot_splats: array<u32>;

fn write_entry(index: u32, tile: u32, splat: u32) {
    entry_tiles[index] = tile;
    entry_slots[index] = index;
    slot_splats[index] = splat;
}
