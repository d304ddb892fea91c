// Tile entries as rendering needs them: (tile, splat).

@group(0) @binding(6) var<storage, read_write> entry_tiles: array<u32>;
@group(0) @binding(7) var<storage, read_write> entry_splats: array<u32>;

fn write_entry(index: u32, tile: u32, splat: u32) {
    entry_tiles[index] = tile;
    entry_splats[index] = splat;
}
