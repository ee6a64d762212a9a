//! Assemblies of the STEP reader: where occurrences and copies of a part lie, however they are written.

use super::text::{Step, Unit};
use torse::geom::Vec3;
use torse::io::model::Model;
use torse::io::step::read::read;
use torse::io::words::why;

fn model(s: &Step) -> Model {
    read(s.text().as_bytes()).expect("a model")
}

#[test]
fn assemblies_place_every_occurrence() {
    for reversed in [false, true] {
        let mut s = Step::new(Unit::Millimetre);
        let l = s.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
        let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
        s.face("", plane, &[(l, true)], true);
        // One turned by 90° about z and moved by (10, 0, 0), one moved by (0, 0, 5) mm.
        s.occurrence([10., 0., 0.], [0., 0., 1.], [0., 1., 0.], reversed);
        s.occurrence([0., 0., 5.], [0., 0., 1.], [1., 0., 0.], reversed);
        let m = model(&s);
        assert!(m.skipped.is_empty(), "{:?}", m.skipped);
        let mut centers: Vec<Vec3> = m.faces.iter().map(|f| f.surface.bbox().center()).collect();
        centers.sort_by(|p, q| p.x.total_cmp(&q.x));
        assert_eq!(centers.len(), 2);
        assert!((centers[0] - Vec3::new(0.5, 0.5, 5.0)).norm() < 1e-12, "{centers:?}");
        assert!((centers[1] - Vec3::new(9.5, 0.5, 0.0)).norm() < 1e-12, "{centers:?}");
        assert!(m.faces.iter().all(|f| f.part == "part"));
        assert!(m.products.contains(&"assembly".to_string()));
    }
}

/// A part that is a unit square with its centre at (½, ½, 0).
fn square(unit: Unit) -> Step {
    let mut s = Step::new(unit);
    let l = s.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    s
}

/// The text with every record changed, and more of them.
fn changed(text: &str, change: impl Fn(&str) -> String, more: &str) -> String {
    let lines: Vec<String> = text.lines().map(change).collect();
    let (head, tail) =
        lines.join("\n").rsplit_once("ENDSEC;").map(|(h, t)| (h.to_string(), t.to_string())).expect("a file");
    format!("{head}{more}\nENDSEC;{tail}")
}

fn is_centred(text: &str, place: [f64; 3]) {
    let m = read(text.as_bytes()).expect("a model");
    let centre = m.faces[0].surface.bbox().center();
    assert!(m.faces.len() == 1 && (centre - Vec3::from(place)).norm() < 1e-9, "{centre:?} {}", m.faces.len());
}

#[test]
fn exchanged_items_of_a_transformation_are_told_by_who_lists_them() {
    for reversed in [false, true] {
        let mut s = square(Unit::Millimetre);
        s.occurrence([10., 0., 0.], [0., 0., 1.], [0., 1., 0.], reversed);
        let exchange = |line: &str| match line.split_once("=ITEM_DEFINED_TRANSFORMATION('','',") {
            Some((id, items)) => {
                let (one, two) = items.trim_end_matches(");").split_once(',').expect("two items");
                format!("{id}=ITEM_DEFINED_TRANSFORMATION('','',{two},{one});")
            }
            None => line.to_string(),
        };
        is_centred(&s.text(), [9.5, 0.5, 0.0]);
        is_centred(&changed(&s.text(), exchange, ""), [9.5, 0.5, 0.0]);
    }
}

#[test]
fn copies_lie_where_the_units_of_their_holder_say() {
    let mut s = square(Unit::Metre);
    s.mapped([3., 0., 5.]);
    let millimetres = "#9001=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
        #9002=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#9001))REPRESENTATION_CONTEXT('',''));";
    let held = |line: &str| match line.rsplit_once(",#").filter(|_| line.contains("=SHAPE_REPRESENTATION(")) {
        Some((items, _)) => format!("{items},#9002);"),
        None => line.to_string(),
    };
    is_centred(&s.text(), [3500.0, 500.0, 5000.0]);
    is_centred(&changed(&s.text(), held, millimetres), [503.0, 500.0, 5.0]);
}

#[test]
fn transformation_operators_turn_and_scale_however_they_are_written() {
    let mut s = square(Unit::Millimetre);
    s.mapped([3., 0., 5.]);
    let axes =
        "#9002=DIRECTION('',(0.,1.,0.));\n#9003=DIRECTION('',(0.,0.,1.));\n#9004=CARTESIAN_POINT('',(10.,0.,0.));\n\
        #9005=DIRECTION('',(1.,0.,0.));\n#9001=";
    let target = |line: &str| match line.split_once("=MAPPED_ITEM(") {
        Some((id, rest)) => format!("{id}=MAPPED_ITEM({},#9001);", rest.rsplit_once(',').expect("a target").0),
        None => line.to_string(),
    };
    for operator in [
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#9002,#9003,#9004,2.,#9005);",
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',#9002,#9003,#9004,2.,#9005);",
        "CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#9002,#9003,#9004,2.,#9005);",
        "(CARTESIAN_TRANSFORMATION_OPERATOR(#9002,#9003,#9004,2.)CARTESIAN_TRANSFORMATION_OPERATOR_3D(#9005)\
         FUNCTIONALLY_DEFINED_TRANSFORMATION('','')GEOMETRIC_REPRESENTATION_ITEM()REPRESENTATION_ITEM(''));",
    ] {
        is_centred(&changed(&s.text(), target, &format!("{axes}{operator}")), [10.0, 1.0, 1.0]);
    }
}

#[test]
fn edges_lie_where_assemblies_put_them() {
    let mut s = Step::new(Unit::Millimetre);
    let l = s.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    s.occurrence([10., 0., 0.], [0., 0., 1.], [0., 1., 0.], false);
    s.occurrence([0., 0., 5.], [0., 0., 1.], [1., 0., 0.], false);
    let edges = torse::io::step::read::edges::curves(s.text().as_bytes()).expect("edges");
    assert_eq!(edges.len(), 8);
    let place = |h: &[f64; 4]| Vec3::new(h[0], h[1], h[2]) / h[3];
    let ends = |copy: usize| -> Vec<Vec3> {
        edges.iter().filter(|e| e.copy == copy).map(|e| place(&e.curves[0].control[0])).collect()
    };
    // The first place is turned by 90° about z and moved along x, the second one moved along z.
    assert!(ends(1).iter().all(|p| p.z == 0.0 && p.x > 8.9) && ends(2).iter().all(|p| p.z == 5.0 && p.x < 1.1));
}

#[test]
fn mapped_items_are_copies() {
    let mut s = Step::new(Unit::Millimetre);
    let l = s.polygon(&[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let plane = s.plane([0., 0., 0.], [0., 0., 1.]);
    s.face("", plane, &[(l, true)], true);
    s.mapped([3., 0., 0.]);
    s.mapped([6., 0., 0.]);
    let m = model(&s);
    let mut x: Vec<f64> = m.faces.iter().map(|f| f.surface.bbox().center().x).collect();
    x.sort_by(f64::total_cmp);
    assert_eq!(x.len(), 2);
    assert!((x[0] - 3.5).abs() < 1e-12 && (x[1] - 6.5).abs() < 1e-12);
}

/// Numbers of records of a kind, in order.
fn numbers(text: &str, kind: &str) -> Vec<String> {
    let start = format!("={kind}(");
    text.lines().filter(|l| l.contains(&start)).filter_map(|l| Some(l.split_once('=')?.0.to_string())).collect()
}

/// Centres of all faces, by x.
fn centres(m: &Model) -> Vec<Vec3> {
    let mut out: Vec<Vec3> = m.faces.iter().map(|f| f.surface.bbox().center()).collect();
    out.sort_by(|p, q| p.x.total_cmp(&q.x));
    out
}

fn lie(text: &str, places: &[[f64; 3]]) {
    let m = read(text.as_bytes()).expect("a model");
    assert!(m.skipped.is_empty(), "{:?}", m.skipped);
    let found = centres(&m);
    let near = found.iter().zip(places).all(|(p, q)| (p - Vec3::from(*q)).norm() < 1e-9);
    assert!(found.len() == places.len() && near, "{found:?}");
}

#[test]
fn copies_in_a_representation_without_a_product_lie_each_at_its_place() {
    let mut s = square(Unit::Millimetre);
    s.mapped([3., 0., 0.]);
    s.mapped([6., 0., 0.]);
    let text = s.text();
    let last = numbers(&text, "SHAPE_DEFINITION_REPRESENTATION").pop().expect("a representation");
    let gone = |line: &str| if line.starts_with(&format!("{last}=")) { String::new() } else { line.to_string() };
    lie(&changed(&text, gone, ""), &[[3.5, 0.5, 0.0], [6.5, 0.5, 0.0]]);
    // What shows the same solid without a copy of it, for its material say, adds nothing.
    let item = numbers(&text, "SHELL_BASED_SURFACE_MODEL").remove(0);
    let context = text.lines().find(|l| l.contains("=SHAPE_REPRESENTATION(")).and_then(|l| l.rsplit_once(",#"));
    let context = context.map(|c| c.1.to_string()).expect("a context");
    let shown = format!("#9001=SHAPE_REPRESENTATION('material',({item}),#{context}");
    lie(&changed(&text, str::to_string, &shown), &[[3.5, 0.5, 0.0], [6.5, 0.5, 0.0]]);
}

#[test]
fn all_representations_of_a_part_go_where_it_is_placed() {
    let mut s = square(Unit::Millimetre);
    s.occurrence([10., 0., 0.], [0., 0., 1.], [1., 0., 0.], false);
    let text = s.text();
    let shape = numbers(&text, "PRODUCT_DEFINITION_SHAPE").remove(0);
    let line = text.lines().find(|l| l.contains("=MANIFOLD_SURFACE_SHAPE_REPRESENTATION(")).expect("a representation");
    let context = line.rsplit_once(',').expect("a context").1;
    // A second one lists the same surface, and one at z = 2.
    let item = numbers(&text, "SHELL_BASED_SURFACE_MODEL").remove(0);
    let more = format!(
        "#9001=CARTESIAN_POINT('',(20.,0.,2.));\n#9002=CARTESIAN_POINT('',(21.,0.,2.));\n\
         #9003=CARTESIAN_POINT('',(21.,1.,2.));\n#9004=CARTESIAN_POINT('',(20.,1.,2.));\n\
         #9005=POLY_LOOP('',(#9001,#9002,#9003,#9004));\n#9006=FACE_OUTER_BOUND('',#9005,.T.);\n\
         #9007=AXIS2_PLACEMENT_3D('',#9001,$,$);\n#9008=PLANE('',#9007);\n\
         #9009=ADVANCED_FACE('',(#9006),#9008,.T.);\n#9010=OPEN_SHELL('',(#9009));\n\
         #9011=SHELL_BASED_SURFACE_MODEL('',(#9010));\n\
         #9012=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',({item},#9011),{context}\n\
         #9013=SHAPE_DEFINITION_REPRESENTATION({shape},#9012);"
    );
    lie(&changed(&text, str::to_string, &more), &[[10.5, 0.5, 0.0], [30.5, 0.5, 2.0]]);
}

#[test]
fn a_placement_written_as_one_record_counts() {
    for reversed in [false, true] {
        let mut s = square(Unit::Millimetre);
        s.occurrence([10., 0., 0.], [0., 0., 1.], [0., 1., 0.], reversed);
        let simple = |line: &str| {
            let Some((id, rest)) = line.split_once("=(REPRESENTATION_RELATIONSHIP(") else { return line.to_string() };
            let (ends, rest) = rest.split_once(')').expect("ends");
            let transformation = rest.split('(').nth(1).and_then(|t| t.split(')').next()).expect("a transformation");
            format!("{id}=REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({ends},{transformation});")
        };
        lie(&changed(&s.text(), simple, ""), &[[9.5, 0.5, 0.0]]);
    }
}

#[test]
fn assemblies_that_share_a_part_where_it_was_drawn_stay_two() {
    // The part is used in two assemblies without being moved; the second one is placed in a third.
    let mut s = square(Unit::Millimetre);
    s.occurrence([0., 0., 0.], [0., 0., 1.], [1., 0., 0.], false);
    let text = s.text();
    let plain = |line: &str| match line.split_once("=(REPRESENTATION_RELATIONSHIP(") {
        Some((id, rest)) => {
            format!("{id}=SHAPE_REPRESENTATION_RELATIONSHIP({});", rest.split_once(')').expect("ends").0)
        }
        None => line.to_string(),
    };
    lie(&changed(&text, plain, ""), &[[0.5, 0.5, 0.0]]);
    let part = numbers(&text, "PRODUCT_DEFINITION").remove(0);
    let line = text.lines().find(|l| l.contains("=MANIFOLD_SURFACE_SHAPE_REPRESENTATION(")).expect("a representation");
    let (rep, context) = (line.split_once('=').expect("a number").0, line.rsplit_once(',').expect("a context").1);
    let origin = line.split("(#").nth(1).and_then(|l| l.split(',').next()).expect("an origin");
    let product = |k: u32, name: &str| {
        format!(
            "#{k}0=PRODUCT('{name}','{name}','',());\n#{k}1=PRODUCT_DEFINITION_FORMATION('','',#{k}0);\n\
             #{k}2=PRODUCT_DEFINITION('','',#{k}1,$);\n#{k}3=PRODUCT_DEFINITION_SHAPE('','',#{k}2);\n\
             #{k}5=SHAPE_REPRESENTATION('',(#{origin}),{context}\n#{k}6=SHAPE_DEFINITION_REPRESENTATION(#{k}3,#{k}5);\n"
        )
    };
    let used = format!(
        "#9300=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#9102,{part},$);\n#9301=PRODUCT_DEFINITION_SHAPE('','',#9300);\n\
         #9302=SHAPE_REPRESENTATION_RELATIONSHIP('','',{rep},#9105);\n\
         #9303=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#9302,#9301);\n\
         #9304=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#9202,#9102,$);\n#9305=PRODUCT_DEFINITION_SHAPE('','',#9304);\n\
         #9306=CARTESIAN_POINT('',(40.,0.,0.));\n#9307=AXIS2_PLACEMENT_3D('',#9306,$,$);\n\
         #9308=ITEM_DEFINED_TRANSFORMATION('','',#{origin},#9307);\n\
         #9309=(REPRESENTATION_RELATIONSHIP('','',#9105,#9205)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#9308)\
         SHAPE_REPRESENTATION_RELATIONSHIP());\n#9310=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#9309,#9305);"
    );
    let more = format!("{}{}{used}", product(910, "second"), product(920, "third"));
    lie(&changed(&text, plain, &more), &[[0.5, 0.5, 0.0], [40.5, 0.5, 0.0]]);
}

#[test]
fn uses_that_nothing_places_are_named() {
    let mut s = square(Unit::Millimetre);
    s.occurrence([10., 0., 0.], [0., 0., 1.], [1., 0., 0.], false);
    s.occurrence([20., 0., 0.], [0., 0., 1.], [1., 0., 0.], false);
    let without = |text: &str, count: usize| {
        let links = numbers(text, "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION");
        let relations: Vec<String> = text
            .lines()
            .filter(|l| l.contains("=(REPRESENTATION_RELATIONSHIP("))
            .filter_map(|l| Some(l.split_once('=')?.0.to_string()))
            .collect();
        let gone: Vec<&String> = links.iter().take(count).chain(relations.iter().take(count)).collect();
        let keep = |line: &str| match gone.iter().any(|id| line.starts_with(&format!("{id}="))) {
            true => String::new(),
            false => line.to_string(),
        };
        read(changed(text, keep, "").as_bytes()).expect("a model")
    };
    let text = s.text();
    // One of two is placed: the other one is missed.
    let m = without(&text, 1);
    let told: Vec<String> = m.skipped.iter().map(|k| why(&k.reason)).collect();
    assert!(m.faces.len() == 1 && told.len() == 1 && told[0].contains("this use of part"), "{told:?}");
    let m = without(&text, 2);
    assert_eq!((m.faces.len(), m.skipped.len()), (1, 2));
    // A single use can be where the part was drawn.
    let mut s = square(Unit::Millimetre);
    s.occurrence([10., 0., 0.], [0., 0., 1.], [1., 0., 0.], false);
    let m = without(&s.text(), 1);
    assert_eq!((m.faces.len(), m.skipped.len()), (1, 0));
    assert!(torse::io::words::notes(&m.notes).iter().any(|n| n.contains("nothing says where part goes")));
}
