//! Products with an assembled matrix: its parts shared between threads where that pays, put together in their order.

use souple_operators::Threads;
use souple_solver::{LinearOperator, ProductBuffers, Projector, Shift, SymmetricBlocks, product_in_parts};
use std::cell::RefCell;

/// A matrix, or k A + m M with the diagonal M of the masses.
#[derive(Clone, Copy)]
pub(super) struct Assembled<'a> {
    pub(super) matrix: &'a SymmetricBlocks,
    pub(super) shift: Option<Shift<'a>>,
    /// The values in single precision, to be used instead.
    pub(super) singles: Option<&'a [f32]>,
    pub(super) buffers: &'a RefCell<ProductBuffers>,
    pub(super) threads: &'a Threads,
}

impl<'a> Assembled<'a> {
    /// The matrix itself.
    pub(super) fn new(
        matrix: &'a SymmetricBlocks,
        buffers: &'a RefCell<ProductBuffers>,
        threads: &'a Threads,
    ) -> Assembled<'a> {
        Assembled { matrix, shift: None, singles: None, buffers, threads }
    }

    fn shared(&self) -> bool {
        self.threads.count() > 1 && self.matrix.parts().len() > 1
    }

    /// Runs all parts at once where several threads do.
    fn run_shared(&self, buffers: &mut ProductBuffers) {
        let (matrix, singles) = (self.matrix, self.singles);
        let (x, mut tasks) = matrix.tasks(buffers);
        self.threads.run(&mut tasks, |(part, sums)| match singles {
            Some(values) => matrix.run_part_of_singles(values, *part, x, sums),
            None => matrix.run_part(*part, x, sums),
        });
    }
}

impl LinearOperator for Assembled<'_> {
    fn len(&self) -> usize {
        LinearOperator::len(self.matrix)
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let buffers = &mut *self.buffers.borrow_mut();
        self.matrix.load(x, buffers);
        if self.shared() {
            self.run_shared(buffers);
        } else {
            for part in 0..self.matrix.parts().len() {
                self.matrix.run_part_in_place(self.singles, part, buffers);
            }
        }
        self.matrix.finish_rows(0..self.matrix.row_count(), self.shift, x, buffers, y);
    }

    fn apply_and_dot(&self, projector: &dyn Projector, p: &[f64], q: &mut [f64]) -> f64 {
        let (matrix, d) = (self.matrix, self.matrix.block());
        let buffers = &mut *self.buffers.borrow_mut();
        matrix.load(p, buffers);
        let mut done = 0;
        if self.shared() {
            self.run_shared(buffers);
            done = matrix.parts().len();
        }
        product_in_parts(projector, p, q, |first, q| {
            let rows = first / d..(first + q.len()) / d;
            while done < matrix.parts().len() && matrix.parts()[done].first < rows.end {
                matrix.run_part_in_place(self.singles, done, buffers);
                done += 1;
            }
            matrix.finish_rows(rows, self.shift, p, buffers, q);
        })
    }
}
