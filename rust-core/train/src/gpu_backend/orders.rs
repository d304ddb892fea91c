//! What the GPU was told to do and has not been heard of yet.

use std::collections::VecDeque;
use std::sync::Arc;

use super::targets::GpuTarget;
use crate::backend::TrainingView;
use crate::schedule::{DensifyPlan, StepPlan};

/// An order, with what it takes to give it again.
pub(super) enum Order {
    /// One step.
    Step(Box<StepOrder>),
    /// A change of the set after this many steps.
    Densify(DensifyPlan, u32),
}

/// A step, and its photograph, which the targets may have dropped by then.
pub(super) struct StepOrder {
    pub(super) plan: StepPlan,
    pub(super) view: TrainingView,
    pub(super) target: Arc<GpuTarget>,
}

/// Orders in the order in which they were given, with the number of splats before each.
#[derive(Default)]
pub(super) struct OrderLog {
    orders: VecDeque<(u32, Order)>,
}

impl OrderLog {
    pub(super) fn push(&mut self, splats: u32, order: Order) {
        self.orders.push_back((splats, order));
    }

    /// Forgets the oldest step, which was reported, and the changes before it; returns the step.
    pub(super) fn pop_step(&mut self) -> Option<Box<StepOrder>> {
        while let Some((_, order)) = self.orders.pop_front() {
            if let Order::Step(step) = order {
                return Some(step);
            }
        }
        None
    }

    /// Takes everything from the oldest step on: that and all later ones were not carried out. The
    /// changes before it were.
    pub(super) fn take_from_step(&mut self) -> Vec<(u32, Order)> {
        let is_step = |(_, order): &(u32, Order)| matches!(order, Order::Step(_));
        let first = self.orders.iter().position(is_step).unwrap_or(self.orders.len());
        self.orders.drain(..).skip(first).collect()
    }

    /// Whether a step up to and including `step` has not been reported.
    pub(super) fn waits_for(&self, step: u32) -> bool {
        self.orders.iter().any(|(_, order)| match order {
            Order::Step(order) => order.plan.step <= step,
            Order::Densify(..) => false,
        })
    }

    pub(super) fn clear(&mut self) {
        self.orders.clear();
    }
}
