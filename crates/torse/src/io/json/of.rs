//! The record of an answer.

use super::{
    AlongRecord, FaceRecord, FacetsRecord, FigureRecord, JoinRecord, JoinedRecord, JointRecord, NeutralRecord,
    PanelRecord, PartRecord, PointRecord, Report, SeamRecord, ShapeRecord, SkippedRecord, WitnessRecord, WrittenRecord,
    SCHEMA, UNKNOWN,
};
use crate::answer::joints::joints;
use crate::answer::note::Note;
use crate::answer::presentation::Presentation;
use crate::answer::shapes::Shape;
use crate::answer::Answer;
use crate::brep::face::Face;
use crate::certify::claim::{Claim, Demand, Evidence, Subject, What};
use crate::certify::flat::FlatCertificate;
use crate::certify::{SeamCertificate, SeamStatus};
use crate::io::{bend_table, bends, words};
use crate::patchwork::panel::Panel;
use crate::patchwork::pattern::Pattern;
use crate::tessellate::coverage;
use crate::torse::kind::EnvelopeShape;
use std::collections::{BTreeMap, HashMap};

impl Report {
    /// The record of an answer; `shown` knows its shapes and marks.
    pub fn of(answer: &Answer, shown: &Presentation) -> Self {
        let curves: Vec<String> = answer.guides.iter().map(|g| g.name.clone()).collect();
        let coverages = if answer.covers_faces() { coverage::faces(&answer.patchwork) } else { Vec::new() };
        let skipped = answer.skipped.iter().map(|s| SkippedRecord {
            entity: s.entity,
            reason: words::why(&s.reason),
            area_estimate: s.area_estimate.and_then(finite),
        });
        let along = answer.along.iter().map(|a| AlongRecord {
            panel: a.panel,
            curve: a.curve.clone(),
            step: a.step,
            paper_deviation_estimate: finite(a.paper_estimate),
        });
        let written = answer.written.iter();
        Self {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            job: answer.job.name().into(),
            status: words::status(answer.status()).into(),
            reason: words::reason(&answer.claims, &curves),
            objections: words::objections(&answer.claims, &curves),
            beside_panels: words::objections_beside_panels(&answer.claims, &curves),
            unit: "mm".into(),
            input: answer.input.clone(),
            tolerance: answer.tolerance,
            seconds: answer.seconds,
            figures: answer.claims_of(Subject::Whole).map(|c| FigureRecord::of(c, &curves)).collect(),
            coverage: answer.covers_faces().then(|| covered_share(answer, &coverages)),
            notes: words::notes(&answer.notes),
            skipped: skipped.collect(),
            faces: if answer.covers_faces() { face_records(answer, &coverages) } else { Vec::new() },
            panels: panel_records(answer, shown, &curves),
            parts: part_records(answer, shown),
            seams: seam_records(answer),
            joints: joint_records(answer),
            joins: join_records(answer),
            along: along.collect(),
            shapes: shown.shapes.iter().map(|s| shape_record(s, answer)).collect(),
            worst_point: worst_point(answer),
            written: written
                .map(|(file, w)| WrittenRecord { file: file.clone(), written_bound: finite(w.bound()) })
                .collect(),
        }
    }
}

/// The joints that marks on patterns tell of.
fn joint_records(answer: &Answer) -> Vec<JointRecord> {
    let name = |k: usize| answer.patterns.get(k).map_or_else(String::new, |p| p.name.clone());
    let lengths = |name: &str| {
        let of_parts = answer.joints.iter().find(|j| j.name == name)?.lengths;
        of_parts.iter().all(|l| l.is_finite()).then_some(of_parts)
    };
    let all = joints(&answer.patterns).into_iter();
    all.map(|j| JointRecord {
        lengths_estimate: lengths(&j.name),
        name: j.name,
        between: j.between.map(name),
        marks: j.marks,
        gap_estimate: finite(j.gap_estimate),
    })
    .collect()
}

/// The joins of a composite, those first that come nearest to what is asked of them.
fn join_records(answer: &Answer) -> Vec<JoinRecord> {
    let told = |n: &Note| match n {
        Note::Joint { index, between, smooth, .. } => Some((*index, between.clone(), *smooth)),
        _ => None,
    };
    let record = |(number, between, smooth): (usize, [String; 2], bool)| {
        let claim = |what: What| answer.claim(what);
        let [gap, angle, fold] = [What::JoinGap, What::JoinAngle, What::FoldGap].map(|what| claim(what(number)));
        let broken = |c: &Option<&Claim>| c.is_some_and(Claim::is_broken);
        JoinRecord {
            number,
            between,
            gap_bound: gap.and_then(|c| finite(c.value())),
            angle_bound_deg: angle.and_then(|c| finite(c.value())),
            fold_bound: fold.and_then(|c| finite(c.value())),
            smooth,
            certified: ![gap, angle, fold].iter().any(broken),
        }
    };
    let mut out: Vec<JoinRecord> = answer.notes.iter().filter_map(told).map(record).collect();
    let angle = |j: &JoinRecord| j.angle_bound_deg.unwrap_or(f64::INFINITY);
    out.sort_by(|a, b| a.certified.cmp(&b.certified).then(b.smooth.cmp(&a.smooth)).then(angle(b).total_cmp(&angle(a))));
    out
}

impl FigureRecord {
    /// A claim for the report. `null` stands for infinite and for unknown; the basis tells them apart.
    fn of(claim: &Claim, curves: &[String]) -> Self {
        Self {
            what: words::id(claim.what()).into(),
            name: words::name(claim, curves),
            value: finite(claim.value()).filter(|_| !claim.is_unknown()),
            unit: words::unit(claim.what()).into(),
            basis: if claim.is_unknown() { UNKNOWN } else { words::evidence(claim.evidence()) }.into(),
            bound: match claim.evidence() {
                Evidence::Proven if claim.is_lower_bound() => "lower".into(),
                Evidence::Proven => "upper".into(),
                Evidence::Measured | Evidence::Given => String::new(),
            },
            limit: match claim.demand() {
                Demand::AtMost(x) | Demand::AtLeast(x) => finite(x),
                Demand::None => None,
            },
            at: claim.witness().map(Into::into),
        }
    }
}

/// JSON has no infinity; `null` stands for it.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// 1 is kept for covers that the certificate confirms.
fn covered_share(answer: &Answer, coverages: &[coverage::Coverage]) -> f64 {
    if answer.skipped.is_empty() && answer.certificate.as_ref().is_some_and(|c| c.covered) {
        return 1.0;
    }
    let areas: Vec<Option<f64>> = answer.skipped.iter().map(|s| s.area_estimate).collect();
    coverage::total(coverages).beside(&areas).share().min(1.0 - f64::EPSILON)
}

fn seam_records(answer: &Answer) -> Vec<SeamRecord> {
    let numbers: BTreeMap<[usize; 2], Vec<u32>> =
        answer.patchwork.seams().iter().fold(BTreeMap::new(), |mut all, s| {
            all.entry([s.sides[0].panel, s.sides[1].panel]).or_default().push(s.seam);
            all
        });
    let mut used: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let certificates = answer.certificate.iter().flat_map(|c| &c.seams);
    certificates
        .map(|s| {
            // Seams between the same two panels come in the same order.
            let k = used.entry(s.panels).or_default();
            *k += 1;
            let number = numbers.get(&s.panels).and_then(|n| n.get(*k - 1)).copied();
            seam_record(s, number)
        })
        .collect()
}

fn seam_record(s: &SeamCertificate, number: Option<u32>) -> SeamRecord {
    let joint = match s.status {
        SeamStatus::Exact => "exact",
        SeamStatus::Tolerance => "tolerance",
        SeamStatus::Open => "open",
    };
    let (least, most) = s.kink_range_estimate;
    SeamRecord {
        number,
        between: s.panels,
        joint: joint.into(),
        gap_bound: finite(s.gap_bound),
        seam_length: finite(s.length_estimate),
        length_difference_bound: finite(s.length_difference_bound),
        kink_deg: [least.to_degrees(), most.to_degrees()],
    }
}

fn face_records(answer: &Answer, coverages: &[coverage::Coverage]) -> Vec<FaceRecord> {
    let patchwork = &answer.patchwork;
    let record = |(i, face): (usize, &Face)| FaceRecord {
        entity: face.entity,
        name: face.name.clone(),
        part: face.part.clone(),
        kind: face.kind.name().into(),
        radius: face.cylinder_radius(),
        panels: patchwork.panels.iter().filter(|p| p.face() == Some(i)).count(),
        coverage: coverages.get(i).map_or(0.0, coverage::Coverage::share),
        trim_deviation_estimate: finite(face.trim_deviation_estimate),
        surface_deviation_estimate: finite(face.surface_deviation_estimate()),
        surface_bound: finite(face.surface_bound()),
        joined: face.parts.iter().map(|p| JoinedRecord { entity: p.entity, name: p.name.clone() }).collect(),
        joint_bound: face.joint_bound(),
        trim_bound: finite(face.trim_bound()),
    };
    patchwork.faces.iter().enumerate().map(record).collect()
}

fn panel_records(answer: &Answer, shown: &Presentation, curves: &[String]) -> Vec<PanelRecord> {
    let mut figures: Vec<Vec<FigureRecord>> = vec![Vec::new(); answer.patchwork.panels.len()];
    for c in answer.claims.iter().filter(|c| !matches!(c.what(), What::Objection | What::InPart | What::LeftOut)) {
        if let Subject::Panel(k) = c.subject() {
            figures.get_mut(k).into_iter().for_each(|f| f.push(FigureRecord::of(c, curves)));
        }
    }
    let panels = answer.patchwork.panels.iter().enumerate().zip(figures);
    let record = |((k, panel), figures): ((usize, &Panel), _)| {
        let marked = shown.marks.panels.get(k).copied().unwrap_or(true);
        let proof = answer.certificate.as_ref().and_then(|c| c.panels.get(k));
        PanelRecord {
            name: panel.strip.name.clone(),
            face: panel.face(),
            kind: panel.strip.kind.name().into(),
            certified: !marked,
            reason: if marked { reason(answer, k, curves) } else { String::new() },
            witness: proof
                .and_then(|p| p.witness)
                .map(|(uv, distance)| WitnessRecord { uv, distance: finite(distance) }),
            figures,
        }
    };
    panels.map(record).collect()
}

/// Why a panel is not certified: its own proof, else what the whole asks of it.
fn reason(answer: &Answer, panel: usize, curves: &[String]) -> String {
    let whole = || format!("the whole is not certified: {}", words::reason(&answer.claims, curves));
    let Some(certificate) = &answer.certificate else {
        let part = answer.part_of(panel).map(Subject::Part);
        let own = |c: &&Claim| c.subject() == Subject::Panel(panel) || Some(c.subject()) == part;
        let own: Vec<Claim> = answer.claims.iter().filter(own).cloned().collect();
        return Some(words::reason(&own, curves)).filter(|r| !r.is_empty()).unwrap_or_else(whole);
    };
    match certificate.panels.get(panel) {
        None => "not examined".into(),
        Some(p) if !p.certified => p.reason.as_ref().map_or_else(String::new, words::why),
        Some(p) if p.deviation_bound > answer.tolerance => {
            format!("proven for {} only, which exceeds the tolerance", words::numbers::length_bound(p.deviation_bound))
        }
        Some(_) if answer.beyond_limits.contains(&panel) => "it does not keep the limits of sheet and material".into(),
        Some(_) if answer.part_of(panel).is_none_or(|part| answer.pattern_of(part).is_none()) => {
            "it has no flat pattern".into()
        }
        Some(_) => whole(),
    }
}

fn part_records(answer: &Answer, shown: &Presentation) -> Vec<PartRecord> {
    let parts = answer.parts.iter().enumerate();
    let drawn_at: HashMap<usize, usize> = answer.patterns.iter().enumerate().map(|(k, p)| (p.panel, k)).collect();
    let sheet = |part: usize| answer.sheets.get(*drawn_at.get(&part)?);
    let name = |pattern: Option<usize>| pattern.map_or_else(String::new, |k| answer.patterns[k].name.clone());
    let shop = &answer.shop;
    let work = |part: usize| shop.work.get(*drawn_at.get(&part)?);
    parts
        .map(|(k, part)| {
            let (pattern, flat) = (answer.pattern_of(k), answer.flat_of(k));
            let drawn = |value: fn(&Pattern) -> f64| pattern.map(value).and_then(finite);
            let proven = |value: fn(&FlatCertificate) -> f64| flat.map(value).and_then(finite);
            let panels = answer.patchwork.panels.iter().skip(part.first).take(part.count);
            let order = drawn_at.get(&k).and_then(|k| shown.orders.get(*k)).cloned().unwrap_or_default();
            let thickness = order.thickness.or(shop.thickness);
            PartRecord {
                name: part.name.clone(),
                panels: panels.map(|p| p.strip.name.clone()).collect(),
                source: answer.sources_of(k).join(" + "),
                certified: !shown.marks.parts.get(k).copied().unwrap_or(true),
                missing: part.missing.clone().map_or_else(String::new, |m| words::why(&m.into())),
                area: drawn(|p| p.area_in_space),
                flat_area: drawn(|p| p.area),
                isometry_error: drawn(|p| p.isometry_error),
                contour_error: drawn(|p| p.contour_error),
                strain_bound: proven(FlatCertificate::strain_bound),
                drawing_bound: proven(FlatCertificate::drawing_bound),
                length: drawn(|p| p.length),
                width: drawn(|p| p.width),
                view: pattern.map_or_else(String::new, |p| p.view.name().into()),
                bends: pattern.map_or_else(Vec::new, bends::records),
                thickness,
                same_as: name(order.same.map(|s| s.pattern)),
                mirrored: order.same.is_some_and(|s| s.mirrored),
                opposite_hand_of: name(order.opposite),
                sheet_bends: sheet(k).map_or_else(Vec::new, |s| bend_table::records(&s.bends)),
                neutral: sheet(k).and_then(NeutralRecord::of),
                quantity: order.quantity.as_drawn,
                curves: pattern.map_or(0, |p| p.curves.len()),
                quantity_turned_over: order.quantity.turned_over,
                cut_length: pattern.and_then(|_| finite(order.cut_length)),
                pierces: order.pierces,
                material: shop.material.as_ref().map_or_else(String::new, |m| m.name.clone()),
                material_source: shop.material.as_ref().map_or_else(String::new, |m| m.source.clone()),
                weight_kg: order.weight_kg,
                inside_radius: work(k).and_then(|w| w.sheet).and_then(|s| finite(s.inside_radius)),
                neutral_offset: work(k).and_then(|w| w.sheet).and_then(|s| finite(s.neutral)),
                facets: work(k).and_then(|w| w.faceted.as_ref()).map(|f| FacetsRecord {
                    kinks: f.kinks.len(),
                    displacement_estimate: finite(f.displacement_estimate),
                    sagitta_estimate: finite(f.sagitta_estimate),
                }),
            }
        })
        .collect()
}

fn worst_point(answer: &Answer) -> Option<PointRecord> {
    let index = answer.points.worst?;
    let deviation = answer.points.values.get(index).copied().and_then(finite);
    Some(PointRecord { index, place: (*answer.points.places.get(index)?).into(), deviation })
}

fn shape_record(shape: &Shape, answer: &Answer) -> ShapeRecord {
    let name = |k: Option<&(usize, f64, f64)>| {
        k.and_then(|k| answer.patchwork.panels.get(k.0)).map_or_else(String::new, |p| p.strip.name.clone())
    };
    let vector = match shape.shape {
        EnvelopeShape::Plane { plane } => Some(plane.normal),
        EnvelopeShape::Cylinder { direction } => Some(direction),
        EnvelopeShape::Cone { apex } => Some(apex),
        EnvelopeShape::Tangent => None,
    };
    ShapeRecord {
        part: shape.part.clone(),
        shape: shape.shape.name().into(),
        first: name(shape.pieces.first()),
        last: name(shape.pieces.last()),
        turn: shape.turn.to_degrees(),
        vector: vector.map(Into::into),
        residual: shape.residual,
        ambiguous: shape.ambiguous,
    }
}
