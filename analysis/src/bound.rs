//! The supremum of the growth rate, where it is finite.
