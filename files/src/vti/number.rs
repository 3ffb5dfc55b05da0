//! Number types of VTK arrays.

mod private {
    pub trait Sealed {}
}

/// A number type of VTK arrays: `f64`, `f32`, `i32` or `i64`.
pub trait VtkNumber: private::Sealed + Copy + Default {
    /// Name of the type in VTK XML.
    const VTK_TYPE: &'static str;
    /// Appends the little-endian bytes of the number.
    fn append_bytes(self, bytes: &mut Vec<u8>);
}

macro_rules! impl_vtk_number {
    ($($kind:ty, $name:literal;)*) => {$(
        impl private::Sealed for $kind {}
        impl VtkNumber for $kind {
            const VTK_TYPE: &'static str = $name;
            fn append_bytes(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    )*};
}

impl_vtk_number! {
    f64, "Float64";
    f32, "Float32";
    i32, "Int32";
    i64, "Int64";
}
