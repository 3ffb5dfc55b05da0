//! Kinds of numbers.

mod private {
    pub trait Sealed {}
}

/// A kind of number that image data can hold: `f64`, `f32` or `i32`.
pub trait Number: private::Sealed + Copy + Default {
    /// The kind's name in the format.
    const KIND: &'static str;
    /// Adds the number's bytes, the least significant first.
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! number {
    ($($kind:ty, $name:literal;)*) => {$(
        impl private::Sealed for $kind {}
        impl Number for $kind {
            const KIND: &'static str = $name;
            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    )*};
}

number! {
    f64, "Float64";
    f32, "Float32";
    i32, "Int32";
}
