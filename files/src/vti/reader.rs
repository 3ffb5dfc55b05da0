//! Reader of uncompressed files written by this crate.

use super::attributes::escape_xml;

/// Values of an array of doubles in a file written by [`ImageData`](super::image_data::ImageData) with
/// [`Storage::Plain`](super::encoding::Storage::Plain); `None` if the file has another format or is damaged, or the
/// array is absent.
pub fn read_plain_values(bytes: &[u8], name: &str) -> Option<Vec<f64>> {
    let (numbers, []) = find_array(bytes, "Float64", name)?.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// Values of an array of 32-bit integers in a file, as [`read_plain_values`].
pub fn read_plain_integers(bytes: &[u8], name: &str) -> Option<Vec<i32>> {
    let (numbers, []) = find_array(bytes, "Int32", name)?.as_chunks() else { return None };
    Some(numbers.iter().map(|number| i32::from_le_bytes(*number)).collect())
}

/// Returns the bytes of the numbers of an array.
fn find_array<'a>(bytes: &'a [u8], kind: &str, name: &str) -> Option<&'a [u8]> {
    const HEADER_END: &[u8] = b"<AppendedData encoding=\"raw\">\n   _";
    let end = bytes.windows(HEADER_END.len()).position(|window| window == HEADER_END)?;
    let head = std::str::from_utf8(&bytes[..end]).ok()?;
    if head.contains(" compressor=") {
        return None;
    }
    let named = format!(" type=\"{kind}\" Name=\"{}\" ", escape_xml(name));
    let element = head.lines().find(|line| line.contains(&named) && line.contains(" offset="))?;
    let offset = element.split(" offset=\"").nth(1)?.split('"').next()?.parse::<usize>().ok()?;
    let values = bytes.get(end + HEADER_END.len()..)?.get(offset..)?;
    let (length, values) = values.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    values.get(..length)
}

/// Time of a file written by [`ImageData`](super::image_data::ImageData); `None` if the file has another format or no
/// time.
pub fn read_plain_time(bytes: &[u8]) -> Option<f64> {
    const TIME_ATTRIBUTES: &[u8] = b" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">";
    let start =
        bytes.windows(TIME_ATTRIBUTES.len()).position(|window| window == TIME_ATTRIBUTES)?
            + TIME_ATTRIBUTES.len();
    let text = bytes.get(start..)?.split(|byte| *byte == b'<').next()?;
    std::str::from_utf8(text).ok()?.parse().ok()
}
