//! The same points in every format, and damaged files.

use super::*;

const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 2.0, -1.0]];

fn expect(name: &str, bytes: &[u8]) {
    let cloud = read(name, bytes, Some(10.0)).expect("a cloud");
    assert_eq!(cloud.points.len(), 3, "{name}");
    for (p, w) in cloud.points.iter().zip(TRIANGLE) {
        assert_eq!([p.x, p.y, p.z], w.map(|x| 10.0 * x), "{name}");
    }
}

#[test]
fn all_formats_give_the_same_points() {
    expect("a.csv", b"x,y,z,i\n0,0,0,1\n1,0,0.5,2\n\n# end\n0,2,-1,3\n");
    expect("a.XYZ", b"3\n0 0 0\n1 0 0.5\n0 2 -1\n");
    expect("a.obj", b"o a\nv 0 0 0\nvn 0 0 1\nv 1 0 0.5\nv 0 2 -1 1.0\nf 1 2 3\n");
    expect(
        "a.ply",
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float z\nproperty float x\nproperty uchar r\n\
          property float y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
          0 0 9 0\n0.5 1 9 0\n-1 0 9 2\n3 0 1 2\n",
    );
    expect("a.stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0.5\nvertex 0 2 -1\nendloop\nendfacet\nendsolid\n");
    let mut stl = vec![b's'; 80];
    stl.extend(1u32.to_le_bytes());
    stl.extend([0u8; 12]);
    TRIANGLE.as_flattened().iter().for_each(|x| stl.extend((*x as f32).to_le_bytes()));
    stl.extend([0u8; 2]);
    expect("b.stl", &stl);
    let points: Vec<Vec3> = TRIANGLE.iter().map(|p| Vec3::from(*p)).collect();
    let written = ply::with_values(&points, &[1.0, 2.0, 3.0], "deviation");
    expect("b.ply", &written);
    // The other byte order.
    let head = written.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let mut big = String::from_utf8_lossy(&written[..head]).replace("little", "big").into_bytes();
    written[head..].chunks(4).for_each(|c| big.extend(c.iter().rev()));
    expect("c.ply", &big);
}

#[test]
fn damaged_files_are_refused_with_the_place() {
    let points: Vec<Vec3> = TRIANGLE.iter().map(|p| Vec3::from(*p)).collect();
    let written = ply::with_values(&points, &[1.0, 2.0, 3.0], "deviation");
    for cut in 0..written.len() {
        assert!(read("a.ply", &written[..cut], None).is_err());
    }
    assert!(matches!(read("a.csv", b"0,0,0\n1,x,2\n", None), Err(CloudReadError::Line { line: 2, .. })));
    assert!(matches!(read("a.csv", b"0,0,nan\n", None), Err(CloudReadError::NotFinite { index: 0 })));
    assert!(matches!(read("a.csv", b"", None), Err(CloudReadError::Empty)));
    assert!(matches!(read("a.las", b"", None), Err(CloudReadError::Kind(_))));
    assert!(matches!(read("a.obj", b"v 1 2\n", None), Err(CloudReadError::Line { .. })));
    assert!(read("a.stl", b"nonsense", None).is_err());
    for (name, bytes, reason) in [
        ("a.csv", &b"z,y\n1,2\n"[..], "named z, y"),
        ("a.csv", b"1,2,3,4\n", "4 columns"),
        ("a.pts", b"3\n1 2 3 4\n1 2 3 4\n", "2 of 3 points"),
        ("a.csv", b"x [m],y [m],z [in]\n1,2,3\n", "different units"),
        ("a.obj", b"v 1 2 3\nv 1 2 4\nf 1 2 3\n", "no vertex 3"),
        ("a.obj", b"v 1 2 3\nv 1 2 4\nf -1 -2 -3\n", "no vertex -3"),
        ("a.obj", b"v 1 2 3\nv 1 2 4\nf 1 2\n", "2 corners"),
        ("a.stl", b"solid\nfacet normal 0 0 1\nvertex 1 2 3\nvertex 1 2 4\nendfacet\nendsolid\n", "cut off"),
        ("a.stl", b"solid\nfacet normal 0 0 1\nvertex 1 2 3\nvertex 1 2 4\nvertex 1 3 4\n", "cut off"),
        ("a.stl", b"solid\nvertex 1 2 3\nfacet normal 0 0 1\nendfacet\nendsolid\n", "1 corners stand before"),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
            element face 18446744073709551615\nelement edge 7\nend_header\n1 2 3\n",
            "1 of 2 vertices",
        ),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
            end_header\n1 2 3\n4 5 6\n",
            "1 lines more",
        ),
    ] {
        let told = read(name, bytes, None).expect_err(reason).to_string();
        assert!(told.contains(reason), "{told}");
    }
    let mut long = vec![b's'; 80];
    long.extend(1u32.to_le_bytes());
    long.extend([0u8; 150]);
    assert!(read("a.stl", &long, None).expect_err("too long").to_string().contains("promises 1 triangles"));
    let mut stl = vec![0u8; 80];
    stl.extend(u32::MAX.to_le_bytes());
    assert!(matches!(read("a.stl", &stl, None), Err(CloudReadError::Short { .. })));
}

#[test]
fn faces_of_meshes_become_triangles() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 3/3 4/4\nf -1 -2 -3\n";
    let cloud = read("a.obj", obj, None).expect("a mesh");
    assert_eq!((cloud.points.len(), cloud.triangles), (4, vec![[0, 1, 2], [0, 2, 3], [3, 2, 1]]));
    let facet = |z: &str| {
        format!("facet normal 0 0 1\nouter loop\nvertex 0 0 {z}\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n")
    };
    let stl = format!("solid\n{}{}endsolid\n", facet("0"), facet("-0"));
    let cloud = read("a.stl", stl.as_bytes(), None).expect("a mesh");
    assert_eq!((cloud.points.len(), cloud.triangles), (3, vec![[0, 1, 2]; 2]));
}
