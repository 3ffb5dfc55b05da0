//! Short lists on the stack, without heap allocation: assessing a state needs hundreds of them.

use smallvec::SmallVec;

/// A list of up to `N` items on the stack, enough for the models of this project; longer lists move to the heap.
pub type StackList<T, const N: usize = 8> = SmallVec<[T; N]>;

/// Creates a [`StackList`], with the syntax of `vec!`.
macro_rules! list {
    ($($items:tt)*) => {{
        let list: crate::list::StackList<_> = smallvec::smallvec![$($items)*];
        list
    }};
}
pub(crate) use list;
