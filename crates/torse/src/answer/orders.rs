//! What a shop is told of each part, in numbers and, on the drawing, in words.

use super::Answer;
use crate::develop::same::{opposite_hands, same_parts, SamePart};
use crate::develop::shop::order::{cut_length, quantities, Quantity};
use crate::develop::unfold::bends::{BendKind, SheetBend};
use crate::draw::drawing::PartWords;
use crate::geom::unit::LengthUnit;
use crate::geom::Vec2;
use crate::patchwork::pattern::Pattern;

/// What is ordered of a part that lies flat.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartOrder {
    /// The earlier part that it equals.
    pub same: Option<SamePart>,
    /// The earlier pattern of whose part it is the mirror image, bent the same way.
    pub opposite: Option<usize>,
    /// How many parts its drawing stands for.
    pub quantity: Quantity,
    /// Of the sheet, mm.
    pub thickness: Option<f64>,
    /// Where material and thickness are known.
    pub weight_kg: Option<f64>,
    /// Of all cuts, mm.
    pub cut_length: f64,
    /// Closed outlines to be cut.
    pub pierces: usize,
}

/// The orders of all patterns, in their order.
pub(crate) fn orders(answer: &Answer) -> Vec<PartOrder> {
    let thicknesses: Vec<f64> = answer.sheets.iter().map(|s| s.thickness).collect();
    let same = same_parts(&answer.patterns, &thicknesses);
    let opposite = opposite_hands(&answer.patterns, &thicknesses, &same);
    let quantities = quantities(&same);
    let one = |(k, pattern): (usize, &Pattern)| {
        let own = thicknesses.get(k).copied().filter(|t| *t > 0.0);
        let thickness = own.or(answer.shop.thickness);
        let weight = answer.shop.material.as_ref().zip(thickness).map(|(m, t)| m.weight(pattern.area, t));
        PartOrder {
            same: same[k],
            opposite: opposite[k],
            quantity: quantities[k],
            thickness,
            weight_kg: weight.filter(|w| w.is_finite()),
            cut_length: cut_length(pattern),
            pierces: pattern.contours.len(),
        }
    };
    answer.patterns.iter().enumerate().map(one).collect()
}

/// What is written on the drawing of each pattern besides its name: sheet and work, how many are equal, and the bends by their
/// numbers in the bend table.
pub(super) fn words(answer: &Answer, orders: &[PartOrder]) -> Vec<PartWords> {
    let unit = answer.cut.unit;
    let one = |(k, o): (usize, &PartOrder)| {
        let bends = answer.sheets.get(k).map_or(&[][..], |s| &s.bends);
        PartWords { lines: lines(answer, o), bends: bends.iter().enumerate().filter_map(|b| bend(b, unit)).collect() }
    };
    orders.iter().enumerate().map(one).collect()
}

fn lines(answer: &Answer, order: &PartOrder) -> Vec<String> {
    let unit = answer.cut.unit;
    let length = |mm: f64| match unit {
        LengthUnit::Inch => format!("{} IN", short(unit.of(mm), 3)),
        LengthUnit::Millimetre => format!("{} MM", short(mm, 2)),
    };
    let material = answer.shop.material.as_ref().map(|m| m.name.to_uppercase());
    let mut out = Vec::new();
    let sheet: Vec<String> = order.thickness.map(length).into_iter().chain(material).collect();
    if !sheet.is_empty() {
        out.push(sheet.join(" "));
        let weight = order.weight_kg.map(|kg| format!("{} KG", short(kg, 3)));
        // To a millimetre or a tenth of an inch: for the price, not for the cut.
        let cut = match unit {
            LengthUnit::Inch => format!("CUT {} IN", short(unit.of(order.cut_length), 1)),
            LengthUnit::Millimetre => format!("CUT {} MM", short(order.cut_length, 0)),
        };
        let pierces = format!("{} PIERCE{}", order.pierces, if order.pierces == 1 { "" } else { "S" });
        out.push(weight.into_iter().chain([cut, pierces]).collect::<Vec<_>>().join(", "));
    }
    let name = |k: usize| answer.patterns[k].name.to_uppercase();
    let Quantity { as_drawn, turned_over } = order.quantity;
    match (order.same, order.opposite) {
        (Some(same), _) if same.mirrored => out.push(format!("EQUALS {} TURNED OVER", name(same.pattern))),
        (Some(same), _) => out.push(format!("EQUALS {}", name(same.pattern))),
        (None, Some(other)) => out.push(format!("OPPOSITE HAND OF {}", name(other))),
        (None, None) => {}
    }
    if as_drawn + turned_over > 1 {
        out.push(format!("FIRST OF {} EQUAL PARTS", as_drawn + turned_over));
    }
    out
}

/// What is written beside a bend, its number, way, angle and inside radius, and where: the lines in which it begins and ends, and the
/// middle one of those drawn.
fn bend((k, b): (usize, &SheetBend), unit: LengthUnit) -> Option<(Vec<[Vec2; 2]>, String)> {
    let middle = b.lines.get(b.lines.len() / 2)?;
    let beside: Vec<[Vec2; 2]> = b.extents.iter().chain([middle]).copied().collect();
    let radius = match b.kind {
        BendKind::Bend if b.inside_radius.is_finite() => format!(" R{}", short(unit.of(b.inside_radius), 3)),
        BendKind::Rolled => " ROLLED".into(),
        _ => String::new(),
    };
    Some((beside, format!("{} {} {}{radius}", k + 1, b.sense.name().to_uppercase(), short(b.angle.to_degrees(), 1))))
}

/// A number with so many decimals at most, without idle zeros.
fn short(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Job;
    use crate::develop::shop::material::Material;

    #[test]
    fn drawings_tell_sheet_and_work_where_these_are_known() {
        let mut answer = Answer { patterns: vec![Pattern::default()], ..Answer::new(Job::Unroll, "duct", 0.1) };
        let order = PartOrder {
            cut_length: 1234.4,
            pierces: 3,
            quantity: Quantity { as_drawn: 2, turned_over: 1 },
            ..PartOrder::default()
        };
        assert_eq!(lines(&answer, &order), ["FIRST OF 3 EQUAL PARTS"]);
        let (note, source) = (String::new(), String::new());
        let card = Material { name: "steel".into(), density: 7850.0, least_radius: None, k: None, note, source };
        answer.shop.material = Some(card);
        let order = PartOrder { thickness: Some(1.5), weight_kg: Some(0.25), ..order };
        let told = lines(&answer, &order);
        assert_eq!(told[1], "0.25 KG, CUT 1234 MM, 3 PIERCES");
        assert!(told[0] == "1.5 MM STEEL" && told.len() == 3, "{told:?}");
        answer.cut.unit = LengthUnit::Inch;
        assert_eq!(lines(&answer, &order)[..2], ["0.059 IN STEEL", "0.25 KG, CUT 48.6 IN, 3 PIERCES"]);
        let same = Some(SamePart { pattern: 0, mirrored: true });
        answer.patterns[0].name = "a-01".into();
        let order = PartOrder { same, quantity: Quantity::default(), ..PartOrder::default() };
        answer.shop.material = None;
        assert_eq!(lines(&answer, &order), ["EQUALS A-01 TURNED OVER"]);
    }

    #[test]
    fn numbers_have_no_idle_zeros() {
        assert_eq!([short(90.0, 1), short(10.0, 0), short(0.079, 3), short(2.5, 3)], ["90", "10", "0.079", "2.5"]);
    }
}
