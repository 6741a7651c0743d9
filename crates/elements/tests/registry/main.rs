//! Promises that every element and every rule keeps, checked over the registry: a new file is under test at once.

mod defaults;
mod evaluation;
mod exchange;
mod interpolation;
mod rules;
mod sides;

use souple_elements::{Family, all, by_id};

/// The registry holds at least the elements and pairs that are promised to users, sorted and found by their ids.
#[test]
fn registry_is_complete_and_sorted() {
    assert!(all().len() >= 19, "{} elements", all().len());
    let pairs: usize = all().iter().map(|e| e.quadratures.len()).sum();
    assert!(pairs >= 53, "{pairs} element-quadrature pairs");
    assert!(all().windows(2).all(|w| (w[0].dimension(), w[0].family) <= (w[1].dimension(), w[1].family)));
    for element in all() {
        let found = by_id(element.id).expect("a listed element is found by its id");
        assert_eq!(found.nodes, element.nodes, "two elements are called {}", element.id);
        assert_eq!(all().iter().filter(|e| e.id == element.id).count(), 1, "{}", element.id);
    }
    for family in Family::ALL {
        let linear = all().iter().find(|e| e.family == family).expect("each family has an element");
        assert_eq!(linear.node_count(), family.corner_count(), "{}", linear.id);
    }
}
