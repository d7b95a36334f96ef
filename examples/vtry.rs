use asperity::compute::{Compute, cpu::Cpu};
use asperity::verify::*;
fn main() {
    env_logger::init();
    let args: Vec<String> = std::env::args().skip(1).collect();
    let level = if args.iter().any(|a| a == "fine") { Level::Fine } else { Level::Quick };
    let mut make = |models| Ok(Box::new(Cpu::<f64>::new(models)?) as Box<dyn Compute>);
    let mut runner = Runner::new(&mut make, level);
    for family in FAMILIES.iter().filter(|f| args.is_empty() || args.iter().any(|a| a == f.name)) {
        let r = family.run(&mut runner).unwrap();
        println!("{}: {:.1} s\n{}", r.name, r.took.as_secs_f64(), table::table(&r.checks));
    }
}
