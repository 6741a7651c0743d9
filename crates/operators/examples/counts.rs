use souple_forms::Loops;
use souple_operators::{Association, derive};
use souple_program::*;
fn main() {
    for e in souple_elements::all() {
        for l in souple_laws::all() {
            for loops in [Loops::Rolled] {
                let t = std::time::Instant::now();
                let d = derive(Association { element: e, law: l, rule: e.default_rule(), loops }, Costs::default());
                let ms = t.elapsed().as_secs_f64() * 1e3;
                print!(
                    "{} {} {loops:?} {:.1} ms carry {:?} {:?}",
                    e.id, l.id, ms, d.staged.setup_to_step, d.staged.step_to_apply
                );
                for p in &d.staged.programs {
                    let c = Counts::of(&p.program);
                    print!(" | {} {} ({}+{})", p.program.name, c.operations, c.per_point, c.once);
                }
                println!();
            }
        }
    }
}
