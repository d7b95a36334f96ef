//! The VTU and PVD files, opened by the programs that users open them with.

mod python;

use asperity::output::{Collection, Field, Grid, Values, write_vtu};
use std::path::Path;
use std::process::Command;

fn json(fields: &[Field]) -> serde_json::Value {
    let value = |field: &Field| match &field.values {
        Values::Real(values) => serde_json::json!(values),
        Values::Integer(values) => serde_json::json!(values),
    };
    serde_json::Value::Object(fields.iter().map(|field| (field.name.clone(), value(field))).collect())
}

#[test]
fn meshio_reads_what_was_written_and_pyvista_where_there_is_one() {
    let Some(python) = python::python("meshio_reads_what_was_written_and_pyvista_where_there_is_one", &["meshio", "numpy"])
    else {
        return;
    };
    // Two hexahedra in a row, with numbers that a decimal detour would spoil.
    let mut points = Vec::new();
    for x in 0..3 {
        points.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[y, z]| [f64::from(x) / 3.0, y, z]));
    }
    let cells = [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]];
    let irrational = |i: usize| (1.0 + i as f64).sqrt() * 1e-3;
    let displacement: Vec<[f64; 3]> = (0..12).map(|i| [irrational(i), -irrational(2 * i), 0.0]).collect();
    let stress: Vec<[f64; 6]> = (0..2).map(|i| std::array::from_fn(|j| irrational(6 * i + j) - 0.002)).collect();
    let point_fields = [
        Field::vector("displacement", &displacement),
        Field::scalar("contact_pressure", (0..12).map(irrational).collect()),
        Field::integer("contact_status", (0..12).map(|i| i % 3).collect()),
    ];
    let cell_fields = [Field::symmetric_tensor("stress", &stress), Field::integer("plastic", vec![0, 1])];

    let folder = tempfile::tempdir().unwrap();
    let vtu = folder.path().join("fields/step_0002.vtu");
    write_vtu(&vtu, &Grid { points: &points, cells: &cells, symmetry_plane: Some(0.0) }, &point_fields, &cell_fields).unwrap();
    let pvd = folder.path().join("fields/case.pvd");
    let mut collection = Collection::new(&pvd);
    collection.push(2.0, &vtu).unwrap();
    let expected = folder.path().join("expected.json");
    let content = serde_json::json!({
        "points": points, "cells": cells, "point_data": json(&point_fields), "cell_data": json(&cell_fields)
    });
    std::fs::write(&expected, content.to_string()).unwrap();

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/check_vtu.py");
    let output = Command::new(python).arg(script).args([&vtu, &expected, &pvd]).output().unwrap();
    let text = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && text.contains("all fields equal"), "{text}");
    println!("{text}");
}
