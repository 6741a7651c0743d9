// Logarithm, exponential and power of single precision to about one unit in the last place, on any device alike.
//
//   ln x = e ln 2 + 2 (s + s³/3 + s⁵/5 + …),  s = (m − 1)/(m + 1),  x = 2ᵉ m,  √½ < m ≤ √2
//   eˣ   = 2ᵏ (1 + r + r²/2 + …),             k = ⌊x / ln 2 + ½⌋,  r = x − k ln 2,  |r| ≤ ln 2 / 2
//   xʸ   = exp(y ln x), with the logarithm in two parts whose sum is its value
//
// The series are cut where their rest is below 2⁻²⁷. ln 2 is split such that its first part times a whole number below
// 2⁸ is exact. Products whose rounding matters are made of halves of 12 bits, so that no part is rounded and it does not
// matter whether a device fuses multiplications and additions.
//
// Compilers of shaders take sums for those of real numbers: (a + b) − a becomes b, and what was rounded away is lost with
// it. `opaque` hides a number from them: they cannot know that `nothing`, the number of workgroups along an axis that is
// not used, less one, is zero.

var<private> nothing: u32;

fn opaque(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ nothing);
}

const LN2_HIGH: f32 = 0.693138122558593750f;
const LN2_LOW: f32 = 9.0580013515e-6f;

// The first 12 bits of a number: the product of two such is exact.
fn high_part(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) & 0xfffff000u) ^ nothing);
}

// ln x for a positive finite x as a sum of two numbers, the second below half a unit of the first.
fn ln_parts(given: f32) -> vec2<f32> {
    var x = given;
    var e = 0i;
    if (x < 1.1754944e-38f) {
        x = x * 16777216.0f;
        e = -24i;
    }
    let bits = bitcast<u32>(x);
    e = e + i32(bits >> 23u) - 127i;
    var m = bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
    if (m > 1.4142135f) {
        m = 0.5f * m;
        e = e + 1i;
    }
    let f = m - 1.0f;
    let d = opaque(m + 1.0f);
    let d_rest = m - opaque(d - 1.0f);
    let s = opaque(f / d);
    // What the division rounded away: (f − s d) / d.
    let s_high = high_part(s);
    let s_low = opaque(s - s_high);
    let d_high = high_part(d);
    let d_low = opaque(d - d_high);
    let rest = ((((f - s_high * d_high) - s_high * d_low) - s_low * d_high) - s_low * d_low) - s * d_rest;
    let z = s * s;
    let series = z * (0.33333334f + z * (0.2f + z * (0.14285715f + z * (0.11111111f + z * 0.09090909f))));
    let first = opaque(2.0f * s);
    let second = 2.0f * (rest / d + s * series);
    let scale = f32(e);
    let whole = opaque(scale * LN2_HIGH);
    // The larger first: twice e ln 2 is more than any ln m, unless e is zero and so is the product.
    let sum = opaque(whole + first);
    let low = (first - opaque(sum - whole)) + (second + scale * LN2_LOW);
    let high = opaque(sum + low);
    return vec2<f32>(high, low - opaque(high - sum));
}

fn ln_of(x: f32) -> f32 {
    if (x > 0.0f && x <= 3.4028234e38f) {
        return ln_parts(x).x;
    }
    if (x == 0.0f) {
        return -1.0f / abs(x);
    }
    if (x < 0.0f) {
        return (x - x) / (x - x);
    }
    return x;
}

// The exponential of a sum of two numbers, the second much smaller.
fn exp_parts(x: f32, low: f32) -> f32 {
    // Beyond, the result is zero or infinite in any case, and 2ᵏ remains a product of two numbers.
    let bounded = clamp(x, -174.0f, 176.0f);
    let k = floor(bounded * 1.442695f + 0.5f);
    let r = (opaque(bounded - opaque(k * LN2_HIGH)) - k * LN2_LOW) + low;
    let series = 0.5f + r * (0.16666667f + r * (0.041666668f + r * (0.008333334f + r * (0.0013888889f + r * 1.9841270e-4f))));
    let value = 1.0f + (r + r * r * series);
    let whole = i32(k);
    let half = whole / 2i;
    let first = bitcast<f32>(u32(half + 127i) << 23u);
    let second = bitcast<f32>(u32(whole - half + 127i) << 23u);
    return value * first * second;
}

fn exp_of(x: f32) -> f32 {
    if (x != x) {
        return x;
    }
    return exp_parts(x, 0.0f);
}

fn pow_of(a: f32, b: f32) -> f32 {
    if (b == 0.0f || a == 1.0f) {
        return 1.0f;
    }
    let x = abs(a);
    if (x == 0.0f) {
        return select(1.0f / x, 0.0f, b > 0.0f);
    }
    if (!(x <= 3.4028234e38f)) {
        return select(1.0f / x, x, b > 0.0f);
    }
    let whole = floor(b) == b;
    if (a < 0.0f && !whole) {
        return (a - a) / (a - a);
    }
    let l = ln_parts(x);
    let b_high = high_part(b);
    let b_low = opaque(b - b_high);
    let l_high = high_part(l.x);
    let l_low = opaque(l.x - l_high);
    let product = opaque(b * l.x);
    let rest = ((opaque(opaque(b_high * l_high) - product) + b_high * l_low) + b_low * l_high) + b_low * l_low;
    let size = exp_parts(product, select(rest + b * l.y, 0.0f, abs(product) > 200.0f));
    // Numbers of 2²⁴ and more are even.
    let odd = whole && abs(b) < 16777216.0f && (u32(abs(b)) & 1u) == 1u;
    return select(size, -size, a < 0.0f && odd);
}
