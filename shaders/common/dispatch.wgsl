// Folded dispatches.
//
// A dispatch has at most 65 535 workgroups along one axis. Larger ones are folded into rows of
// workgroups, and a kernel counts through them as if they were one row; the last row may be longer
// than what is left to do.

/// Longest row of workgroups: the limit that every device has.
const MAX_GROUPS_PER_ROW: u32 = 65535u;

fn flat_group(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return group.y * groups.x + group.x;
}

/// Workgroups of an indirect dispatch that together make at least `count`.
fn folded(count: u32) -> vec3<u32> {
    let rows = (count + MAX_GROUPS_PER_ROW - 1u) / MAX_GROUPS_PER_ROW;
    return vec3<u32>(min(count, MAX_GROUPS_PER_ROW), max(rows, 1u), 1u);
}

fn divide_up(a: u32, b: u32) -> u32 {
    return a / b + select(0u, 1u, a % b != 0u);
}
