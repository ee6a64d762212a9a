//! Colours of pictures: panels kept apart by hue, deviations on a diverging scale. Knows nothing of geometry.
//!
//! All mixing happens in the OKLab space (Ottosson 2020), where equal steps look equal.

use crate::torse::form::PanelKind;
use std::sync::LazyLock;

/// An sRGB colour, 0..=1 per channel.
pub type Rgb = [f64; 3];

/// A colour of OKLab given by lightness, chroma and hue (degrees), clipped to sRGB.
pub(crate) fn oklch(lightness: f64, chroma: f64, hue_deg: f64) -> Rgb {
    let h = hue_deg.to_radians();
    from_oklab([lightness, chroma * h.cos(), chroma * h.sin()])
}

/// The colour of the `index`-th panel: successive panels lie a golden angle apart in hue and differ in lightness.
pub fn panel(index: usize) -> Rgb {
    // The golden angle never repeats a hue and keeps any few consecutive ones far apart.
    const GOLDEN_ANGLE_DEG: f64 = 137.507_764;
    const FIRST_HUE_DEG: f64 = 245.0;
    const LIGHTNESS: [f64; 3] = [0.77, 0.84, 0.71];
    const CHROMA: f64 = 0.115;
    oklch(LIGHTNESS[index % LIGHTNESS.len()], CHROMA, FIRST_HUE_DEG + GOLDEN_ANGLE_DEG * (index % 3600) as f64)
}

/// The colour of what must not be cut; no panel and no deviation within its limits has it.
pub(crate) const NOT_CERTIFIED: Rgb = [0.86, 0.16, 0.16];

/// The colour of the `index`-th panel, or that of what must not be cut.
pub(crate) fn shown(index: usize, marked: bool) -> Rgb {
    if marked {
        NOT_CERTIFIED
    } else {
        panel(index)
    }
}

/// Stops (lightness, chroma, hue in degrees) of the deviation scale from −1 to 1: blue, white, red.
const DEVIATION_STOPS: [(f64, f64, f64); 7] = [
    (0.40, 0.135, 262.0),
    (0.60, 0.130, 245.0),
    (0.82, 0.070, 228.0),
    (0.965, 0.0, 0.0),
    (0.85, 0.085, 75.0),
    (0.66, 0.165, 45.0),
    (0.44, 0.160, 27.0),
];

/// Colour of a deviation, given as a share of the tolerance: −1 blue, 0 white, 1 red, beyond ±1 (and for values
/// that are not numbers) magenta.
pub(crate) fn deviation(share: f64) -> Rgb {
    // Room for rounding of values that lie exactly at the tolerance.
    const LIMIT: f64 = 1.0 + 1e-9;
    const BEYOND: Rgb = [0.80, 0.0, 0.75];
    if share.is_nan() || share.abs() > LIMIT {
        return BEYOND;
    }
    DEVIATIONS[((share.clamp(-1.0, 1.0) + 1.0) * 0.5 * (DEVIATION_STEPS - 1) as f64).round() as usize]
}

/// Steps of the deviation scale: neighbours differ by about half a step of 8 bits per channel.
const DEVIATION_STEPS: usize = 1025;

/// The deviation scale from −1 to 1: pictures ask for it at every pixel.
static DEVIATIONS: LazyLock<Vec<Rgb>> = LazyLock::new(|| {
    (0..DEVIATION_STEPS).map(|i| on_deviation_scale(2.0 * i as f64 / (DEVIATION_STEPS - 1) as f64 - 1.0)).collect()
});

/// The deviation scale at `share`, from −1 to 1.
fn on_deviation_scale(share: f64) -> Rgb {
    let last = DEVIATION_STOPS.len() - 1;
    let x = (share + 1.0) * 0.5 * last as f64;
    let i = (x.floor() as usize).min(last - 1);
    let f = x - i as f64;
    let lab = |(l, c, h): (f64, f64, f64)| {
        let h = h.to_radians();
        [l, c * h.cos(), c * h.sin()]
    };
    let (a, b) = (lab(DEVIATION_STOPS[i]), lab(DEVIATION_STOPS[i + 1]));
    from_oklab([0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * f))
}

/// Colour of a kind of developable, as they are told apart since \[W15, figure 4.18\]: light planes, green cylinders, red
/// cones, blue tangent surfaces.
pub(crate) fn kind(kind: PanelKind) -> Rgb {
    match kind {
        PanelKind::Plane => oklch(0.93, 0.03, 95.0),
        PanelKind::Cylinder => oklch(0.80, 0.13, 150.0),
        PanelKind::Cone => oklch(0.72, 0.16, 28.0),
        PanelKind::Torse => oklch(0.68, 0.13, 255.0),
        PanelKind::Ruled => oklch(0.68, 0.13, 330.0),
    }
}

/// `a` moved towards `b` by the share `f`, in sRGB.
pub fn mix(a: Rgb, b: Rgb, f: f64) -> Rgb {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * f)
}

/// `#rrggbb`.
pub(crate) fn hex(c: Rgb) -> String {
    let [r, g, b] = bytes(c);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Rounded to 8 bits per channel.
pub(crate) fn bytes(c: Rgb) -> [u8; 3] {
    c.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// OKLab to sRGB, clipped.
fn from_oklab([l, a, b]: [f64; 3]) -> Rgb {
    let lms = [
        l + 0.396_337_777_4 * a + 0.215_803_757_3 * b,
        l - 0.105_561_345_8 * a - 0.063_854_172_8 * b,
        l - 0.089_484_177_5 * a - 1.291_485_548 * b,
    ]
    .map(|x| x * x * x);
    let linear = [
        4.076_741_662_1 * lms[0] - 3.307_711_591_3 * lms[1] + 0.230_969_929_2 * lms[2],
        -1.268_438_004_6 * lms[0] + 2.609_757_401_1 * lms[1] - 0.341_319_396_5 * lms[2],
        -0.004_196_086_3 * lms[0] - 0.703_418_614_7 * lms[1] + 1.707_614_701 * lms[2],
    ];
    linear.map(|x| {
        let x = x.clamp(0.0, 1.0);
        if x <= 0.003_130_8 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_has_equal_channels_and_white_is_white() {
        for c in oklch(1.0, 0.0, 0.0) {
            assert!((c - 1.0).abs() < 1e-6);
        }
        let g = oklch(0.6, 0.0, 0.0);
        assert!((g[0] - g[1]).abs() < 1e-6 && (g[1] - g[2]).abs() < 1e-6);
    }

    #[test]
    fn neighbouring_panels_are_easy_to_tell_apart() {
        for i in 0..200 {
            for j in i + 1..i + 4 {
                let (a, b) = (panel(i), panel(j));
                let d = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                assert!(d > 0.15, "panels {i} and {j} differ by {d} only");
            }
        }
    }

    #[test]
    fn deviation_colours_diverge_from_white_and_flag_what_is_beyond() {
        let [minus, zero, plus] = [-0.9, 0.0, 0.9].map(deviation);
        assert!(minus[2] > minus[0] + 0.2 && plus[0] > plus[2] + 0.2);
        assert!(zero.iter().all(|&c| c > 0.93));
        assert_eq!(deviation(1.2), deviation(f64::NAN));
        assert_ne!(deviation(1.0), deviation(1.2));
    }
}
