use super::*;
use crate::analytical::cattaneo_mindlin::CattaneoMindlin;
use crate::analytical::hertz;
use crate::case::Material;
use crate::contact_law::Frame;
use crate::contact_law::path::{drive, drive_centres};

const MU: f64 = 0.3;

fn case(radius: f64, material: &str, opponent: &str, h: f64) -> Case {
    let text = format!(
        "material = {material}\n{opponent}\npath = [{{ indentation = {h} }}]\n[sphere]\nradius = {radius}\n\
         [contact]\nfriction = {MU}\n"
    );
    Case::parse(&text, "case.toml", &[]).unwrap()
}

/// Two laws driven along the same places have the same F_N and F_T, but for `tolerance`.
fn agree(ours: &[[f64; 2]], theirs: &[[f64; 2]], tolerance: f64) {
    for (place, (a, b)) in ours.iter().zip(theirs).enumerate() {
        for k in 0..2 {
            assert!((a[k] - b[k]).abs() < tolerance, "place {place}: {a:?} {b:?}");
        }
    }
}

fn material(modulus: f64, nu: f64, hardening: &str) -> String {
    format!("{{ youngs_modulus = {modulus:?}, poissons_ratio = {nu}, hardening = {{ {hardening} }} }}")
}

/// A table of two equal spheres of a material with the levels that `level` has.
fn table(material: &str, level: impl Fn(&ElasticSphere, f64) -> Level) -> Tabulated {
    let case = case(1.0, material, "opponent = { equal = true }", 0.01).scaled().0;
    let sphere = equivalent(&case);
    let levels: Vec<Level> = (0..16).map(|i| level(&sphere, 2e-5 * 1.75f64.powi(i))).collect();
    Tabulated {
        format: FORMAT.to_owned(),
        version: VERSION,
        body: Against::EqualSphere,
        frame: Some(Frame::LineOfCentres),
        program: "a test".to_owned(),
        case: case.to_toml(),
        range: Interval { from: levels[0].h, to: levels[15].h },
        elements_per_contact_radius: 8,
        levels,
        errors: Vec::new(),
    }
}

/// A made-up body that becomes plastic and loses F_N in shear, the more the deeper.
fn plastic(sphere: &ElasticSphere, h: f64) -> Level {
    let plasticity = ((h / 2e-5).ln() / 1000f64.ln()).clamp(0.0, 1.0);
    let fall = 0.3 * plasticity;
    let f_n0 = hertz::force(sphere, h) * (1.0 - 0.75 * plasticity);
    let a0 = (sphere.radius * h * (1.0 + plasticity)).sqrt();
    let n = 1.5 + 3.0 * plasticity;
    let k_t = 1.7 * sphere.effective_modulus() * a0;
    Level {
        yield_coefficient: None,
        h,
        f_n0,
        a0,
        slip_share: 1.0 - fall,
        delta_t_end: 2.0 * n * MU * f_n0 / k_t,
        unloading_radius: 1.05 * a0,
        k_t,
        backbone: 1.3,
        tangential: points().map(|x| 1.0 - (1.0 - (1.8 * x).min(1.0)).powf(n)).collect(),
        normal: points().map(|x| 1.0 - (1.0 - (1.8 * x).min(1.0)).powf(1.2 * n)).collect(),
    }
}

fn elastic(sphere: &ElasticSphere, h: f64) -> Level {
    hertzian(sphere, MU, h)
}

const IDEAL: &str = "law = \"ideal\", yield_stress = 400.0";
const ELASTIC: &str = "law = \"elastic\"";

#[test]
fn two_equal_bodies_are_their_own_table_at_any_radius() {
    let steel = material(200e3, 0.3, IDEAL);
    let table = table(&steel, plastic);
    for radius in [1.0, 3.0] {
        let pair = case(1.0, &steel, &format!("opponent = {{ radius = {radius:?} }}"), 0.02);
        let composed = compose(&pair, [&table, &table]).unwrap();
        assert_eq!(composed.body, Against::OtherSphere);
        let star = pair.effective_radius() / 0.5;
        let own = table.contact_parameters(star, 1.0).unwrap();
        let ours = composed.contact_parameters(1.0, 1.0).unwrap();
        // Deep contacts of unlike spheres hang on more than R*.
        for level in composed.levels.iter().filter(|level| radius == 1.0 || level.h < 3e-4) {
            let (one, other) = (own.virgin(level.h).point, ours.virgin(level.h).point);
            assert!((other.f_n0 / one.f_n0 - 1.0).abs() < 2e-4, "{one:?} {other:?}");
            assert!((other.a / one.a - 1.0).abs() < 2e-4, "{one:?} {other:?}");
            assert!((other.k_t / one.k_t - 1.0).abs() < 2e-3, "{one:?} {other:?}");
            assert!((other.f_n_slip / one.f_n_slip - 1.0).abs() < 2e-3, "{one:?} {other:?}");
            let end = one.delta_t_end;
            let places: Vec<[f64; 2]> = [0.0, 0.02, 0.1, 0.2, 0.4, 0.9].map(|x| [level.h, x * end]).to_vec();
            agree(&drive(&own, &places, 20), &drive(&ours, &places, 20), 6e-3 * one.f_n0);
        }
    }
}

#[test]
fn two_bodies_that_hardly_differ_are_as_two_alike() {
    let steel = material(200e3, 0.3, IDEAL);
    let (one, mut other) = (table(&steel, plastic), table(&steel, plastic));
    let pair = case(1.0, &steel, "opponent = { radius = 2.0 }", 0.02);
    let alike = compose(&pair, [&one, &one]).unwrap();
    // By a rounding, which is found by the roots of all pairs.
    other.levels[3].unloading_radius *= 1.0 + 1e-13;
    let hardly = compose(&pair, [&one, &other]).unwrap();
    let (one, other) = (alike.contact_parameters(1.0, 1.0).unwrap(), hardly.contact_parameters(1.0, 1.0).unwrap());
    for level in &alike.levels {
        let (point, end) = (one.virgin(level.h).point, level.delta_t_end);
        let places: Vec<[f64; 2]> = [0.0, 0.02, 0.1, 0.2, 0.4, 0.9].map(|x| [level.h, x * end]).to_vec();
        agree(&drive(&one, &places, 20), &drive(&other, &places, 20), 8e-3 * point.f_n0);
    }
}

/// c of an oblique press: of one body twice its own; of a pair without one of a body none; of a
/// body beside a stiffer one that hardly gives way nearly that of the first.
#[test]
fn how_bodies_yield_under_a_shear_is_in_series_too() {
    let (steel, hard) = (material(200e3, 0.3, IDEAL), material(2e7, 0.3, ELASTIC));
    let mut known = table(&steel, plastic);
    known.levels.iter_mut().for_each(|level| level.yield_coefficient = Some(4.0));
    let alike = case(1.0, &steel, "opponent = { radius = 2.0 }", 0.02);
    let composed = compose(&alike, [&known, &known]).unwrap();
    assert!(composed.levels.iter().all(|level| level.yield_coefficient.is_some_and(|c| (c / 4.0 - 1.0).abs() < 1e-9)));
    let unknown = table(&steel, plastic);
    let composed = compose(&alike, [&known, &unknown]).unwrap();
    assert!(composed.levels.iter().all(|level| level.yield_coefficient.is_none()));
    let stiff = case(1.0, &steel, &format!("opponent = {{ flat = true, material = {hard} }}"), 0.01);
    let composed = compose(&stiff, [&known, &table(&hard, elastic)]).unwrap();
    let deepest = composed.levels.last().and_then(|level| level.yield_coefficient);
    assert!(deepest.is_some_and(|c| (c / 4.0 - 1.0).abs() < 0.05), "{deepest:?}");
}

#[test]
fn elastic_bodies_are_hertz_and_cattaneo_and_mindlin() {
    let (steel, soft) = (material(200e3, 0.3, ELASTIC), material(70e3, 0.42, ELASTIC));
    let tables = [table(&steel, elastic), table(&soft, elastic)];
    for opponent in ["radius = 2.0", "flat = true"] {
        let pair = case(1.0, &steel, &format!("opponent = {{ {opponent}, material = {soft} }}"), 0.004);
        let composed = compose(&pair, [&tables[0], &tables[1]]).unwrap();
        let sphere = equivalent(&pair.scaled().0);
        for level in &composed.levels {
            let exact = CattaneoMindlin::at_indentation(sphere, MU, level.h);
            assert!((level.f_n0 / exact.normal_force - 1.0).abs() < 1e-9, "{level:?}");
            assert!((level.a0 / exact.contact_radius - 1.0).abs() < 1e-9, "{level:?}");
            assert!((level.unloading_radius / exact.contact_radius - 1.0).abs() < 1e-9, "{level:?}");
            assert!(
                (level.backbone - 1.5).abs() < 1e-9 && (level.slip_share - 1.0).abs() < 1e-9,
                "{} {}",
                level.backbone,
                level.slip_share
            );
            // Both slip where the other does, and the softer one moves more.
            for (j, f_t) in level.tangential.iter().enumerate() {
                let delta = ((j + 1) as f64 / POINTS as f64).powi(2) * level.delta_t_end;
                let force = exact.force(delta);
                assert!((f_t * MU * level.f_n0 - force).abs() < 3e-3 * MU * level.f_n0, "h {}: {f_t} {force}", level.h);
            }
        }
    }
}

#[test]
fn a_stiff_and_strong_opponent_leaves_all_of_h_and_of_the_flow_to_the_weak_one() {
    let (steel, hard) = (material(200e3, 0.3, IDEAL), material(200e9, 0.3, ELASTIC));
    let tables = [table(&steel, plastic), table(&hard, elastic)];
    let pair = case(1.0, &steel, &format!("opponent = {{ flat = true, material = {hard} }}"), 0.02);
    let composed = compose(&pair, [&tables[0], &tables[1]]).unwrap();
    let own = tables[0].contact_parameters(1.0, 1.0).unwrap();
    let ours = composed.contact_parameters(1.0, 1.0).unwrap();
    for level in &composed.levels {
        // Half of an equal pair of the same radius: half of its h and of its delta_T.
        let half = own.virgin(2.0 * level.h).point;
        assert!((level.f_n0 / half.f_n0 - 1.0).abs() < 1e-3, "{} {}", level.f_n0, half.f_n0);
        assert!((level.a0 / half.a - 1.0).abs() < 1e-2, "{} {}", level.a0, half.a);
        let places = [0.0, 0.02, 0.1, 0.2, 0.4, 0.9].map(|x| [level.h, 0.5 * x * half.delta_t_end]);
        let twice = places.map(|place| place.map(|x| 2.0 * x));
        agree(&drive(&own, &twice, 20), &drive(&ours, &places, 20), 1e-2 * half.f_n0);
    }
}

#[test]
fn a_strong_partner_of_the_same_stiffness_doubles_the_way_to_full_slip_of_the_weak_one() {
    // What F_N loses, the approaches of both lose, and one body alone creeps by it.
    let (weak, strong) = (material(200e3, 0.3, IDEAL), material(200e3, 0.3, ELASTIC));
    let tables = [table(&weak, plastic), table(&strong, elastic)];
    let pair = case(1.0, &weak, &format!("opponent = {{ radius = 1.0, material = {strong} }}"), 0.02);
    let composed = compose(&pair, [&tables[0], &tables[1]]).unwrap();
    let rigid = case(1.0, &weak, &format!("opponent = {{ flat = true, material = {} }}", material(200e9, 0.3, ELASTIC)), 0.02);
    let alone = compose(&rigid, [&tables[0], &table(&material(200e9, 0.3, ELASTIC), elastic)]).unwrap();
    let last = |table: &Tabulated| {
        let level = table.levels.last().unwrap();
        level.delta_t_end / level.a0 / level.slip_share
    };
    assert!(last(&composed) > 1.5 * last(&alone), "{} {}", last(&composed), last(&alone));
}

#[test]
fn which_body_is_called_the_sphere_makes_no_difference() {
    let (one, two) = (material(200e3, 0.3, IDEAL), material(70e3, 0.34, "law = \"ideal\", yield_stress = 300.0"));
    let tables = [table(&one, plastic), table(&two, plastic)];
    let pair =
        compose(&case(1.0, &one, &format!("opponent = {{ radius = 2.0, material = {two} }}"), 0.02), [&tables[0], &tables[1]]);
    let exchanged =
        compose(&case(2.0, &two, &format!("opponent = {{ radius = 1.0, material = {one} }}"), 0.02), [&tables[1], &tables[0]]);
    let (pair, exchanged) = (pair.unwrap(), exchanged.unwrap());
    // Lengths over 1 and 2, forces over 200e3 and 4 * 70e3.
    let force = 200.0 / (4.0 * 70.0);
    for (a, b) in pair.levels.iter().zip(&exchanged.levels) {
        assert!((0.5 * a.h / b.h - 1.0).abs() < 1e-9);
        assert!((force * a.f_n0 / b.f_n0 - 1.0).abs() < 1e-9 && (0.5 * a.a0 / b.a0 - 1.0).abs() < 1e-9, "{a:?} {b:?}");
        assert!((0.5 * a.delta_t_end / b.delta_t_end - 1.0).abs() < 1e-6, "{a:?} {b:?}");
        assert!(a.tangential.iter().zip(&b.tangential).all(|(x, y)| (x - y).abs() < 1e-6));
        assert!(a.normal.iter().zip(&b.normal).all(|(x, y)| (x - y).abs() < 1e-6));
    }
}

#[test]
fn what_the_tables_are_not_of_is_refused_by_name() {
    let (steel, soft) = (material(200e3, 0.3, IDEAL), material(70e3, 0.42, "law = \"ideal\", yield_stress = 100.0"));
    let (own, other) = (table(&steel, plastic), table(&soft, plastic));
    let opponent = format!("opponent = {{ radius = 2.0, material = {soft} }}");
    let pair = case(1.0, &steel, &opponent, 0.02);
    let told = |case: &Case, tables: [&Tabulated; 2]| compose(case, tables).unwrap_err().to_string();
    let exchanged = told(&pair, [&other, &own]);
    assert!(exchanged.contains("of the sphere, nu = 0.3, and the table is of nu = 0.42"), "{exchanged}");
    let wrong = told(&pair, [&own, &own]);
    assert!(wrong.contains("of the opponent, nu = 0.42"), "{wrong}");
    let slippery = Case { contact: crate::case::Contact { friction: Friction::Coefficient(0.2) }, ..pair.clone() };
    assert!(told(&slippery, [&own, &other]).contains("mu = 0.2, and the table is of mu = 0.3"));
    let deep = told(&case(1.0, &steel, &opponent, 0.15), [&own, &other]);
    assert!(deep.contains("ends at h/R = 8.8") && deep.contains("Tabulate it deeper"), "{deep}");
    assert!(told(&case(1.0, &steel, "", 0.02), [&own, &other]).contains("need an opponent that deforms"));
    let composed = compose(&pair, [&own, &other]).unwrap();
    assert!(told(&pair, [&composed, &other]).contains("says nothing of one of them"));
}

/// The pairs of the study that were set aside, from tables of their bodies and h alone: F_N0 within
/// 5 per cent rms, F_T along the shear within 5 per cent of its peak (fixtures/law/pairs).
#[test]
fn pairs_that_were_set_aside_are_predicted_from_h_alone() {
    let read = |text: &str| Tabulated::from_json(text).unwrap();
    let copper = read(include_str!("../../../../fixtures/law/pairs/copper.json"));
    let steel = read(include_str!("../../../../fixtures/law/pairs/steel.json"));
    let alloy = read(include_str!("../../../../fixtures/law/pairs/alloy.json"));
    let materials = [&copper, &steel, &alloy].map(|table| Case::parse(&table.case, "case", &[]).unwrap().material);
    let moduli = [120e3, 210e3, 200e3];
    // One body pressed on another three times as large, R* = 1.
    let pair = |one: usize, two: usize| {
        let mut case = case(4.0 / 3.0, &material(moduli[one], 0.3, IDEAL), "opponent = { radius = 4.0 }", 0.03);
        let of = |i: usize| Material {
            youngs_modulus: moduli[i],
            poissons_ratio: materials[i].poissons_ratio,
            hardening: materials[i].hardening.scaled(1.0 / moduli[i]),
        };
        case.material = of(one);
        case.opponent = Some(Opponent::Deforming { radius: Some(4.0), material: of(two) });
        case
    };
    let pairs =
        [(7, pair(1, 2), compose(&pair(1, 2), [&steel, &alloy])), (10, pair(0, 1), compose(&pair(0, 1), [&copper, &steel]))];
    let rows: Vec<Vec<f64>> = include_str!("../../../../fixtures/law/pairs/simulated.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|field| field.parse().unwrap()).collect())
        .collect();
    let (mut force_errors, mut curve_errors) = (Vec::new(), Vec::new());
    for (number, case, composed) in pairs {
        let parameters = composed.unwrap().contact_parameters(case.sphere.radius, case.material.youngs_modulus).unwrap();
        for h in [0.003, 0.01, 0.03] {
            let shear: Vec<&Vec<f64>> = rows.iter().filter(|row| row[0] == f64::from(number) && row[1] == h).collect();
            assert!(shear.len() > 8, "pair {number}, h {h}: {} steps", shear.len());
            let virgin = parameters.virgin(h).point;
            force_errors.push(virgin.f_n0 / shear[0][5] - 1.0);
            assert!((virgin.a / shear[0][2] - 1.0).abs() < 0.04, "pair {number}, h {h}: {} {}", virgin.a, shear[0][2]);
            let peak = shear.iter().map(|row| row[4]).fold(0.0, f64::max);
            let places: Vec<[f64; 2]> = std::iter::once([h, 0.0]).chain(shear.iter().map(|row| [h, row[3]])).collect();
            let along_axes = drive_centres(&parameters, Centres::of(&case), &places, 10);
            for (ours, row) in along_axes[1..].iter().zip(&shear) {
                curve_errors.push((ours[1] - row[4]) / peak);
            }
        }
    }
    let rms = |errors: &[f64]| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let (force, curve) = (rms(&force_errors), rms(&curve_errors));
    assert!(force < 0.05 && curve < 0.05, "F_N0 {force:.4}, F_T {curve:.4}: {force_errors:?}");
    assert!(curve_errors.iter().all(|e| e.abs() < 0.1), "{curve_errors:?}");
}
