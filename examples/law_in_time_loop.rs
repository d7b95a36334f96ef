//! A contact in a loop over time: a sphere hits a plane at an angle and bounces: `cargo
//! run --release --example law_in_time_loop`.
//!
//! The contact is the incremental update of the built-in law: an indentation and an increment along
//! the plane go in, forces come out, and the memory of the contact is one small struct.

use asperity::Case;
use asperity::contact_law::ContactState;
use asperity::law::LawFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let case = Case::load("fixtures/cases/ideal.toml".as_ref(), &[])?;
    let parameters = LawFile::built_in()?.contact_parameters(&case)?;

    // Units of the case: mm, N and s, and so tonnes. Rotation is left out.
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 7.8e-9;
    let step = 2e-8;
    let (mut velocity, mut h, mut state) = ([1000.0, 3000.0], 0.0, ContactState::default());
    let energy = |velocity: [f64; 2]| 0.5 * mass * (velocity[0] * velocity[0] + velocity[1] * velocity[1]);
    let before = energy(velocity);
    let mut time = 0.0;
    loop {
        h += velocity[1] * step;
        let (next, forces) = parameters.update(&state, h, [velocity[0] * step, 0.0]);
        state = next;
        velocity[0] -= forces.f_t[0] / mass * step;
        velocity[1] -= forces.f_n / mass * step;
        time += step;
        if forces.f_n == 0.0 && velocity[1] < 0.0 {
            break;
        }
    }
    println!("in contact for {:.2e} s, indented to {:.4}", time, state.h_max);
    println!("velocity along the plane {:.0}, away from it {:.0}", velocity[0], -velocity[1]);
    println!("coefficient of restitution {:.3}, energy left {:.3}", -velocity[1] / 3000.0, energy(velocity) / before);
    Ok(())
}
