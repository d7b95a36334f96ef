use super::super::tables::RUN_PICTURES;
use super::super::{ContactPoint, ContactStatus, Half, OutputDirectory, StepRecord};
use super::axes::Axes;
use super::*;
use crate::analytical::ElasticSphere;
use crate::analytical::cattaneo_mindlin::CattaneoMindlin;
use crate::analytical::olsson_larsson::{OlssonLarsson, OlssonLarssonHardening};
use crate::case::PictureFormat;
use std::fs;
use std::path::{Path, PathBuf};

const INPUTS: PlotInputs = PlotInputs {
    sphere: ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 },
    hardening: Some(OlssonLarssonHardening::Ideal { yield_stress: 400.0 }),
    friction: Some(0.3),
    bodies: 1.0,
};

const SVG: PictureFormat = PictureFormat::Svg;

fn view() -> View {
    View { axes: Axes::normalised(1.0, 200e3), sheet: Sheet::default() }
}

/// Olsson & Larsson's pressing with a ripple, then a shear of Cattaneo-Mindlin's shape under a
/// falling force.
pub(super) fn history() -> Vec<StepRecord> {
    let model = OlssonLarsson { sphere: INPUTS.sphere, hardening: INPUTS.hardening.unwrap() };
    let elastic = CattaneoMindlin::at_indentation(INPUTS.sphere, 0.3, 0.02);
    let mut rows: Vec<StepRecord> = (1..=20)
        .map(|i| {
            let h = 0.02 * f64::from(i) / 20.0;
            let f_n = model.force(h) * (0.98 + 0.02 * f64::from(i % 3));
            StepRecord { step: i as usize, h, f_n, a: model.contact_radius(h), ..StepRecord::default() }
        })
        .collect();
    let pressed = rows[19];
    rows.extend((1..=14).map(|i| {
        let x = 1.3 * (f64::from(i) / 14.0).powf(2.3);
        let f_n = pressed.f_n * (1.0 - 0.3 * x.min(1.0));
        let ratio = elastic.force(x * elastic.slip_displacement()) / elastic.normal_force;
        StepRecord { step: 20 + i as usize, segment: 1, delta_t: 0.003 * x, f_n, f_t: ratio * f_n, ..pressed }
    }));
    rows
}

/// A disc with a sticking core, a slipping ring and an open rim.
pub(super) fn contact() -> Vec<ContactPoint> {
    let mut points = Vec::new();
    for ring in 0..24 {
        let r = 0.0125 * f64::from(ring);
        let around = 6 + 2 * ring;
        for i in 0..=around {
            let angle = std::f64::consts::PI * f64::from(i) / f64::from(around);
            let (x, y) = (r * angle.cos(), r * angle.sin());
            let status = match r {
                ..0.12 => ContactStatus::Stick,
                ..0.21 => ContactStatus::Slip,
                _ => ContactStatus::Open,
            };
            points.push(ContactPoint {
                point: points.len(),
                reference_x: x,
                reference_y: y,
                current_x: x + 0.004,
                current_y: y,
                gap: (r - 0.21).max(0.0),
                pressure: if r < 0.21 { 1200.0 - 3000.0 * r } else { 0.0 },
                traction_x: 0.0,
                traction_y: 0.0,
                area: 0.0125 * 0.0125,
                status,
                half: if i == 0 || i == around { Half::Both } else { Half::Meshed },
            });
        }
    }
    ContactPoint::whole(points)
}

/// The text of an SVG without its markup, subscripts with their `_` lost: F_N is FN.
fn parsed(path: &Path) -> String {
    use quick_xml::events::Event;
    let text = fs::read_to_string(path).unwrap();
    assert!(text.starts_with("<svg"), "{}", &text[..80]);
    let mut reader = quick_xml::Reader::from_str(&text);
    reader.config_mut().check_end_names = true;
    let mut words = String::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Eof => return words,
            Event::Text(text) => words.push_str(&text),
            Event::End(end) if end.name().as_ref() == "text" => words.push('\n'),
            _ => {}
        }
    }
}

fn tables() -> Tables {
    let rows = history();
    let mut tables = Tables::default();
    tables.add(&rows[..20], contact());
    for count in [22, 24, 26, 28, 30, 32, 34] {
        tables.add(&rows[..count], contact());
    }
    tables
}

#[test]
fn every_plot_is_sound_xml_with_its_labels() {
    let folder = tempfile::tempdir().unwrap();
    // For a look: ASPERITY_KEEP_PLOTS=FOLDER cargo test --lib output::plots
    let root = std::env::var_os("ASPERITY_KEEP_PLOTS").map_or(folder.path().to_path_buf(), PathBuf::from);
    let out = OutputDirectory::create(root).unwrap();
    let written = write_plots(&out, &history(), &tables(), &INPUTS, &view(), SVG).unwrap();
    assert_eq!(written.len(), 7);
    for (name, labels) in [
        ("indentation", ["0: press", "Hertz", "Olsson", "normal force, 103 FN / (E R2)"]),
        ("pressure", ["same FN and a", "contact points", "contact radius a", "103 p / E"]),
        ("forces", ["FT, tangential", "FN, normal", "103 δT / R", "force"]),
        ("ratio", ["μ = 0.3", "FT / FN", "Friction used", "δT"]),
        ("stick", ["Mindlin", "stick radius", "simulation", "δT"]),
        ("slip", ["FT/FN =", "stick", "slip", "along the shear"]),
        ("contact", ["stick (", "slip (", "open (", "103 p / E"]),
    ] {
        let words = parsed(&out.plot(name, SVG));
        for label in labels {
            assert!(words.contains(label), "{name}: {label} is missing in {words}");
        }
    }
    // A point of the diagram for each meshed node, and no dots in the maps: areas, one for each
    // level of the pressure, with a smooth bar.
    let whole = contact();
    let of = |half: Half| whole.iter().filter(|point| point.half == half).count();
    assert!(of(Half::Meshed) == of(Half::Mirrored) && of(Half::Both) == 48);
    let count = |name: &str, what: &str| fs::read_to_string(out.plot(name, SVG)).unwrap().matches(what).count();
    assert!(count("pressure", "<circle") <= of(Half::Meshed) + of(Half::Both) + 1, "{}", count("pressure", "<circle"));
    assert_eq!((count("contact", "<circle"), count("slip", "<circle")), (0, 0));
    assert!((40..=80).contains(&count("contact", "<path")), "{}", count("contact", "<path"));
    assert_eq!(count("contact", "<linearGradient"), 1);
    // Hertz's elastic pressure is a curve or, where it is off the scale, a word in the caption;
    // never an entry of the legend without a curve.
    let pictures = run_pictures(&history(), &tables(), &INPUTS, &view()).unwrap();
    let pressure = pictures.iter().find(|picture| picture.name == "pressure").unwrap();
    assert_ne!(
        pressure.svg.contains("elastic at the same h"),
        pressure.caption.contains("off the scale"),
        "{}",
        pressure.caption
    );
    // Six of the seven, the first and the last among them.
    let slip = parsed(&out.plot("slip", SVG));
    assert_eq!(slip.matches("FT/FN =").count(), 6);
    assert!(slip.contains("103 δT / R = 3.9"), "{slip}");
}

/// Press, shear, shear back, unload.
fn cycle() -> Vec<StepRecord> {
    let mut rows = history();
    let sheared = rows[rows.len() - 1];
    let mut go = |segment: usize, count: usize, row: &dyn Fn(f64) -> StepRecord| {
        for i in 1..=count {
            let step = rows.len() + 1;
            rows.push(StepRecord { step, segment, ..row(i as f64 / count as f64) });
        }
    };
    let turn = |x: f64| StepRecord { delta_t: sheared.delta_t * (1.0 - 2.0 * x), f_t: sheared.f_t * (1.0 - 2.0 * x), ..sheared };
    go(2, 10, &turn);
    let back = turn(1.0);
    go(3, 6, &|x| StepRecord { h: back.h * (1.0 - 0.1 * x), f_n: back.f_n * (1.0 - x), f_t: back.f_t * (1.0 - x), ..back });
    rows
}

#[test]
fn segments_have_colours_and_arrows_and_unloading_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let root =
        std::env::var_os("ASPERITY_KEEP_PLOTS").map_or(folder.path().to_path_buf(), |keep| PathBuf::from(keep).join("cycle"));
    let out = OutputDirectory::create(root).unwrap();
    write_plots(&out, &cycle(), &Tables::default(), &INPUTS, &view(), SVG).unwrap();
    let svg = |name: &str| fs::read_to_string(out.plot(name, SVG)).unwrap();
    let arrows = |name: &str| svg(name).matches("<polygon").count();
    for (name, segments, arrows_at_least) in
        [("forces", ["1: shear", "2: shear back", "3: unload"], 4), ("indentation", ["0: press", "1: shear", "3: unload"], 3)]
    {
        let words = parsed(&out.plot(name, SVG));
        assert!(segments.iter().all(|segment| words.contains(segment)), "{name}: {words}");
        assert!(arrows(name) >= arrows_at_least, "{name}: {}", arrows(name));
    }
    // A curve of each segment in its own colour, F_T dashed.
    for colour in [style::BLUE, style::VERMILION, style::GREEN] {
        assert!(svg("forces").contains(&format!("stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"6,4\"")), "{colour}");
    }
    // Forth and back the ratio has both signs; forth alone, no room for the other.
    assert!(parsed(&out.plot("ratio", SVG)).contains("-0.2"));
    let forth = plot_ratio(&history(), Some(0.3), &view()).unwrap().svg;
    assert!(!forth.contains(">-0.1<") && forth.contains(">0.1<"), "{forth}");
}

#[test]
fn a_dip_on_the_axis_is_explained_where_there_is_one() {
    let record = history()[19];
    let level = plot_pressure(&contact(), &record, &INPUTS, &view()).unwrap();
    assert!(!level.svg.contains("friction's") && !level.caption.contains("friction's"));
    let mut points = contact();
    for point in points.iter_mut().filter(|point| point.pressure > 0.0) {
        point.pressure = 600.0 + 2500.0 * point.current_x.hypot(point.current_y);
    }
    let dip = plot_pressure(&points, &record, &INPUTS, &view()).unwrap();
    assert!(dip.svg.contains(">The dip on the axis is friction's, not the mesh's:") && dip.caption.contains("friction's"));
    // Without friction it would be something else.
    let smooth = plot_pressure(&points, &record, &PlotInputs { friction: Some(0.0), ..INPUTS }, &view()).unwrap();
    assert!(!smooth.svg.contains("friction's"));
}

#[test]
fn a_narrow_picture_keeps_its_text_on_the_card() {
    let sheet = Sheet { width: Some("85mm".parse().unwrap()), untitled: false };
    let narrow = View { sheet, ..view() };
    let pictures = run_pictures(&history(), &tables(), &INPUTS, &narrow).unwrap();
    for picture in &pictures {
        assert!(picture.svg.starts_with("<svg width=\"85.0000mm\""), "{}", &picture.svg[..60]);
        if let Some(keep) = std::env::var_os("ASPERITY_KEEP_PLOTS") {
            fs::write(PathBuf::from(keep).join(format!("narrow-{}.svg", picture.name)), &picture.svg).unwrap();
        }
        for line in picture.svg.lines().filter(|line| line.starts_with("<text") && !line.contains("rotate")) {
            let attribute = |name: &str| -> f64 {
                line.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap().parse().unwrap()
            };
            // Words without markup, at most as wide as all of them on the line.
            let words: String = line.split('<').filter_map(|part| part.split_once('>')).map(|(_, words)| words).collect();
            let width = text::text_width(&words.replace("&gt;", ">"), attribute("font-size") * text::LINE_HEIGHT);
            let left = match line {
                line if line.contains("\"middle\"") => attribute("x") - 0.5 * width,
                line if line.contains("\"end\"") => attribute("x") - width,
                _ => attribute("x"),
            };
            assert!(left > -12.0 && left + width < 361.0 + 12.0, "{}: {words}: {left} to {}", picture.name, left + width);
        }
    }
}

#[test]
fn only_what_there_is_gets_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let out = OutputDirectory::create(folder.path()).unwrap();
    assert!(write_plots(&out, &[], &Tables::default(), &INPUTS, &view(), SVG).unwrap().is_empty());
    assert_eq!(
        write_plots(&out, &history()[..5], &Tables::default(), &INPUTS, &view(), SVG).unwrap(),
        [out.plot("indentation", SVG)]
    );
    assert!(!out.plot("forces", SVG).exists());
}

#[test]
fn odd_histories_do_not_break_the_plots() {
    let folder = tempfile::tempdir().unwrap();
    let out = OutputDirectory::create(folder.path()).unwrap();
    let mut rows = history();
    // To the left, with a lost contact, a NaN and a last point in mid-air.
    for row in &mut rows {
        (row.delta_t, row.f_t) = (-row.delta_t, -row.f_t);
    }
    rows[25].f_n = 0.0;
    rows[26].f_t = f64::NAN;
    let elastic = PlotInputs { hardening: None, friction: None, ..INPUTS };
    assert_eq!(write_plots(&out, &rows, &Tables::default(), &elastic, &view(), SVG).unwrap().len(), 4);
    let mut open = contact();
    for point in &mut open {
        (point.status, point.pressure) = (ContactStatus::Open, 0.0);
    }
    let mut tables = Tables::default();
    tables.add(&rows[..20], open.clone());
    tables.add(&rows[..30], open[..1].to_vec());
    assert!(tables.last.is_empty() && tables.shear.len() == 1);
    write_plots(&out, &rows, &tables, &elastic, &view(), SVG).unwrap();
    plot_contact(&open, &view()).unwrap().write(&out.plot("contact", SVG), SVG).unwrap();
    parsed(&out.plot("contact", SVG));
    plot_contact(&open[..1], &view()).unwrap();
    plot_slip(&[], &view()).unwrap();
    // All zero: nothing to scale by.
    let flat = vec![StepRecord::default(), StepRecord { delta_t: 1.0, ..StepRecord::default() }];
    write_plots(&out, &flat, &Tables::default(), &INPUTS, &view(), SVG).unwrap();
}

#[test]
fn a_run_is_drawn_again_from_its_directory() {
    use crate::output::{HistoryWriter, write_contact};
    let folder = tempfile::tempdir().unwrap();
    let out = OutputDirectory::create(folder.path()).unwrap();
    let case = "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\n\
                law = \"ideal\"\nyield_stress = 400.0\n[contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n";
    let case = crate::case::Case::parse(case, "case.toml", &[]).unwrap();
    let mut writer = HistoryWriter::create(&out.history()).unwrap();
    history().iter().for_each(|row| writer.append(row).unwrap());
    let names = |pictures: Vec<Picture>| pictures.iter().map(|picture| picture.name).collect::<Vec<_>>();
    let bare = names(replot(&out, &case, &history(), &view()).unwrap());
    assert_eq!(bare, ["indentation", "forces", "ratio", "stick"]);
    // Step 99 is of another run.
    for step in [20, 22, 24, 26, 28, 30, 32, 34, 99] {
        write_contact(&out.contact(step), &contact()).unwrap();
    }
    let again = replot(&out, &case, &history(), &view()).unwrap();
    assert_eq!(again, run_pictures(&history(), &tables(), &INPUTS, &view()).unwrap());
    assert!(names(again).iter().all(|name| RUN_PICTURES.contains(name)));
    fs::write(out.contact(34), "point\nx\n").unwrap();
    assert!(replot(&out, &case, &history(), &view()).unwrap_err().to_string().contains("step_0034.csv"));
}

#[test]
fn ticks_are_short() {
    use super::style::tick;
    let shown: Vec<String> =
        [0.0, 0.1 + 0.2, -150.0, 0.0025, 1.25e-5, 2e7, 123_456.0, 0.30000000001].into_iter().map(tick).collect();
    assert_eq!(shown, ["0", "0.3", "-150", "0.0025", "1.25e-5", "2e7", "123456", "0.3"]);
}
