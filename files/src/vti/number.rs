//! Number types of VTK arrays.

mod private {
    pub trait Sealed {}
}

/// A number type of VTK arrays: `f64`, `f32` or `i32`.
pub trait Number: private::Sealed + Copy + Default {
    /// Name of the type in VTK XML.
    const KIND: &'static str;
    /// Appends the little-endian bytes of the number.
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
