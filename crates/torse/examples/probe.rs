use torse::geom::Vec3;
use torse::spline::{knots::Knots, surface::Surface};
use torse::surface::face::Face;
use torse::pipeline::cover::{cover, CoverOptions};
use torse::control::Control;

fn main() {
    let a: Vec<String> = std::env::args().collect();
    let tol: f64 = a[2].parse().unwrap();
    let j: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(format!("/work/shared/surfaces/{}.json", a[1])).unwrap()).unwrap();
    let f = |k: &str| -> Vec<f64> { j[k].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
    let mut pts = vec![]; let mut w = vec![];
    for (r, wr) in j["control_points"].as_array().unwrap().iter().zip(j["weights"].as_array().unwrap()) {
        for (p, x) in r.as_array().unwrap().iter().zip(wr.as_array().unwrap()) {
            pts.push(Vec3::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap(), p[2].as_f64().unwrap()) * 1000.0);
            w.push(x.as_f64().unwrap());
        }
    }
    let (nu, nv) = (j["control_points"].as_array().unwrap().len(), pts.len() / j["control_points"].as_array().unwrap().len());
    let ku = Knots::new(j["degree_u"].as_u64().unwrap() as usize, f("knots_u"), nu).unwrap();
    let kv = Knots::new(j["degree_v"].as_u64().unwrap() as usize, f("knots_v"), nv).unwrap();
    let s = Surface::new(ku, kv, &pts, Some(&w)).unwrap();
    let face = Face::untrimmed(s);
    let t = std::time::Instant::now();
    let c = cover(&face, &CoverOptions { tolerance: tol, max_panels: usize::MAX, facets: false }, &Control::default()).unwrap();
    println!("{} tol {} : {} panels complete {} in {:.2}s tris {}", a[1], tol, c.state.panels.len(), c.complete, t.elapsed().as_secs_f64(), c.state.partition.triangles.len());
    for (l, p) in &c.state.panels { print!("{}:{:?}{}:{:.3} ", l, p.kind, if matches!(p.torse, torse::surface::torse::Torse::Dual(_)) {"D"} else {"P"}, p.error / tol); }
    println!();
}
