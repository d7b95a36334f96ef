//! The VTU and PVD files, opened by the programs that users open them with.
//!
//! Needs a Python with meshio and numpy (pyvista is used where it is there): `ASPERITY_PYTHON`, else `target/python/bin/python`, else `python3`.
//! To make one: `python3 -m venv target/python && target/python/bin/pip install meshio numpy pyvista`. Without one the test is
//! skipped, aloud; with `ASPERITY_REQUIRE_PYTHON=1` that is a failure.

use asperity::output::{Collection, Field, Grid, Values, write_vtu};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A Python that can import meshio, or why there is none.
fn python() -> Result<PathBuf, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut candidates: Vec<PathBuf> = std::env::var_os("ASPERITY_PYTHON").map(PathBuf::from).into_iter().collect();
    candidates.extend([root.join("target/python/bin/python"), PathBuf::from("python3")]);
    let works = |python: &PathBuf| {
        Command::new(python).args(["-c", "import meshio, numpy"]).output().is_ok_and(|output| output.status.success())
    };
    candidates.into_iter().find(works).ok_or_else(|| {
        "no Python with meshio: python3 -m venv target/python && target/python/bin/pip install meshio numpy pyvista".to_owned()
    })
}

fn json(fields: &[Field]) -> serde_json::Value {
    let value = |field: &Field| match &field.values {
        Values::Real(values) => serde_json::json!(values),
        Values::Integer(values) => serde_json::json!(values),
    };
    serde_json::Value::Object(fields.iter().map(|field| (field.name.clone(), value(field))).collect())
}

#[test]
fn meshio_and_pyvista_read_what_was_written() {
    let python = match python() {
        Ok(python) => python,
        Err(reason) => {
            assert!(std::env::var_os("ASPERITY_REQUIRE_PYTHON").is_none_or(|value| value != "1"), "{reason}");
            // Past the test harness, which would swallow it.
            writeln!(std::io::stderr(), "SKIPPED meshio_and_pyvista_read_what_was_written: {reason}").unwrap();
            return;
        }
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
    write_vtu(&vtu, &Grid { points: &points, cells: &cells }, &point_fields, &cell_fields).unwrap();
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
