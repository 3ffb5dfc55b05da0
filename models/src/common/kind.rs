//! Implementations shared by the references to registry entries, and by the shared pointers to laws.

/// Implements comparison, hashing and `Debug` of a reference `$kind` to a registry entry by the name of the entry.
macro_rules! impl_kind_by_name {
    ($kind:ty) => {
        impl PartialEq for $kind {
            fn eq(&self, other: &Self) -> bool {
                self.0.name == other.0.name
            }
        }

        impl Eq for $kind {}

        impl std::hash::Hash for $kind {
            fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
                self.0.name.hash(state);
            }
        }

        impl std::fmt::Debug for $kind {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str(self.0.name)
            }
        }
    };
}

/// Implements `Deref` from a reference `$kind` to its registry entry of type `$model`.
macro_rules! impl_deref_to_entry {
    ($kind:ty, $model:ty) => {
        impl std::ops::Deref for $kind {
            type Target = $model;

            fn deref(&self) -> &$model {
                self.0
            }
        }
    };
}

/// Implements construction, comparison, `Deref` and downcast of `$pointer`, a shared pointer to a law of any type that
/// implements the trait `$law`.
macro_rules! impl_shared_law {
    ($pointer:ident, $law:ident) => {
        impl<T: $law> From<T> for $pointer {
            fn from(law: T) -> Self {
                Self(Arc::new(law))
            }
        }

        impl PartialEq for $pointer {
            fn eq(&self, other: &Self) -> bool {
                self.0.dyn_eq(other.0.as_any())
            }
        }

        impl std::ops::Deref for $pointer {
            type Target = dyn $law;

            fn deref(&self) -> &Self::Target {
                &*self.0
            }
        }

        impl $pointer {
            /// Returns the value as its concrete type `T`; `None` if it has another type.
            pub fn downcast<T: $law>(&self) -> Option<&T> {
                self.0.as_any().downcast_ref()
            }
        }
    };
}

pub(crate) use {impl_deref_to_entry, impl_kind_by_name, impl_shared_law};
