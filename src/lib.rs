//! Asperity: force-displacement laws for elastic-plastic spheres sheared along a rigid plane. The plane stands for a second, equal sphere only without
//! friction.
//!
//! The rooms, from the kernels up; each knows only those named before it:
//! `analytical` (closed forms), `case` (the case file), `mesh`, `material`, `element`, `contact`, `compute` (one trait, CPU and
//! GPU behind it), `linalg`, `solver`, `simulation`, `output`, `law`, `study`, `verify` (closed-form checks), `bench` (rates), `cli`. ARCHITECTURE.md follows one case through them.

pub mod analytical;
pub mod bench;
pub mod bounded;
pub mod case;
pub mod cli;
pub mod compute;
pub mod contact;
pub mod element;
pub mod lanes;
pub mod law;
pub mod linalg;
pub mod material;
pub mod mesh;
pub mod output;
pub mod real;
pub mod simulation;
pub mod solver;
pub mod study;
pub mod verify;
