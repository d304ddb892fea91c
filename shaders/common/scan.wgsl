// Prefix sums of one workgroup of 256.
//
// Sums saturate: 2³² − 1 means "at least that many". Saturating addition of unsigned integers is
// associative, so the order in which a tree adds does not matter, and a count that does not fit in
// 32 bits can never wrap around into one that does.

const SCAN_WIDTH: u32 = 256u;

var<workgroup> scan_values: array<u32, 256>;

fn saturating_add(a: u32, b: u32) -> u32 {
    let sum = a + b;
    return select(sum, 0xffffffffu, sum < a);
}

/// The sum of `value` over the threads 0 … `thread`. All 256 threads take part; afterwards
/// `scan_values[255]` is the sum of all of them, until the next `scan_barrier()`.
fn inclusive_scan(thread: u32, value: u32) -> u32 {
    var sum = value;
    scan_values[thread] = sum;
    workgroupBarrier();
    for (var distance = 1u; distance < SCAN_WIDTH; distance *= 2u) {
        var left = 0u;
        if (thread >= distance) {
            left = scan_values[thread - distance];
        }
        workgroupBarrier();
        sum = saturating_add(sum, left);
        scan_values[thread] = sum;
        workgroupBarrier();
    }
    return sum;
}

/// Separates the last look at `scan_values` from the next scan.
fn scan_barrier() {
    workgroupBarrier();
}
