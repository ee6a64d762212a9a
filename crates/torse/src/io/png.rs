//! PNG files from finished pictures (ISO/IEC 15948).

use crate::draw::raster::Image;

/// The picture could not be encoded.
#[derive(Debug, thiserror::Error)]
#[error("picture of {width} x {height} pixels cannot be written as PNG: {reason}")]
pub struct PngError {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// What the encoder says.
    pub reason: String,
}

/// The bytes of a PNG file, 8 bits per channel, sRGB.
///
/// # Errors
/// A picture without pixels, or larger than the format allows.
pub fn write(image: &Image) -> Result<Vec<u8>, PngError> {
    let fail = |reason: String| PngError { width: image.width, height: image.height, reason };
    let size = |n: usize| u32::try_from(n).map_err(|e| fail(e.to_string()));
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, size(image.width)?, size(image.height)?);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    // Fast: a third of the size more, a tenth of the time.
    encoder.set_compression(::png::Compression::Fast);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().map_err(|e| fail(e.to_string()))?;
    writer.write_image_data(image.pixels.as_flattened()).map_err(|e| fail(e.to_string()))?;
    writer.finish().map_err(|e| fail(e.to_string()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_survive_writing_and_reading() {
        let pixels: Vec<[u8; 3]> = (0..35u8).map(|i| [i, 7 * i, 255 - i]).collect();
        let image = Image { width: 7, height: 5, pixels };
        let bytes = write(&image).expect("an encoding");
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a header");
        let mut back = vec![0; 7 * 5 * 3];
        reader.next_frame(&mut back).expect("pixels");
        assert_eq!(back, image.pixels.as_flattened());
    }

    #[test]
    fn a_picture_with_missing_pixels_is_an_error() {
        assert!(write(&Image { width: 4, height: 4, pixels: vec![[0; 3]; 3] }).is_err());
    }
}
