//! Clouds and bodies as plain tables: what stands in them.
use std::path::Path;

use alula::case::read;
use alula::run::{BodyTable, body_table, cloud_table};

/// Body and boundary of a particle that is on none.
const NONE: i32 = -1;

#[test]
fn particles_on_boundaries_name_them() {
    let text = "[flow]\nmach = 0.3\n[[body]]\nname = \"rod\"\ncircle = { radius = 0.5 }\n[boundary]\ny_min = \"symmetry\"\n\
                [cloud]\nspacing = 0.25\nfar_field = 4\n";
    let table = cloud_table(&read(text, "t").unwrap(), Path::new("")).unwrap();
    let n = table.kind.len();
    assert!([table.on.points.len(), table.body.len(), table.boundary.len()] == [n; 3]);
    assert_eq!(table.boundaries, ["rod", "x_min", "x_max", "y_min", "y_max"]);
    assert_eq!((table.conditions[2].0, &table.conditions[2].1), ("y_min", &serde_json::json!("symmetry")));
    let normal = table.on.column("normal").unwrap().as_chunks::<3>().0;
    for i in 0..n {
        let [x, y, _] = table.on.points[i];
        match table.kind[i] {
            0 => assert_eq!((table.body[i], table.boundary[i], normal[i]), (NONE, NONE, [0.0; 3])),
            1 => {
                assert_eq!((table.body[i], table.boundary[i]), (0, 0));
                assert!(
                    // a circle is a spline of its points
                    (x.hypot(y) - 0.5).abs() < 1e-7 && (x * normal[i][0] + y * normal[i][1] - 0.5).abs() < 1e-7
                );
            }
            _ => {
                let name = &table.boundaries[table.boundary[i] as usize];
                let outward = if name.starts_with('x') { normal[i][0] } else { normal[i][1] };
                assert_eq!((table.body[i], outward), (NONE, if name.ends_with("max") { 1.0 } else { -1.0 }));
            }
        }
    }
    assert!((0..=2).all(|kind| table.kind.contains(&kind)));
}

fn of(body: &str) -> BodyTable {
    let text = format!("[flow]\nmach = 0.3\n[[body]]\n{body}\n");
    body_table(&read(&text, "t").unwrap(), Path::new("")).unwrap()
}

#[test]
fn bodies_are_measured_and_their_elements_close() {
    let square = of("box = { size = [2, 1] }");
    let m = square.measures;
    assert!((m.area - 6.0).abs() < 1e-12 && (m.volume - 2.0).abs() < 1e-12 && m.closed && m.span.is_none());
    assert_eq!((m.chord, m.extents), (2.0, [[-1.0, -0.5, 0.0], [1.0, 0.5, 0.0]]));
    assert_eq!(square.elements.len(), 2 * square.body.len());
    let cuboid = of("name = \"block\"\nbox = { size = [2, 1, 3] }");
    let m = cuboid.measures;
    assert!((m.area - 22.0).abs() < 1e-12 && (m.volume - 6.0).abs() < 1e-12 && m.closed);
    assert_eq!((m.span, &cuboid.bodies[0][..]), (Some(1.0), "block"));
    for table in [&square, &cuboid] {
        let sum = table.area_vectors.iter().fold([0.0; 3], |s, a| std::array::from_fn(|k| s[k] + a[k]));
        assert!(sum.iter().all(|s| s.abs() < 1e-12), "{sum:?}");
    }
}
