//! Numbers in view: where the time goes, iterations, residual, energies, step times, warnings.

use super::running::Running;
use crate::numbers::{plain, with_unit};
use egui::{Color32, Rect, Sense, Ui, vec2};
use egui_plot::{Bar, BarChart, Legend, Line, Plot, PlotPoints};
use souple_simulation::session::Sample;

pub(super) fn ui(running: &mut Running, ui: &mut Ui) {
    let recent: Vec<Sample> = running.samples.iter().rev().take(50).copied().collect();
    ui.heading("Numbers");
    budget(&recent, running.draw_ms, ui);
    if let Some(last) = recent.first() {
        ui.label(format!("CG iterations {}", last.cg_iterations));
        ui.label(format!("relative residual {}", plain(last.residual)));
        let mut sorted: Vec<f64> = running.samples.iter().map(|s| s.milliseconds).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |q: f64| sorted[(q * (sorted.len() - 1) as f64).round() as usize];
        ui.label(format!("step: median {} ms, p99 {} ms", plain(at(0.5)), plain(at(0.99))));
        histogram(&sorted, at(0.99), ui);
    }
    energies(running, ui);
    warnings(running, ui);
}

/// One bar per step, its parts as wide as their share.
fn budget(recent: &[Sample], draw: f64, ui: &mut Ui) {
    let count = recent.len().max(1) as f64;
    // The sum of nothing is −0; adding 0 keeps its sign out of sight.
    let mean = |of: &dyn Fn(&Sample) -> f64| (recent.iter().map(of).sum::<f64>() + 0.0) / count;
    let (force, linearise) = (mean(&|s| s.phases.force), mean(&|s| s.phases.linearise));
    let (product, solve) = (mean(&|s| s.phases.product), mean(&|s| s.phases.rest_of_solve));
    let contact = mean(&|s| s.phases.contact);
    let rest = (mean(&|s| s.milliseconds) - contact - force - linearise - product - solve).max(0.0);
    let parts = [
        ("force", force, Color32::from_rgb(86, 180, 233)),
        ("tangent", linearise, Color32::from_rgb(230, 159, 0)),
        ("CG products", product, Color32::from_rgb(0, 158, 115)),
        ("CG rest", solve, Color32::from_rgb(204, 121, 167)),
        ("contact", contact, Color32::from_rgb(213, 94, 0)),
        ("rest of the step", rest, Color32::from_rgb(150, 150, 150)),
        ("draw", draw, Color32::from_rgb(0, 114, 178)),
    ];
    let total: f64 = parts.iter().map(|p| p.1).sum::<f64>().max(1e-9);
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let text = parts.iter().map(|(name, ms, _)| format!("{name} {ms:.2} ms")).collect::<Vec<_>>().join(", ");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, text.clone()));
    let mut left = area.left();
    for (_, ms, colour) in parts {
        let width = (ms / total) as f32 * area.width();
        let part = Rect::from_min_size(egui::pos2(left, area.top()), vec2(width, area.height()));
        ui.painter().rect_filled(part, 0.0, colour);
        left += width;
    }
    for (name, ms, colour) in parts {
        ui.horizontal(|ui| {
            let (swatch, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(swatch, 2.0, colour);
            ui.label(format!("{name} {ms:.2} ms"));
        });
    }
}

/// How often steps took how long.
fn histogram(sorted: &[f64], p99: f64, ui: &mut Ui) {
    const BINS: usize = 24;
    let top = (1.2 * p99).max(1e-6);
    let mut counts = [0u32; BINS];
    for ms in sorted {
        counts[((ms / top * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let width = top / BINS as f64;
    let bars = counts.iter().enumerate().map(|(k, &n)| Bar::new((k as f64 + 0.5) * width, f64::from(n)).width(width));
    let chart = BarChart::new("steps", bars.collect());
    quiet(Plot::new("step times").height(80.0).x_axis_label("ms")).show(ui, |plot| plot.bar_chart(chart));
}

fn energies(running: &Running, ui: &mut Ui) {
    let line = |of: &dyn Fn(&Sample) -> f64| -> PlotPoints<'static> {
        running.samples.iter().map(|s| [s.time, of(s)]).collect::<Vec<[f64; 2]>>().into()
    };
    let (kinetic, strain) = (line(&|s| s.kinetic_energy), line(&|s| s.strain_energy));
    if let Some(last) = running.samples.back() {
        let (k, s) = (with_unit(last.kinetic_energy, "J"), with_unit(last.strain_energy, "J"));
        ui.label(format!("kinetic energy {k}, strain energy {s}"));
    }
    quiet(Plot::new("energies").height(140.0).legend(Legend::default()).x_axis_label("s")).show(ui, |plot| {
        plot.line(Line::new("kinetic", kinetic));
        plot.line(Line::new("strain", strain));
    });
}

/// A plot that leaves the wheel to its panel.
fn quiet(plot: Plot<'_>) -> Plot<'_> {
    plot.allow_scroll(false).allow_zoom(false).allow_drag(false)
}

fn warnings(running: &mut Running, ui: &mut Ui) {
    let inverted = running.snapshot.inverted.clone();
    if !inverted.is_empty() {
        ui.colored_label(ui.visuals().warn_fg_color, format!("{} elements are inside out", inverted.len()));
        ui.horizontal(|ui| {
            if ui.button("Show them").clicked() {
                running.look.marked.clone_from(&inverted);
            }
            if ui.button("Go there").clicked() {
                let nodes = running.model.nodes_of(inverted[0]);
                running.camera.target = running.snapshot.positions[nodes[0] as usize];
            }
        });
        ui.label(running.model.describe(inverted[0]));
    }
    for warning in running.snapshot.warnings.iter().rev().take(8) {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    }
}
