// What egui wants drawn: triangles with colours times the coverage of letters. Colours are premultiplied sRGB, as egui's.

@group(0) @binding(0) var letters: texture_2d<f32>;
@group(0) @binding(1) var nearby: sampler;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) at: vec2<f32>,
    @location(1) colour: vec4<f32>,
}

@vertex
fn place(@location(0) clip: vec2<f32>, @location(1) at: vec2<f32>, @location(2) colour: vec4<f32>) -> Corner {
    return Corner(vec4(clip, 0.0, 1.0), at, colour);
}

@fragment
fn ink(in: Corner) -> @location(0) vec4<f32> {
    return in.colour * textureSample(letters, nearby, in.at);
}
