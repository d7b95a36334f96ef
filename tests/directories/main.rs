//! Where results go: who may write to a directory, what is never replaced there, and what is made
//! of results that were damaged; every command of the program by the same rules.

#[path = "../common/mod.rs"]
mod common;
mod every_command;
mod locks;
mod quoting;
mod study;
