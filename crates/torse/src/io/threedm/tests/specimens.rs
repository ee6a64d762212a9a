//! Small archives, made byte by byte.

use super::super::bytes::{summed, ANONYMOUS, SHORT, SUMMED};

/// Identifiers of classes.
pub const LINE: u128 = 0x4ED7_D4DB_E947_11D3_BFE5_0010_8301_22F0;
pub(crate) const ARC: u128 = 0xCF33_BE2A_09B4_11D4_BFFB_0010_8301_22F0;
pub(crate) const POINT: u128 = 0xC310_1A1D_F157_11D3_BFE7_0010_8301_22F0;
pub(crate) const DOT: u128 = 0x7419_8302_CDF4_4F95_9609_6D68_4F22_AB37;
pub const POLYLINE: u128 = 0x4ED7_D4E6_E947_11D3_BFE5_0010_8301_22F0;
pub(crate) const POLYCURVE: u128 = 0x4ED7_D4E0_E947_11D3_BFE5_0010_8301_22F0;
pub(crate) const NURBS_SURFACE: u128 = 0x4ED7_D4DE_E947_11D3_BFE5_0010_8301_22F0;
pub(crate) const NURBS_CURVE: u128 = 0x4ED7_D4DD_E947_11D3_BFE5_0010_8301_22F0;
pub const PLANE: u128 = 0x4ED7_D4DF_E947_11D3_BFE5_0010_8301_22F0;
pub(crate) const REVOLUTION: u128 = 0xA162_20D3_163B_11D4_8000_0010_8301_22F0;
pub(crate) const SUM: u128 = 0xC4CD_5359_446D_4690_9FF5_2905_9732_472B;
/// The polysurface by the identifier that Rhino itself writes.
pub(crate) const BREP: u128 = 0xF06F_C243_A32A_4608_9DD8_A7D2_C4CE_2A36;
pub(crate) const EXTRUSION: u128 = 0x36F5_3175_72B8_4D47_BF1F_B4E6_FC24_F4B9;
pub(crate) const MESH: u128 = 0x4ED7_D4E4_E947_11D3_BFE5_0010_8301_22F0;
pub(crate) const SUBD: u128 = 0xF09B_A4D9_455B_42C3_BA3B_E6CC_ACEF_853B;
pub(crate) const REFERENCE: u128 = 0xF9CF_B638_B9D4_4340_87E3_C56E_7865_D96A;
const LAYER: u128 = 0x9580_9813_E985_11D3_BFE5_0010_8301_22F0;
const DEFINITION: u128 = 0x26F8_BFF6_2618_417F_A158_153D_64A9_4989;

/// Types of objects in their table.
pub(crate) const SURFACE_TYPE: u64 = 8;
pub(crate) const BREP_TYPE: u64 = 0x10;
pub(crate) const CURVE_TYPE: u64 = 4;

/// Bytes of a body, and the state of its checksum.
#[derive(Clone)]
pub(crate) struct Out {
    pub bytes: Vec<u8>,
    sum: u32,
    version: u32,
}

impl Out {
    pub fn new(version: u32) -> Self {
        Self { bytes: Vec::new(), sum: !0, version }
    }

    pub fn put(&mut self, b: &[u8]) -> &mut Self {
        self.bytes.extend_from_slice(b);
        self.sum = summed(self.sum, b);
        self
    }

    pub fn u8(&mut self, x: u8) -> &mut Self {
        self.put(&[x])
    }

    pub fn ints(&mut self, all: &[i32]) -> &mut Self {
        all.iter().for_each(|x| {
            self.put(&x.to_le_bytes());
        });
        self
    }

    pub fn nums(&mut self, all: &[f64]) -> &mut Self {
        all.iter().for_each(|x| {
            self.put(&x.to_le_bytes());
        });
        self
    }

    pub fn list(&mut self, all: &[i32]) -> &mut Self {
        self.ints(&[all.len() as i32]).ints(all)
    }

    pub fn knots(&mut self, all: &[f64]) -> &mut Self {
        self.ints(&[all.len() as i32]).nums(all)
    }

    pub fn text(&mut self, t: &str) -> &mut Self {
        let units: Vec<u16> = t.encode_utf16().chain([0]).collect();
        self.ints(&[units.len() as i32]);
        units.iter().for_each(|u| {
            self.put(&u.to_le_bytes());
        });
        self
    }

    pub fn uuid(&mut self, id: u128) -> &mut Self {
        let b = id.to_be_bytes();
        self.put(&[b[3], b[2], b[1], b[0], b[5], b[4], b[7], b[6]]).put(&b[8..])
    }

    fn head(&mut self, code: u32, value: u64) {
        self.bytes.extend_from_slice(&code.to_le_bytes());
        let wide = value.to_le_bytes();
        self.bytes.extend_from_slice(if self.version >= 50 { &wide } else { &wide[..4] });
    }

    pub fn short(&mut self, code: u32, value: u64) -> &mut Self {
        self.head(code | SHORT, value);
        self
    }

    pub fn chunk(&mut self, code: u32, fill: impl FnOnce(&mut Self)) -> &mut Self {
        let mut inner = Self::new(self.version);
        fill(&mut inner);
        if code & SUMMED != 0 {
            inner.bytes.extend_from_slice(&(!inner.sum).to_le_bytes());
        }
        self.head(code, inner.bytes.len() as u64);
        self.bytes.extend(inner.bytes);
        self
    }

    pub fn object(&mut self, class: u128, fill: impl FnOnce(&mut Self)) -> &mut Self {
        self.chunk(0x0002_7FFA, |c| {
            c.chunk(0x0002_FFFB, |id| {
                id.uuid(class);
            })
            .chunk(0x0002_FFFC, fill)
            .short(0x8002_7FFF, 0);
        })
    }

    /// A table of a polysurface.
    pub fn table(&mut self, count: usize, fill: impl FnOnce(&mut Self)) -> &mut Self {
        self.chunk(ANONYMOUS, |t| fill(t.u8(0x10).ints(&[count as i32])))
    }

    pub fn line(&mut self, p: [f64; 3], q: [f64; 3]) -> &mut Self {
        self.object(LINE, |c| {
            c.u8(0x10).nums(&p).nums(&q).nums(&[0.0, 1.0]).ints(&[3]);
        })
    }

    /// A plane: origin, axes, equation.
    pub fn plane(&mut self, o: [f64; 3], x: [f64; 3], y: [f64; 3], z: [f64; 3]) -> &mut Self {
        self.nums(&o).nums(&x).nums(&y).nums(&z).nums(&[0.0; 4])
    }

    /// An arc about z.
    pub fn arc(&mut self, centre: [f64; 3], radius: f64, angles: [f64; 2]) -> &mut Self {
        self.object(ARC, |c| {
            c.u8(0x10).plane(centre, [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]).nums(&[radius]).nums(&[0.0; 9]);
            c.nums(&angles).nums(&angles).ints(&[3]);
        })
    }

    /// A closed or open polygon in the plane of a profile.
    pub fn polyline(&mut self, corners: &[[f64; 2]]) -> &mut Self {
        self.object(POLYLINE, |c| {
            c.u8(0x10).ints(&[corners.len() as i32]);
            corners.iter().for_each(|p| {
                c.nums(&[p[0], p[1], 0.0]);
            });
            c.knots(&(0..corners.len()).map(|k| k as f64).collect::<Vec<_>>()).ints(&[2]);
        })
    }
}

/// An object of the table with what is said of it.
pub struct Item {
    pub kind: u64,
    pub class: u128,
    pub data: Out,
    pub id: u128,
    pub name: &'static str,
    pub layer: i32,
    /// 0 shown, 1 hidden, 3 member of a block.
    pub mode: u8,
}

impl Item {
    pub fn new(kind: u64, class: u128, data: Out) -> Self {
        Self { kind, class, data, id: 7, name: "", layer: 0, mode: 0 }
    }
}

/// What an archive holds.
pub(crate) struct Specimen {
    pub version: u32,
    /// Number of the unit and metres of a custom one.
    pub unit: (i32, f64),
    pub items: Vec<Item>,
    /// Blocks: identifier, name, members.
    pub blocks: Vec<(u128, &'static str, Vec<u128>)>,
}

impl Specimen {
    pub fn new(version: u32, items: Vec<Item>) -> Self {
        Self { version, unit: (2, 1.0), items, blocks: Vec::new() }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut all = Out::new(self.version);
        all.put(b"3D Geometry File Format ").put(format!("{:>8}", self.version).as_bytes());
        all.chunk(1, |c| {
            c.put(b"specimen");
        });
        table(&mut all, 0x14, |t| {
            t.short(0xA000_0026, 201_601_010);
        });
        table(&mut all, 0x15, |t| {
            t.chunk(0x2000_8031, |c| {
                c.ints(&[102, self.unit.0]).nums(&[0.001, 0.01, 0.01]).ints(&[0, 3]).nums(&[self.unit.1]).text("Ell");
            });
        });
        table(&mut all, 0x11, |t| {
            for (k, (name, shown)) in [("Hull", true), ("Off", false)].iter().enumerate() {
                t.chunk(0x2000_8050, |r| {
                    r.object(LAYER, |c| layer(c, k as i32, name, *shown));
                });
            }
        });
        table(&mut all, 0x21, |t| {
            for (id, name, members) in &self.blocks {
                t.chunk(0x2000_8076, |r| {
                    r.object(DEFINITION, |c| definition(c, *id, name, members));
                });
            }
        });
        table(&mut all, 0x13, |t| self.items.iter().for_each(|i| record(t, i)));
        all.chunk(0x7FFF, |c| {
            c.put(&[0; 8]);
        });
        all.bytes
    }
}

fn table(all: &mut Out, number: u32, fill: impl FnOnce(&mut Out)) {
    all.chunk(0x1000_0000 | number, |t| {
        fill(t);
        t.short(0xFFFF_FFFF, 0);
    });
}

fn layer(c: &mut Out, index: i32, name: &str, shown: bool) {
    c.u8(0x16).ints(&[0, index, -1, -1, 0, 0]).ints(&[0]).nums(&[0.0, 1.0]).text(name).u8(u8::from(shown));
    c.ints(&[-1, 0]).nums(&[0.0]).u8(0).uuid(100 + index as u128).uuid(0).u8(1);
}

/// In the older form before version 6, in the newer form from then on.
fn definition(c: &mut Out, id: u128, name: &str, members: &[u128]) {
    let count = members.len() as i32;
    if c.version < 60 {
        c.u8(0x16).uuid(id).ints(&[count]);
        members.iter().for_each(|m| {
            c.uuid(*m);
        });
        c.text(name).text("").text("").text("").nums(&[0.0; 6]).ints(&[0]);
        return;
    }
    c.chunk(ANONYMOUS, |c| {
        c.ints(&[1, 0]);
        c.chunk(0x4000_8002, |m| {
            m.ints(&[1, 0]).u8(0).u8(1).uuid(id).u8(0).u8(1).ints(&[5]).u8(1).text(name);
        });
        c.ints(&[1]).chunk(ANONYMOUS, |u| {
            u.ints(&[1, 0, 2]).nums(&[0.001]).text("");
        });
        c.text("").text("").text("").nums(&[0.0; 6]).u8(1).ints(&[count]);
        members.iter().for_each(|m| {
            c.uuid(*m);
        });
    });
}

fn record(t: &mut Out, i: &Item) {
    t.chunk(0x2000_8070, |r| {
        r.short(0x8200_0071, i.kind);
        r.chunk(0x0002_7FFA, |c| {
            c.chunk(0x0002_FFFB, |id| {
                id.uuid(i.class);
            });
            c.chunk(0x0002_FFFC, |d| *d = i.data.clone()).short(0x8002_7FFF, 0);
        });
        r.chunk(0x0200_8072, |a| match a.version {
            ..50 => {
                a.u8(0x12).uuid(i.id).ints(&[i.layer, -1, 0, 0]).nums(&[0.0, 1.0]).ints(&[1]);
                a.u8(i.mode).put(&[0; 3]).text(i.name).text("").list(&[]).u8(1);
            }
            _ => {
                a.u8(0x20).uuid(i.id).ints(&[i.layer]).u8(1).text(i.name).u8(6).ints(&[0]).u8(12).u8(i.mode).u8(0);
            }
        });
        r.short(0x8200_007F, 0);
    });
}

/// The data of a bare rational surface: a quarter of a cylinder of radius `r` and height `h` about z.
pub(crate) fn quarter_cylinder(version: u32, r: f64, h: f64) -> Out {
    let mut c = Out::new(version);
    let w = 0.5f64.sqrt();
    // Knots without the first and the last; coordinates times weights.
    c.u8(0x10).ints(&[3, 1, 3, 2, 3, 2, 0, 0]).nums(&[0.0; 6]).knots(&[0., 0., 1., 1.]).knots(&[0., 1.]).ints(&[6]);
    for (x, y, w) in [(r, 0.0, 1.0), (r, r, w), (0.0, r, 1.0)] {
        c.nums(&[w * x, w * y, 0.0, w, w * x, w * y, w * h, w]);
    }
    c
}

/// A loop of a specimen: corners in the plane z = 0 as indices of vertices.
pub(crate) struct Ring<'a> {
    pub corners: &'a [usize],
    pub outer: bool,
}

/// The data of a plane polysurface of one face: edges are lines between vertices, each the part from 1 to 3 of a line over
/// 0 to 4, run backwards where `backwards`; loops run about +z, whether the face is reversed or not.
pub(crate) fn plane_face(version: u32, vertices: &[[f64; 2]], rings: &[Ring], reversed: bool, backwards: bool) -> Out {
    let sides: Vec<(usize, usize, usize)> = rings
        .iter()
        .enumerate()
        .flat_map(|(l, r)| (0..r.corners.len()).map(move |i| (r.corners[i], r.corners[(i + 1) % r.corners.len()], l)))
        .collect();
    let n = sides.len();
    let mut c = Out::new(version);
    c.u8(0x32);
    c.table(n, |t| {
        sides.iter().for_each(|_| {
            t.ints(&[0]);
        })
    });
    c.table(n, |t| {
        for &(a, b, _) in &sides {
            let (p, q) = if backwards { (vertices[b], vertices[a]) } else { (vertices[a], vertices[b]) };
            // The line goes on by half the edge at both ends.
            let at = |s: f64| [p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]), 0.0];
            let (from, to) = (at(-0.5), at(1.5));
            t.ints(&[1]).object(LINE, |c| {
                c.u8(0x10).nums(&from).nums(&to).nums(&[0.0, 4.0]).ints(&[3]);
            });
        }
    });
    c.table(1, |t| {
        t.ints(&[1]).object(PLANE, |c| {
            c.u8(0x11).plane([0.; 3], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]);
            c.nums(&[0., 1., 0., 1., -99., 99., -99., 99.]);
        });
    });
    c.table(vertices.len(), |t| {
        for (k, v) in vertices.iter().enumerate() {
            t.ints(&[k as i32]).nums(&[v[0], v[1], 0.0]).list(&[]).nums(&[0.0]);
        }
    });
    c.table(n, |t| {
        for (k, &(a, b, _)) in sides.iter().enumerate() {
            let k = k as i32;
            t.ints(&[k, k, i32::from(backwards)]).nums(&[1., 3.]).ints(&[a as i32, b as i32]).list(&[k]);
            t.nums(&[0.0, 0.0, 1.0]);
        }
    });
    c.table(n, |t| {
        for (k, &(a, b, l)) in sides.iter().enumerate() {
            let k = k as i32;
            t.ints(&[k, -1]).nums(&[0., 1.]).ints(&[k, a as i32, b as i32, 0, 1, 0, l as i32]);
            t.nums(&[0., 0., 0., 1.]).put(&[0; 32]).nums(&[0., 0.]);
        }
    });
    c.table(rings.len(), |t| {
        for (l, r) in rings.iter().enumerate() {
            let own: Vec<i32> = (0..n as i32).filter(|&k| sides[k as usize].2 == l).collect();
            t.ints(&[l as i32]).list(&own).ints(&[if r.outer { 1 } else { 2 }, 0]);
        }
    });
    c.table(1, |t| {
        let loops: Vec<i32> = (0..rings.len() as i32).collect();
        t.ints(&[0]).list(&loops).ints(&[0, i32::from(reversed), 0]);
    });
    c.nums(&[0.0; 6]);
    for _ in 0..2 {
        c.chunk(ANONYMOUS, |m| {
            m.u8(0);
        });
    }
    c.ints(&[0]);
    c
}

/// The data of a plane triangle as version 2 of the program wrote it: (0, 0), (4, 0), (0, 3) on a bilinear surface.
pub(crate) fn old_triangle(version: u32) -> Out {
    let corners = [[0., 0.], [4., 0.], [0., 3.]];
    let mut c = Out::new(version);
    c.u8(0x21).ints(&[1, 3, 1, 3, 0]).nums(&[0.0; 6]);
    // Curves in the parameter plane, whose numbers are a tenth of the lengths, then those in space.
    for scale in [0.1, 1.0] {
        for i in 0..3 {
            let at = |p: [f64; 2]| [scale * p[0], scale * p[1], 0.0];
            c.u8(0x10).ints(&[1, 0, 0]).nums(&[0.0; 6]).knots(&[0., 1.]);
            c.line(at(corners[i]), at(corners[(i + 1) % 3]));
        }
    }
    c.u8(0x10).ints(&[3, 0, 2, 2, 2, 2, 0, 0]).nums(&[0.0; 6]).knots(&[0., 1.]).knots(&[0., 1.]).ints(&[4]);
    c.nums(&[0., 0., 0., 0., 10., 0., 10., 0., 0., 10., 10., 0.]);
    c.ints(&[0, 0, 1, 0]).nums(&[0.0; 6]).ints(&[1, 0, 0]).nums(&[0.0; 4]).ints(&[3]);
    for i in 0..3 {
        c.ints(&[i, -1]).u8(1).ints(&[i, 0, 0, 0]).nums(&[0.0; 2]);
    }
    c.u8(0).u8(0);
    c
}
