// What lies under a window's panels and text: a picture, pixel for pixel, or one colour. Colours are sRGB bytes.

override linear_target: bool = false;

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<uniform> colour: vec4<f32>;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
}

// One triangle that covers the whole viewport: there is no diagonal at which pixels are computed twice.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> Corner {
    let at = vec2(select(0.0, 2.0, corner == 1u), select(0.0, 2.0, corner == 2u));
    return Corner(vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0), at);
}

fn shown(c: vec3<f32>) -> vec4<f32> {
    if !linear_target { return vec4(c, 1.0); }
    return vec4(select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045)), 1.0);
}

@fragment
fn show_picture(in: Corner) -> @location(0) vec4<f32> {
    let size = vec2<i32>(textureDimensions(picture));
    let pixel = min(vec2<i32>(in.at * vec2<f32>(size)), size - 1);
    return shown(textureLoad(picture, pixel, 0).rgb);
}

@fragment
fn show_colour() -> @location(0) vec4<f32> {
    return shown(colour.rgb);
}
