use souple_forms::Loops;
use souple_operators::{Association, derive};
use souple_program::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let e = souple_elements::by_id(&a[1]).unwrap();
    let l = souple_laws::by_id(&a[2]).unwrap();
    let d = derive(Association { element: e, law: l, rule: e.default_rule(), loops: Loops::Rolled }, Costs::default());
    if a.len() > 4 {
        let named: Vec<_> =
            (if a[3].starts_with("tangent") { &d.definition.tangent_apply } else { &d.definition.force })
                .iter()
                .enumerate()
                .map(|(k, &e)| (format!("f{k}"), e))
                .collect();
        for (n, f) in
            souple_symbols::print::definitions(&d.definition.graph, &named, souple_symbols::print::Style::Text)
        {
            println!("{n} = {f}");
        }
    }
    println!("{}", print(d.staged.program(&a[3]).unwrap()));
}
