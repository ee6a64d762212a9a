//! Small pictures: cut to what is drawn, averaged down, with few colours.

use std::error::Error;

type Done<T> = Result<T, Box<dyn Error>>;
type Pixel = [u8; 3];

/// Numbers of colours that are tried, the best first.
const COLOURS: [usize; 5] = [64, 48, 32, 24, 16];
/// Paper left around what is drawn, px of the small picture.
const MARGIN: usize = 8;
/// Rounds in which colours move to the mean of the pixels they stand for.
const ROUNDS: usize = 6;

struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Pixel>,
}

/// A PNG file no wider than `width`, and of no more than `most` bytes if 16 colours allow it.
pub fn shrink(png: &[u8], width: usize, most: usize) -> Done<Vec<u8>> {
    let image = read(png)?;
    let image = trimmed(&image, MARGIN * image.width / width.min(image.width));
    let image = averaged(&image, width);
    let mut bytes = Vec::new();
    for count in COLOURS {
        let palette = palette(&image, count);
        bytes = write(&image, &palette)?;
        if bytes.len() <= most {
            return Ok(bytes);
        }
    }
    Err(format!("{} bytes with {} colours; {most} are allowed", bytes.len(), COLOURS[COLOURS.len() - 1]).into())
}

fn read(bytes: &[u8]) -> Done<Image> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info()?;
    let mut buffer = vec![0; reader.output_buffer_size().ok_or("a picture too large")?];
    let info = reader.next_frame(&mut buffer)?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
        return Err("not a picture of Torse: RGB with 8 bits".into());
    }
    let pixels = buffer.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    Ok(Image { width: info.width as usize, height: info.height as usize, pixels })
}

/// Without paper, which has the colour of the first pixel, beyond a margin.
fn trimmed(image: &Image, margin: usize) -> Image {
    let paper = image.pixels[0];
    let drawn = |x: usize, y: usize| image.pixels[y * image.width + x] != paper;
    let column = |x: &usize| (0..image.height).any(|y| drawn(*x, y));
    let row = |y: &usize| (0..image.width).any(|x| drawn(x, *y));
    let range = |first: Option<usize>, last: Option<usize>, size: usize| match (first, last) {
        (Some(a), Some(b)) => a.saturating_sub(margin)..(b + 1 + margin).min(size),
        _ => 0..size,
    };
    let xs = range((0..image.width).find(column), (0..image.width).rev().find(column), image.width);
    let ys = range((0..image.height).find(row), (0..image.height).rev().find(row), image.height);
    let pixels = ys.clone().flat_map(|y| xs.clone().map(move |x| image.pixels[y * image.width + x])).collect();
    Image { width: xs.len(), height: ys.len(), pixels }
}

/// Every pixel the mean of those it covers, weighted by area. The means are of sRGB values as they are: means of light
/// would make thin dark lines on white paper fade.
fn averaged(image: &Image, width: usize) -> Image {
    if image.width <= width {
        return Image { width: image.width, height: image.height, pixels: image.pixels.clone() };
    }
    let scale = image.width as f64 / width as f64;
    let height = ((image.height as f64 / scale).round() as usize).max(1);
    // Pixels covered by the k-th small one, and how much of each.
    let covered = |k: usize, size: usize| -> Vec<(usize, f64)> {
        let (a, b) = (k as f64 * scale, ((k + 1) as f64 * scale).min(size as f64));
        let share = |i: usize| (b.min((i + 1) as f64) - a.max(i as f64)).max(0.0);
        ((a as usize).min(size - 1)..(b.ceil() as usize).min(size)).map(|i| (i, share(i))).collect()
    };
    let columns: Vec<_> = (0..width).map(|x| covered(x, image.width)).collect();
    let mut pixels = Vec::with_capacity(width * height);
    for y in 0..height {
        let rows = covered(y, image.height);
        for column in &columns {
            let (mut sum, mut weight) = ([0.0; 3], 0.0);
            for (j, v) in &rows {
                for (i, u) in column {
                    let p = image.pixels[j * image.width + i];
                    (0..3).for_each(|k| sum[k] += u * v * f64::from(p[k]));
                    weight += u * v;
                }
            }
            pixels.push(sum.map(|s| (s / f64::max(weight, 1e-12)).round() as u8));
        }
    }
    Image { width, height, pixels }
}

fn distance(a: &Pixel, b: &Pixel) -> u32 {
    (0..3).map(|k| u32::from(a[k].abs_diff(b[k])).pow(2)).sum()
}

fn nearest(palette: &[Pixel], p: &Pixel) -> usize {
    (0..palette.len()).min_by_key(|i| distance(&palette[*i], p)).unwrap_or(0)
}

/// So many colours for all pixels: boxes of colours are halved, always the one that spreads most, and then every colour
/// moves to the mean of its pixels. The paper keeps its own.
fn palette(image: &Image, count: usize) -> Vec<Pixel> {
    let paper = image.pixels[0];
    let mut counted = std::collections::BTreeMap::new();
    image.pixels.iter().filter(|p| **p != paper).for_each(|p| *counted.entry(*p).or_insert(0u32) += 1);
    let mut boxes: Vec<Vec<(Pixel, u32)>> = vec![counted.into_iter().collect()];
    let mean = |b: &[(Pixel, u32)]| -> [f64; 3] {
        let total: f64 = b.iter().map(|(_, n)| f64::from(*n)).sum();
        [0, 1, 2].map(|k| b.iter().map(|(p, n)| f64::from(p[k]) * f64::from(*n)).sum::<f64>() / total.max(1.0))
    };
    // The channel that spreads most, and how much.
    let spread = |b: &[(Pixel, u32)]| -> (usize, f64) {
        let m = mean(b);
        let of = |k: usize| b.iter().map(|(p, n)| (f64::from(p[k]) - m[k]).powi(2) * f64::from(*n)).sum::<f64>();
        [0, 1, 2].map(|k| (k, of(k))).into_iter().fold((0, -1.0), |a, b| if b.1 > a.1 { b } else { a })
    };
    let mut spreads = vec![spread(&boxes[0])];
    while boxes.len() + 1 < count {
        let widest = (0..boxes.len()).max_by(|a, b| spreads[*a].1.total_cmp(&spreads[*b].1)).unwrap_or(0);
        let (channel, width) = spreads[widest];
        if width <= 0.0 {
            break;
        }
        let middle = mean(&boxes[widest])[channel];
        let (low, high): (Vec<_>, Vec<_>) =
            std::mem::take(&mut boxes[widest]).into_iter().partition(|(p, _)| f64::from(p[channel]) <= middle);
        spreads[widest] = spread(&low);
        boxes[widest] = low;
        spreads.push(spread(&high));
        boxes.push(high);
    }
    let rounded = |b: &Vec<(Pixel, u32)>| mean(b).map(|x| x.round() as u8);
    for _ in 0..ROUNDS {
        let colours: Vec<Pixel> = boxes.iter().map(rounded).collect();
        let mut moved = vec![Vec::new(); boxes.len()];
        boxes.iter().flatten().for_each(|c| moved[nearest(&colours, &c.0)].push(*c));
        moved.retain(|b| !b.is_empty());
        boxes = moved;
    }
    std::iter::once(paper).chain(boxes.iter().map(rounded)).collect()
}

/// A PNG file with a palette, each pixel in as few bits as that needs.
fn write(image: &Image, palette: &[Pixel]) -> Done<Vec<u8>> {
    let mut known = std::collections::BTreeMap::new();
    let index = |p: &Pixel| *known.entry(*p).or_insert_with(|| nearest(palette, p) as u8);
    let indices: Vec<u8> = image.pixels.iter().map(index).collect();
    let four_bits = palette.len() <= 16;
    let rows = indices.chunks(image.width);
    let data: Vec<u8> = if four_bits {
        rows.flat_map(|row| row.chunks(2).map(|c| c[0] << 4 | c.get(1).copied().unwrap_or(0))).collect()
    } else {
        indices
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, u32::try_from(image.width)?, u32::try_from(image.height)?);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(if four_bits { png::BitDepth::Four } else { png::BitDepth::Eight });
    encoder.set_palette(palette.concat());
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}
