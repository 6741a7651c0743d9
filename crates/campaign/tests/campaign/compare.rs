//! Two groups side by side.

use crate::report::group;
use souple_campaign::compare::{Compared, compare};
use souple_campaign::report::data::Parameter;
use souple_campaign::report::quantities::Kind;

fn quantity<'c>(all: &'c [Compared], name: &str) -> &'c Compared {
    all.iter().find(|q| q.name == name).unwrap_or_else(|| panic!("{name}"))
}

/// A group against itself: every simulation that came to its end is a pair, times have ratio 1, results do not differ, and
/// what looks the same several times is said to.
#[test]
fn a_group_agrees_with_itself() {
    let c = compare(&group(), &group());
    // The three that did not come to their end repeat the parameters of the first one.
    assert_eq!(c.pairs.len(), 15);
    for side in &c.sides {
        assert_eq!((side.ambiguous.as_slice(), side.unmatched.len()), (&[0, 16, 17, 18][..], 0));
        assert!(side.only_parameters.is_empty() && side.only_quantities.is_empty());
    }
    assert!(c.pairs.iter().all(|p| p.a == p.b));
    for q in &c.quantities {
        let same = if q.kind == Kind::Time { 1.0 } else { 0.0 };
        assert!(q.range.is_none_or(|range| range == [same; 3]), "{q:?}");
    }
}

/// Another machine: half the time, one result changed, one simulation failed, one missing; a parameter that is written
/// otherwise is the same, and one that only one side has is said.
#[test]
fn differences_are_found() {
    let mut a = group();
    a.simulations.truncate(16);
    let mut b = a.clone();
    for s in &mut b.simulations {
        let done = s.done.as_mut().unwrap();
        done.wall_s *= 0.5;
        s.values.push(Some("7".to_owned()));
        if s.values[1].as_deref() == Some("0.3") {
            s.values[1] = Some("3e-1".to_owned());
        }
    }
    b.parameters.push(Parameter { name: "time.end".to_owned(), count: 1, ..b.parameters[0].clone() });
    b.simulations[2].done.as_mut().unwrap().measurements[1].value *= 2.0;
    b.simulations[5].done.as_mut().unwrap().status = "failed".to_owned();
    b.simulations.remove(9);
    let c = compare(&a, &b);
    assert_eq!((c.pairs.len(), c.sides[0].unmatched.as_slice(), c.sides[1].unmatched.len()), (14, &[9][..], 0));
    assert_eq!((c.ended_differently[0].pair.a, c.ended_differently[0].b.as_str()), (5, "failed"));
    assert_eq!(c.sides[1].only_parameters, ["time.end"]);
    assert_eq!(quantity(&c.quantities, "wall time").range, Some([0.5; 3]));
    assert_eq!(quantity(&c.quantities, "nodes").range, Some([0.0; 3]));
    assert_eq!(quantity(&c.quantities, "tip mean displacement y").range, Some([0.0, 0.0, 0.5]));
}
