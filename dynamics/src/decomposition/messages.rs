//! Messages between ranks: lists of numbers, each preceded by its length.

use crate::simd::Real;

/// Appends numbers without their count.
pub(super) fn append_numbers<T: Real>(message: &mut Vec<u8>, numbers: &[T]) {
    let start = message.len();
    message.resize(start + size_of_val(numbers), 0);
    T::write_bytes(numbers, &mut message[start..]);
}

/// Appends a list of numbers.
pub(super) fn append_list<T: Real>(message: &mut Vec<u8>, numbers: &[T]) {
    message.extend((numbers.len() as u64).to_le_bytes());
    append_numbers(message, numbers);
}

/// Removes a list of numbers from the front of a message; it is empty if the message has none.
pub(super) fn take_list<T: Real>(message: &mut &[u8]) -> Vec<T> {
    let length = take_number(message) as usize;
    let Some((list, rest)) = message.split_at_checked(length * size_of::<T>()) else {
        return Vec::new();
    };
    *message = rest;
    T::from_bytes(list).unwrap_or_default()
}

/// Appends a list of counts or indices.
pub(super) fn append_indices(message: &mut Vec<u8>, indices: &[usize]) {
    message.extend((indices.len() as u64).to_le_bytes());
    indices.iter().for_each(|index| message.extend((*index as u64).to_le_bytes()));
}

/// Removes a list of counts or indices from the front of a message; it is empty if the message has none.
pub(super) fn take_indices(message: &mut &[u8]) -> Vec<usize> {
    (0..take_number(message)).map(|_| take_number(message) as usize).collect()
}

/// Removes a number from the front of a message; zero if it has none.
fn take_number(message: &mut &[u8]) -> u64 {
    let Some((number, rest)) = message.split_first_chunk() else { return 0 };
    *message = rest;
    u64::from_le_bytes(*number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_in_the_order_of_writing() {
        let mut message = Vec::new();
        append_list(&mut message, &[1.5_f32, -0.0]);
        append_indices(&mut message, &[usize::MAX, 3]);
        append_list::<f64>(&mut message, &[]);
        append_list(&mut message, &[f64::MIN_POSITIVE / 4.0, f64::NEG_INFINITY]);
        let mut rest = message.as_slice();
        let single: Vec<f32> = take_list(&mut rest);
        assert_eq!(
            single.iter().map(|own| own.to_bits()).collect::<Vec<_>>(),
            [0x3fc0_0000, 1 << 31]
        );
        assert_eq!(take_indices(&mut rest), [usize::MAX, 3]);
        assert_eq!(take_list::<f64>(&mut rest), []);
        assert_eq!(take_list::<f64>(&mut rest), [f64::MIN_POSITIVE / 4.0, f64::NEG_INFINITY]);
        assert!(rest.is_empty() && take_list::<f64>(&mut rest).is_empty());
    }
}
