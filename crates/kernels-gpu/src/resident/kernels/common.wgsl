// What all kernels of vectors share: the numbers of a step, the record of a solve, sums in a fixed order.
//
// A sum over a vector: invocation i of GROUPS · 256 adds entries i, i + GROUPS · 256, …; a workgroup adds its
// invocations and leaves one number in `sums`; whoever needs the sum adds these in the same way.
// Every partial sum is two numbers, the second what the first lost to rounding (O. Møller's and D. Knuth's sum).
// The order is that of the indices, whatever the device: the same bits in every run.

const WORKGROUP: u32 = 256u;

// Places of `sums`: [slot][workgroup].
const MOST_GROUPS: u32 = 1024u;
const RIGHT: u32 = 0u;
const RESIDUAL: u32 = 1u;
const PRODUCT: u32 = 2u;
const CURVATURE: u32 = 3u;
const ENERGY: u32 = 4u;
const BAD: u32 = 5u;

struct Parameters {
    unknowns: u32,
    axes: u32,
    groups: u32,
    most_iterations: u32,
    // Of the stage: w = ahead · v for free unknowns; s = drag · v.
    ahead: f32,
    drag: f32,
    // Weights of the masses and of the second derivatives in the matrix.
    mass: f32,
    second: f32,
    // Of the end: u += end_v · v + end_a · a, v += step · a, all times keep.
    end_v: f32,
    end_a: f32,
    step: f32,
    keep: f32,
    relative: f32,
    absolute: f32,
    reach: f32,
    rate: f32,
    nothing: u32,
}

struct Control {
    done: u32,
    iterations: u32,
    live: u32,
    status: u32,
    product: f32,
    product_before: f32,
    tolerance_squared: f32,
    residual_squared: f32,
    initial_squared: f32,
    right_squared: f32,
    energy: f32,
    bad: f32,
    curvature: f32,
    judged: f32,
    unused_1: f32,
    unused_2: f32,
}

// How a solve ended.
const RUNNING: u32 = 0u;
const CONVERGED: u32 = 1u;
const EXHAUSTED: u32 = 2u;
const INDEFINITE: u32 = 3u;
const NOT_FINITE: u32 = 4u;

fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// Hides a number from compilers that take sums for those of real numbers, where (a + b) − a is b: they cannot know that
// `nothing`, which the host gives, is zero.
var<private> nothing: u32;

fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ nothing);
}

// a + b as two numbers.
fn two_sum(a: f32, b: f32) -> vec2<f32> {
    let s = opaque(a + b);
    let t = opaque(s - a);
    return vec2<f32>(s, (a - (s - t)) + (b - t));
}

// The sum of two numbers in two parts each.
fn add(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = two_sum(a.x, b.x);
    let low = s.y + (a.y + b.y);
    let high = opaque(s.x + low);
    return vec2<f32>(high, low - opaque(high - s.x));
}

var<workgroup> own_parts: array<vec2<f32>, 256>;
var<workgroup> row_parts: array<vec2<f32>, 16>;

// The sum over the workgroup, known to all of it: rows of 16, then the 16 of them. Few barriers, because a device that
// runs a workgroup on few lanes pays for each.
fn workgroup_parts(own: vec2<f32>, invocation: u32) -> vec2<f32> {
    workgroupBarrier();
    own_parts[invocation] = own;
    workgroupBarrier();
    if (invocation < 16u) {
        var sum = own_parts[invocation * 16u];
        for (var k = 1u; k < 16u; k++) {
            sum = add(sum, own_parts[invocation * 16u + k]);
        }
        row_parts[invocation] = sum;
    }
    workgroupBarrier();
    var total = row_parts[0];
    for (var k = 1u; k < 16u; k++) {
        total = add(total, row_parts[k]);
    }
    return total;
}

fn workgroup_sum(own: vec2<f32>, invocation: u32) -> f32 {
    let parts = workgroup_parts(own, invocation);
    return parts.x + parts.y;
}
