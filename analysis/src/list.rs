//! Short lists that live on the stack: judging a state takes hundreds of them.

use smallvec::SmallVec;

/// A list with room for `N` items, long enough for what the models of this project lead to; longer
/// ones move to the heap.
pub type List<T, const N: usize = 8> = SmallVec<[T; N]>;

/// A [`List`] written like an array.
macro_rules! list {
    ($($items:tt)*) => {{
        let list: crate::list::List<_> = smallvec::smallvec![$($items)*];
        list
    }};
}
pub(crate) use list;
