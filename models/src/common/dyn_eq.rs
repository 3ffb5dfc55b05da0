//! Comparison and recovery of values behind a trait object.

use std::any::Any;

/// A value that can be compared with another behind the same trait object, and taken for what it is.
pub trait DynEq: Any {
    /// Whether the other is of the same type and equal.
    fn dyn_eq(&self, other: &dyn Any) -> bool;

    /// The value as any, for `downcast_ref`.
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
