//! A curve as a drawing: one small SVG with axes, ticks and a line.

use super::curves::Curve;
use std::fmt::Write as _;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 58.0;

/// An SVG document of a curve, 640 × 400, black on white with one blue line.
pub fn svg(curve: &Curve) -> String {
    let abscissae: Vec<f64> = curve.points.iter().map(|p| p.abscissa).collect();
    let (scale, unit) = pascals(curve.points.iter().fold(0.0, |m: f64, p| m.max(p.ordinate.abs())));
    let ordinates: Vec<f64> = curve.points.iter().map(|p| p.ordinate / scale).collect();
    let (across, up) = (Axis::over(&abscissae), Axis::over(&ordinates));
    let x = |value: f64| LEFT + across.fraction(value) * (WIDTH - LEFT - RIGHT);
    let y = |value: f64| HEIGHT - BOTTOM - up.fraction(value) * (HEIGHT - TOP - BOTTOM);
    let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
    let mut out = Svg(String::new());
    out.line(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"13\">"
    ));
    out.line(format_args!("<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>"));
    for tick in across.ticks() {
        let at = x(tick);
        out.line(format_args!("<path d=\"M{at:.2} {TOP}V{bottom}\" stroke=\"{}\"/>", shade(tick)));
        out.text(at, bottom + 18.0, "middle", &across.label(tick));
    }
    for tick in up.ticks() {
        let at = y(tick);
        out.line(format_args!("<path d=\"M{LEFT} {at:.2}H{right}\" stroke=\"{}\"/>", shade(tick)));
        out.text(LEFT - 8.0, at + 4.5, "end", &up.label(tick));
    }
    out.line(format_args!("<path d=\"M{LEFT} {TOP}V{bottom}H{right}\" fill=\"none\" stroke=\"black\"/>"));
    let points: Vec<String> =
        abscissae.iter().zip(&ordinates).map(|(&a, &o)| format!("{:.2},{:.2}", x(a), y(o))).collect();
    let points = points.join(" ");
    out.line(format_args!("<polyline points=\"{points}\" fill=\"none\" stroke=\"#1f5fbf\" stroke-width=\"2\"/>"));
    out.text(WIDTH / 2.0, 26.0, "middle", curve.kind.title());
    out.text((LEFT + right) / 2.0, HEIGHT - 14.0, "middle", curve.kind.abscissa());
    let middle = (TOP + bottom) / 2.0;
    let label = format!("{} [{unit}]", curve.kind.ordinate());
    out.line(format_args!(
        "<text transform=\"translate(20 {middle}) rotate(-90)\" text-anchor=\"middle\">{label}</text>"
    ));
    out.line(format_args!("</svg>"));
    out.0
}

struct Svg(String);

impl Svg {
    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        writeln!(self.0, "{line}").expect("strings can be written to");
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        self.line(format_args!("<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\">{text}</text>"));
    }
}

/// The line of zero is darker than the others.
fn shade(tick: f64) -> &'static str {
    if tick == 0.0 { "#888" } else { "#ddd" }
}

/// The prefix in which the largest stress has one to three digits before the point.
fn pascals(largest: f64) -> (f64, &'static str) {
    let units = [(1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa")];
    units.into_iter().find(|u| largest >= u.0).unwrap_or((1.0, "Pa"))
}

/// A range with round ticks.
struct Axis {
    low: f64,
    high: f64,
    step: f64,
}

impl Axis {
    /// Around all values; around the only one, or around zero, where there is nothing to see.
    fn over(values: &[f64]) -> Axis {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 1.0) };
        let (low, high) = if high > low { (low, high) } else { (low - 0.5, high + 0.5) };
        // About six ticks of 1, 2 or 5 times a power of ten.
        let rough = (high - low) / 6.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough).unwrap_or(10.0 * power);
        Axis { low, high, step }
    }

    fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    fn ticks(&self) -> Vec<f64> {
        let first = (self.low / self.step - 1e-9).ceil();
        let count = ((self.high / self.step + 1e-9).floor() - first).max(0.0) as usize;
        // `+ 0.0` turns −0 into 0.
        (0..=count).map(|k| (first + k as f64) * self.step + 0.0).collect()
    }

    fn label(&self, tick: f64) -> String {
        let digits = (-self.step.log10().floor()).clamp(0.0, 12.0) as usize;
        format!("{tick:.digits$}").replace('-', "−")
    }
}
