//! The paths of the test vectors: random legs of one contact and what the Rust update answers.

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::contact_law::{ContactParameters, ContactState};
use crate::random::Seeded;

/// Legs of a path.
const LEGS: usize = 10;
/// Steps of a leg.
const STEPS: usize = 60;

/// The columns: the path (a new number is a new contact), its material with the numbers of the
/// hardening law in the exports' order, R, mu, the indentation to go to, the tangential increment,
/// the axes' turn before it; then the answer, and last the state's x for information (near 1 it
/// hangs on the last digits of F_N, which hangs on x least there).
pub(crate) const COLUMNS: &str = "path,E,nu,hardening,stress,second,third,R,mu,h,d0,d1,cosine,sine,\
                           f_n,f_t0,f_t1,k00,k01,k10,k11,kn,kn0,kn1,kh0,kh1,a,energy,worn";

/// What a path is of.
pub(crate) struct Contact {
    /// E.
    pub(crate) e: f64,
    /// nu.
    pub(crate) nu: f64,
    /// The number of its hardening law.
    pub(crate) kind: usize,
    /// The numbers of that.
    pub(crate) numbers: [f64; 3],
    /// R.
    pub(crate) radius: f64,
    /// The update's parameters.
    pub(crate) pair: ContactParameters,
}

/// Writes the steps of one path that goes to about `deepest`.
pub(crate) fn write_steps(path: usize, contact: &Contact, deepest: f64, random: &mut Seeded, text: &mut String) {
    let &Contact { e, nu, kind, numbers, radius, ref pair } = contact;
    let friction = pair.friction;
    let slip = pair.virgin(deepest).point.delta_t_end;
    let depth = pair.virgin(deepest).depth;
    let mut state = ContactState::default();
    let (mut h, mut d) = (-0.01 * deepest, [0.0; 2]);
    for leg in 0..LEGS {
        let from = (h, d);
        let mut to = from;
        let choice = random.between(0.0, 1.0);
        if leg == 0 {
            to.0 = 0.7 * deepest;
        } else if choice < 0.35 {
            to.0 = state.h_max - depth * random.between(-0.3, 1.2);
        } else if choice < 0.5 {
            to.0 = state.h_max * random.between(1.0, 1.3);
        }
        if leg > 0 && choice > 0.2 {
            let (angle, size) = (random.between(0.0, TAU), slip * random.between(0.05, 2.0));
            to.1 = [size * angle.cos(), size * angle.sin()];
        }
        let turn = if choice > 0.8 { random.between(-0.1, 0.1) } else { 0.0 };
        for k in 1..=STEPS {
            let share = k as f64 / STEPS as f64;
            h = from.0 + (to.0 - from.0) * share;
            let target: [f64; 2] = std::array::from_fn(|i| from.1[i] + (to.1[i] - from.1[i]) * share);
            let increment = [target[0] - d[0], target[1] - d[1]];
            d = target;
            let (cosine, sine) = (turn.cos(), turn.sin());
            state.rotate(cosine, sine);
            let (next, out) = pair.update(&state, h, increment);
            state = next;
            let [s0, s1, s2] = numbers;
            let [[k00, k01], [k10, k11]] = out.df_t_ddelta;
            // Writing to a String cannot fail.
            let _ = write!(text, "{path},{e:?},{nu:?},{kind},{s0:?},{s1:?},{s2:?},{radius:?},{friction:?}");
            for value in [
                h,
                increment[0],
                increment[1],
                cosine,
                sine,
                out.f_n,
                out.f_t[0],
                out.f_t[1],
                k00,
                k01,
                k10,
                k11,
                out.df_n_dh,
                out.df_n_ddelta[0],
                out.df_n_ddelta[1],
                out.df_t_dh[0],
                out.df_t_dh[1],
                out.a,
                pair.stored_energy(&state),
                state.worn,
            ] {
                let _ = write!(text, ",{value:?}");
            }
            text.push('\n');
        }
    }
}
