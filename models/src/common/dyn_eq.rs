//! Equality of values behind trait objects, and recovery of their concrete type.

use std::any::Any;

/// Equality and downcasting of values behind a trait object.
pub trait DynEq: Any {
    /// Whether `other` has the same concrete type and is equal to `self`.
    fn dyn_eq(&self, other: &dyn Any) -> bool;

    /// `self` as [`Any`], for `downcast_ref`.
    fn as_any(&self) -> &dyn Any;
}

impl<T: PartialEq + Any> DynEq for T {
    fn dyn_eq(&self, other: &dyn Any) -> bool {
        other.downcast_ref() == Some(self)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
