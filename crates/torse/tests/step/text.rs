//! A small writer of STEP text for tests: enough records to say one part, its faces and where they go.

/// Unit of length (and angle, where it is not the radian).
#[derive(Clone, Copy, PartialEq)]
pub enum Unit {
    Millimetre,
    MillimetreDegree,
    Metre,
    Inch,
    Foot,
}

pub type P = [f64; 3];
/// Origin, z, x, and whether the relationship is written the other way round.
type Use = (P, P, P, bool);

struct FaceText {
    id: u64,
    name: String,
    surface: u64,
    bounds: Vec<(u64, bool)>,
    sense: bool,
}

/// A file in the making.
pub struct Step {
    unit: Unit,
    next: u64,
    records: Vec<String>,
    faces: Vec<FaceText>,
    sets: Vec<Vec<u64>>,
    occurrences: Vec<Use>,
    mapped: Vec<P>,
}

impl Step {
    pub fn new(unit: Unit) -> Self {
        let mut s = Self {
            unit,
            next: 1,
            records: Vec::new(),
            faces: Vec::new(),
            sets: Vec::new(),
            occurrences: Vec::new(),
            mapped: Vec::new(),
        };
        s.add("APPLICATION_CONTEXT('test')");
        s
    }

    pub fn add(&mut self, body: &str) -> u64 {
        let id = self.next;
        self.next += 1;
        self.records.push(format!("#{id}={body};"));
        id
    }

    pub fn point(&mut self, p: P) -> u64 {
        self.add(&format!("CARTESIAN_POINT('',({:?},{:?},{:?}))", p[0], p[1], p[2]))
    }

    fn direction(&mut self, d: P) -> u64 {
        self.add(&format!("DIRECTION('',({:?},{:?},{:?}))", d[0], d[1], d[2]))
    }

    pub fn vector(&mut self, d: P, length: f64) -> u64 {
        let d = self.direction(d);
        self.add(&format!("VECTOR('',#{d},{length:?})"))
    }

    pub fn axis(&mut self, origin: P, z: P, x: P) -> u64 {
        let (o, z, x) = (self.point(origin), self.direction(z), self.direction(x));
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{o},#{z},#{x})"))
    }

    pub fn axis1(&mut self, origin: P, z: P) -> u64 {
        let (o, z) = (self.point(origin), self.direction(z));
        self.add(&format!("AXIS1_PLACEMENT('',#{o},#{z})"))
    }

    fn axis_about(&mut self, origin: P, z: P) -> u64 {
        let x = square_to(z);
        self.axis(origin, z, x)
    }

    pub fn plane(&mut self, origin: P, z: P) -> u64 {
        self.surface("PLANE", origin, z, &[])
    }

    pub fn surface(&mut self, keyword: &str, origin: P, z: P, sizes: &[f64]) -> u64 {
        let a = self.axis_about(origin, z);
        let sizes: String = sizes.iter().map(|x| format!(",{x:?}")).collect();
        self.add(&format!("{keyword}('',#{a}{sizes})"))
    }

    pub fn circle(&mut self, center: P, z: P, r: f64) -> u64 {
        let a = self.axis_about(center, z);
        self.add(&format!("CIRCLE('',#{a},{r:?})"))
    }

    pub fn line(&mut self, p: P, q: P) -> u64 {
        let d = [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
        let (p, v) = (self.point(p), self.vector(d, 1.0));
        self.add(&format!("LINE('',#{p},#{v})"))
    }

    fn vertex(&mut self, p: P) -> u64 {
        let p = self.point(p);
        self.add(&format!("VERTEX_POINT('',#{p})"))
    }

    fn edge(&mut self, a: u64, b: u64, curve: u64, sense: bool) -> u64 {
        self.add(&format!("EDGE_CURVE('',#{a},#{b},#{curve},{})", flag(sense)))
    }

    fn edge_loop(&mut self, edges: &[(u64, bool)]) -> u64 {
        let ids: Vec<String> = edges
            .iter()
            .map(|(e, forward)| format!("#{}", self.add(&format!("ORIENTED_EDGE('',*,*,#{e},{})", flag(*forward)))))
            .collect();
        self.add(&format!("EDGE_LOOP('',({}))", ids.join(",")))
    }

    /// A loop of straight edges.
    pub fn polygon(&mut self, corners: &[P]) -> u64 {
        let vertices: Vec<u64> = corners.iter().map(|p| self.vertex(*p)).collect();
        let n = corners.len();
        let edges: Vec<(u64, bool)> = (0..n)
            .map(|i| {
                let line = self.line(corners[i], corners[(i + 1) % n]);
                (self.edge(vertices[i], vertices[(i + 1) % n], line, true), true)
            })
            .collect();
        self.edge_loop(&edges)
    }

    /// A polygon whose first side follows a curve.
    pub fn curve_and_polygon(&mut self, curve: u64, corners: &[P]) -> u64 {
        let vertices: Vec<u64> = corners.iter().map(|p| self.vertex(*p)).collect();
        let n = corners.len();
        let edges: Vec<(u64, bool)> = (0..n)
            .map(|i| {
                let c = if i == 0 { curve } else { self.line(corners[i], corners[(i + 1) % n]) };
                (self.edge(vertices[i], vertices[(i + 1) % n], c, true), true)
            })
            .collect();
        self.edge_loop(&edges)
    }

    /// A full circle, counter-clockwise about `z` or not.
    pub fn circle_loop(&mut self, center: P, z: P, r: f64, ccw: bool) -> u64 {
        let circle = self.circle(center, z, r);
        let x = square_to(z);
        let start = [center[0] + r * x[0], center[1] + r * x[1], center[2] + r * x[2]];
        self.closed_curve_loop(circle, start, ccw)
    }

    /// A closed curve as one edge.
    pub fn closed_curve_loop(&mut self, curve: u64, start: P, forward: bool) -> u64 {
        let v = self.vertex(start);
        let e = self.edge(v, v, curve, true);
        self.edge_loop(&[(e, forward)])
    }

    pub fn vertex_loop(&mut self, p: P) -> u64 {
        let v = self.vertex(p);
        self.add(&format!("VERTEX_LOOP('',#{v})"))
    }

    /// A curve from `a` to `b` and the straight way back.
    pub fn curve_and_chord(&mut self, curve: u64, a: P, b: P, sense: bool) -> u64 {
        let (va, vb) = (self.vertex(a), self.vertex(b));
        let e = self.edge(va, vb, curve, sense);
        let line = self.line(b, a);
        let f = self.edge(vb, va, line, true);
        self.edge_loop(&[(e, true), (f, true)])
    }

    /// The whole of a cylinder about z from 0 to `h`, in one loop along a seam.
    pub fn seamed_tube(&mut self, r: f64, h: f64) -> u64 {
        let (low, high) = (self.vertex([r, 0., 0.]), self.vertex([r, 0., h]));
        let (c, d) = (self.circle([0., 0., 0.], [0., 0., 1.], r), self.circle([0., 0., h], [0., 0., 1.], r));
        let (below, above) = (self.edge(low, low, c, true), self.edge(high, high, d, true));
        let line = self.line([r, 0., 0.], [r, 0., h]);
        let seam = self.edge(low, high, line, true);
        self.edge_loop(&[(below, true), (seam, true), (above, false), (seam, false)])
    }

    /// The octant of a sphere with a corner at the pole.
    pub fn octant(&mut self, c: P, r: f64) -> u64 {
        let at = |x: f64, y: f64, z: f64| [c[0] + r * x, c[1] + r * y, c[2] + r * z];
        let corners = [at(1., 0., 0.), at(0., 1., 0.), at(0., 0., 1.)];
        let v: Vec<u64> = corners.iter().map(|p| self.vertex(*p)).collect();
        let axes = [([0., 0., 1.], 0, 1), ([1., 0., 0.], 1, 2), ([0., 1., 0.], 2, 0)];
        let edges: Vec<(u64, bool)> = axes
            .iter()
            .map(|&(z, a, b)| {
                let circle = self.circle(c, z, r);
                (self.edge(v[a], v[b], circle, true), true)
            })
            .collect();
        self.edge_loop(&edges)
    }

    /// A window in a cylinder about z, `half` to each side of `angle`; clockwise seen from outside.
    pub fn cylinder_window(&mut self, r: f64, angle: f64, half: f64, z0: f64, z1: f64) -> u64 {
        let at = |a: f64, z: f64| [r * a.cos(), r * a.sin(), z];
        let (a, b) = (angle - half, angle + half);
        let corners = [at(a, z0), at(a, z1), at(b, z1), at(b, z0)];
        let v: Vec<u64> = corners.iter().map(|p| self.vertex(*p)).collect();
        let (c0, c1) = (self.circle([0., 0., z0], [0., 0., 1.], r), self.circle([0., 0., z1], [0., 0., 1.], r));
        let (l0, l1) = (self.line(corners[0], corners[1]), self.line(corners[2], corners[3]));
        let edges = [
            (self.edge(v[0], v[1], l0, true), true),
            (self.edge(v[1], v[2], c1, true), true),
            (self.edge(v[2], v[3], l1, true), true),
            (self.edge(v[0], v[3], c0, true), false),
        ];
        self.edge_loop(&edges)
    }

    /// A face; answers the number it will have.
    pub fn face(&mut self, name: &str, surface: u64, bounds: &[(u64, bool)], sense: bool) -> u64 {
        let id = self.next;
        self.next += 1;
        self.faces.push(FaceText { id, name: name.into(), surface, bounds: bounds.to_vec(), sense });
        id
    }

    pub fn add_bound(&mut self, l: u64) {
        self.faces.last_mut().expect("a face").bounds.push((l, true));
    }

    pub fn clear_faces(&mut self) {
        self.faces.clear();
    }

    /// A plane face one of whose corners is the given record.
    pub fn raw_face_with(&mut self, point: &str) -> u64 {
        let p = self.add(point);
        let (q, r) = (self.point([1., 0., 0.]), self.point([0., 1., 0.]));
        let l = self.add(&format!("POLY_LOOP('',(#{p},#{q},#{r}))"));
        let plane = self.plane([0., 0., 0.], [0., 0., 1.]);
        self.face("raw", plane, &[(l, true)], true)
    }

    pub fn geometric_set(&mut self, items: &[u64]) {
        self.sets.push(items.to_vec());
    }

    /// Uses the part in an assembly; `reversed` writes the relationship from the assembly to the part.
    pub fn occurrence(&mut self, origin: P, z: P, x: P, reversed: bool) {
        self.occurrences.push((origin, z, x, reversed));
    }

    /// Shows the part, moved, by a mapped item in a second product.
    pub fn mapped(&mut self, shift: P) {
        self.mapped.push(shift);
    }

    fn product(&mut self, name: &str) -> (u64, u64) {
        let p = self.add(&format!("PRODUCT('{name}','{name}','',())"));
        let f = self.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{p})"));
        let d = self.add(&format!("PRODUCT_DEFINITION('','',#{f},$)"));
        let s = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{d})"));
        (d, s)
    }

    fn context(&mut self) -> u64 {
        let si = |p: &str| format!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({p},.METRE.))");
        let length = match self.unit {
            Unit::Millimetre | Unit::MillimetreDegree => self.add(&si(".MILLI.")),
            Unit::Metre => self.add(&si("$")),
            Unit::Inch | Unit::Foot => {
                let (name, mm) = if self.unit == Unit::Inch { ("INCH", 25.4) } else { ("FOOT", 304.8) };
                let base = self.add(&si(".MILLI."));
                let m = self.add(&format!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({mm}),#{base})"));
                self.add(&format!("(CONVERSION_BASED_UNIT('{name}',#{m})LENGTH_UNIT()NAMED_UNIT(*))"))
            }
        };
        let mut angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        if self.unit == Unit::MillimetreDegree {
            let m =
                self.add(&format!("PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.017453292519943295),#{angle})"));
            angle = self.add(&format!("(CONVERSION_BASED_UNIT('DEGREE',#{m})NAMED_UNIT(*)PLANE_ANGLE_UNIT())"));
        }
        self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle}))REPRESENTATION_CONTEXT('',''))"
        ))
    }

    /// The whole file. May be asked for again after more has been added.
    pub fn text(&self) -> String {
        let mut s = Self {
            unit: self.unit,
            next: self.next,
            records: self.records.clone(),
            faces: Vec::new(),
            sets: Vec::new(),
            occurrences: Vec::new(),
            mapped: Vec::new(),
        };
        let context = s.context();
        let mut items = Vec::new();
        let mut members = Vec::new();
        for f in &self.faces {
            let bounds: Vec<String> = f
                .bounds
                .iter()
                .map(|(l, o)| format!("#{}", s.add(&format!("FACE_BOUND('',#{l},{})", flag(*o)))))
                .collect();
            s.records.push(format!(
                "#{}=ADVANCED_FACE('{}',({}),#{},{});",
                f.id,
                f.name,
                bounds.join(","),
                f.surface,
                flag(f.sense)
            ));
            members.push(format!("#{}", f.id));
        }
        if !members.is_empty() {
            let shell = s.add(&format!("OPEN_SHELL('',({}))", members.join(",")));
            items.push(s.add(&format!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))")));
        }
        for set in &self.sets {
            let ids: Vec<String> = set.iter().map(|i| format!("#{i}")).collect();
            items.push(s.add(&format!("GEOMETRIC_SET('',({}))", ids.join(","))));
        }
        let origin = s.axis([0., 0., 0.], [0., 0., 1.], [1., 0., 0.]);
        let list: String = items.iter().map(|i| format!(",#{i}")).collect();
        let rep = s.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{origin}{list}),#{context})"));
        let (part, shape) = s.product("part");
        s.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{rep})"));
        s.assembly(part, rep, origin, context, &self.occurrences);
        if !self.mapped.is_empty() {
            let map = s.add(&format!("REPRESENTATION_MAP(#{origin},#{rep})"));
            let targets: Vec<String> = self
                .mapped
                .iter()
                .map(|p| {
                    let a = s.axis(*p, [0., 0., 1.], [1., 0., 0.]);
                    format!("#{}", s.add(&format!("MAPPED_ITEM('',#{map},#{a})")))
                })
                .collect();
            let top = s.add(&format!("SHAPE_REPRESENTATION('',({}),#{context})", targets.join(",")));
            let (_, shape) = s.product("copies");
            s.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{top})"));
        }
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{}\nENDSEC;\nEND-ISO-10303-21;\n",
            s.records.join("\n")
        )
    }

    fn assembly(&mut self, part: u64, rep: u64, origin: u64, context: u64, uses: &[Use]) {
        if uses.is_empty() {
            return;
        }
        let (whole, shape) = self.product("assembly");
        let places: Vec<u64> = uses.iter().map(|u| self.axis(u.0, u.1, u.2)).collect();
        let list: String = places.iter().map(|p| format!(",#{p}")).collect();
        let top = self.add(&format!("SHAPE_REPRESENTATION('',(#{origin}{list}),#{context})"));
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{top})"));
        for (u, place) in uses.iter().zip(places) {
            let (reps, items) = if u.3 { ((top, rep), (place, origin)) } else { ((rep, top), (origin, place)) };
            let t = self.add(&format!("ITEM_DEFINED_TRANSFORMATION('','',#{},#{})", items.0, items.1));
            let r = self.add(&format!(
                "(REPRESENTATION_RELATIONSHIP('','',#{},#{})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{t})SHAPE_REPRESENTATION_RELATIONSHIP())",
                reps.0, reps.1
            ));
            let n = self.add(&format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{whole},#{part},$)"));
            let s = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{n})"));
            self.add(&format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{r},#{s})"));
        }
    }
}

fn flag(b: bool) -> &'static str {
    if b {
        ".T."
    } else {
        ".F."
    }
}

/// A unit vector square to one along an axis of the world.
fn square_to(z: P) -> P {
    if z[2].abs() > 0.5 {
        [1., 0., 0.]
    } else {
        [0., 0., 1.]
    }
}
