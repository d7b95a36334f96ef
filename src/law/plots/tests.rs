use super::*;
use crate::law::formulas::tests::elastic_sample;
use crate::law::variables::Variables;

/// Pictures of elastic cases alone: no Lambda, no fall, and nothing that stops.
#[test]
fn a_study_without_plasticity_has_few_pictures() {
    let data = StudyData { samples: vec![elastic_sample(0.1), elastic_sample(0.3)], skipped: Vec::new() };
    let names = |contacts: &[NormalContact], data: &StudyData| -> Vec<&str> {
        study_pictures(contacts, data, None, Default::default()).unwrap().iter().map(|picture| picture.name).collect()
    };
    let sample = &data.samples[0];
    let contact = NormalContact {
        variables: sample.variables,
        hardening_exponent: 0.0,
        relative_indentation: sample.h0,
        relative_radius: sample.a0,
        poissons_ratio: 0.3,
    };
    assert_eq!(names(&[contact], &data), ["collapse-tangential"]);
    let plastic = NormalContact { variables: Variables { lambda: 40.0, hardness: 2.6, ..sample.variables }, ..contact };
    assert_eq!(names(&[contact, plastic], &data), ["johnson", "area", "collapse-tangential"]);
    assert!(names(&[], &StudyData { samples: Vec::new(), skipped: Vec::new() }).is_empty());
}
