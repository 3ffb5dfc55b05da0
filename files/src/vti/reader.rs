//! Reader of uncompressed files written by this crate.

use super::attributes::escape_xml;

/// Values of an array of doubles in a file written by [`ImageData`](super::image_data::ImageData) with
/// [`Storage::Plain`](super::encoding::Storage::Plain); `None` if the file has another format or is damaged, or the
/// array is absent.
pub fn read_plain_values(bytes: &[u8], name: &str) -> Option<Vec<f64>> {
    const HEADER_END: &[u8] = b"<AppendedData encoding=\"raw\">\n   _";
    let end = bytes.windows(HEADER_END.len()).position(|window| window == HEADER_END)?;
    let head = std::str::from_utf8(&bytes[..end]).ok()?;
    if head.contains(" compressor=") {
        return None;
    }
    let named = format!(" type=\"Float64\" Name=\"{}\" ", escape_xml(name));
    let element = head.lines().find(|line| line.contains(&named) && line.contains(" offset="))?;
    let offset = element.split(" offset=\"").nth(1)?.split('"').next()?.parse::<usize>().ok()?;
    let values = bytes.get(end + HEADER_END.len()..)?.get(offset..)?;
    let (length, values) = values.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (numbers, []) = values.get(..length)?.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
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
