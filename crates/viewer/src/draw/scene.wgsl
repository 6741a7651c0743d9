// The model: triangles with three lights, lines of a width in pixels, a ground with a grid, and a shadow on it.
// Colours come and go as sRGB; light adds up in linear numbers.

struct View {
    clip: mat4x4<f32>,
    eye: vec4<f32>,
    // Towards the eye's right, up and back: lights turn with the viewer.
    right: vec4<f32>,
    up: vec4<f32>,
    back: vec4<f32>,
    // Hidden is what has dot(section.xyz, p) > section.w; no section when xyz is zero.
    section: vec4<f32>,
    // Upwards as unit vector, and the height of the ground along it.
    ground: vec4<f32>,
    // Middle of the ground, and how far it reaches.
    middle: vec4<f32>,
    // Width and height in pixels, spacing of the grid, width of lines relative to a picture 1000 pixels high.
    picture: vec4<f32>,
    background: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;

fn linear(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

fn display(c: vec3<f32>) -> vec3<f32> {
    let x = clamp(c, vec3(0.0), vec3(1.0));
    return select(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3(0.0031308));
}

fn hidden(p: vec3<f32>, cut: f32) -> bool {
    return cut > 0.5 && dot(view.section.xyz, view.section.xyz) > 0.5 && dot(view.section.xyz, p) > view.section.w;
}

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec4<f32>,
}

@vertex
fn surface_vertex(
    @location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) colour: vec4<f32>,
) -> Surface {
    return Surface(view.clip * vec4(position, 1.0), position, normal, colour);
}

@fragment
fn surface_fragment(in: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    if hidden(in.position, in.colour.w) { discard; }
    let to_eye = normalize(view.eye.xyz - in.position);
    var n = normalize(in.normal);
    // Seen from behind (an open surface, the inside of a cut), faces are lit as from their other side.
    let inside = dot(n, to_eye) < 0.0;
    if inside { n = -n; }
    let key = normalize(0.55 * view.right.xyz + 0.75 * view.up.xyz + 0.75 * view.back.xyz);
    let fill = normalize(-0.9 * view.right.xyz + 0.1 * view.up.xyz + 0.45 * view.back.xyz);
    let sky = 0.5 + 0.5 * dot(n, view.ground.xyz);
    let base = linear(in.colour.rgb);
    let light = 0.20 + 0.20 * sky + 0.58 * max(dot(n, key), 0.0) + 0.36 * max(dot(n, fill), 0.0);
    let shine = 0.10 * pow(max(dot(n, normalize(key + to_eye)), 0.0), 40.0);
    var c = base * light + vec3(shine);
    if inside { c *= 0.72; }
    return vec4(display(c), 1.0);
}

struct Stroke {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) colour: vec4<f32>,
}

@vertex
fn line_vertex(
    @builtin(vertex_index) corner: u32,
    @location(0) a: vec3<f32>, @location(1) b: vec3<f32>, @location(2) colour: vec4<f32>, @location(3) width: f32,
) -> Stroke {
    // A little towards the eye, so that edges win over their own faces.
    let distance = length(view.eye.xyz - view.middle.xyz);
    let pa = a + normalize(view.eye.xyz - a) * distance * 0.001;
    let pb = b + normalize(view.eye.xyz - b) * distance * 0.001;
    let ca = view.clip * vec4(pa, 1.0);
    let cb = view.clip * vec4(pb, 1.0);
    let half = 0.5 * view.picture.xy;
    var along = (cb.xy / cb.w - ca.xy / ca.w) * half;
    if dot(along, along) < 1e-12 { along = vec2(1.0, 0.0); }
    along = normalize(along);
    let across = vec2(-along.y, along.x);
    let at_b = corner == 1u || corner == 2u || corner == 4u;
    let side = select(-1.0, 1.0, corner == 2u || corner == 4u || corner == 5u);
    let w = 0.5 * max(width * view.picture.w, 1.0);
    let offset = (across * side + along * select(-1.0, 1.0, at_b)) * w / half;
    var c = select(ca, cb, at_b);
    c = vec4(c.xy + offset * c.w, c.zw);
    return Stroke(c, select(a, b, at_b), colour);
}

@fragment
fn line_fragment(in: Stroke) -> @location(0) vec4<f32> {
    if hidden(in.position, in.colour.w) { discard; }
    return vec4(in.colour.rgb, 1.0);
}

fn onto_ground(p: vec3<f32>) -> vec3<f32> {
    let up = view.ground.xyz;
    // Light from above, a little from the side, so that the shadow is beside the body and not only under it.
    let sun = normalize(up + 0.25 * view.right.xyz + 0.2 * view.back.xyz);
    let height = dot(p, up) - view.ground.w;
    return p - sun * (height / dot(sun, up)) + up * view.middle.w * 1e-4;
}

@vertex
fn shadow_vertex(@location(0) position: vec3<f32>, @location(2) colour: vec4<f32>) -> Surface {
    let p = onto_ground(position);
    return Surface(view.clip * vec4(p, 1.0), position, p, colour);
}

@fragment
fn shadow_fragment(in: Surface) -> @location(0) vec4<f32> {
    if hidden(in.position, in.colour.w) { discard; }
    let far = length(in.normal - view.middle.xyz) / view.middle.w;
    return vec4(mix(view.background.rgb * 0.86, view.background.rgb, smoothstep(0.5, 1.0, far)), 1.0);
}

struct Ground {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

@vertex
fn ground_vertex(@builtin(vertex_index) corner: u32) -> Ground {
    let x = select(-1.0, 1.0, corner == 1u || corner == 2u || corner == 4u);
    let y = select(-1.0, 1.0, corner == 2u || corner == 4u || corner == 5u);
    let up = view.ground.xyz;
    var e1 = cross(up, vec3(0.0, 0.0, 1.0));
    if length(e1) < 0.5 { e1 = vec3(1.0, 0.0, 0.0); }
    e1 = normalize(e1);
    let e2 = cross(e1, up);
    let p = view.middle.xyz + (e1 * x + e2 * y) * view.middle.w;
    return Ground(view.clip * vec4(p, 1.0), vec2(x, y) * view.middle.w);
}

@fragment
fn ground_fragment(in: Ground) -> @location(0) vec4<f32> {
    let cell = in.at / view.picture.z;
    let wide = max(fwidth(cell), vec2(1e-6));
    let near = abs(fract(cell - 0.5) - 0.5) / wide;
    let line = 1.0 - clamp(min(near.x, near.y), 0.0, 1.0);
    // Far cells are narrower than a pixel: their lines fade into a tone.
    let fade = 1.0 - smoothstep(0.35, 1.0, length(in.at) / view.middle.w);
    let strength = line * fade * (1.0 - smoothstep(0.2, 0.6, max(wide.x, wide.y)));
    return vec4(view.background.rgb * (1.0 - 0.10 * strength), 1.0);
}
