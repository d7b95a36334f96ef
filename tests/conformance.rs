//! One body for every backend: CPU f64, CPU f32, GPU f64, GPU f32.
//!
//! The reference is the CPU in f64, fed with what the backend under test was fed with after
//! rounding. Each backend has to stay within its bound of the reference *and* to obey the equations
//! by itself, so that a fault shared with the reference shows too.

#[path = "conformance/assembly.rs"]
mod assembly;
#[path = "conformance/batch.rs"]
mod batch;
#[path = "conformance/contact.rs"]
mod contact;
#[path = "conformance/element.rs"]
mod element;
#[path = "conformance/iterate.rs"]
mod iterate;
#[path = "conformance/kernels.rs"]
mod kernels;
#[path = "conformance/linear.rs"]
mod linear;
#[path = "conformance/material.rs"]
mod material;
#[path = "conformance/memory.rs"]
mod memory;
#[path = "conformance/press.rs"]
mod press;

mod device;

/// Instantiates a body, `fn body<R, B: Backend<R>>(backend: &B)`, for the four backends.
macro_rules! for_every_backend {
    ($($body:ident),+ $(,)?) => {
        mod cpu_f64 {
            $(#[test] fn $body() { super::$body::<f64, _>(&super::Cpu, &super::Bounds::F64); })+
        }
        mod cpu_f32 {
            $(#[test] fn $body() { super::$body::<f32, _>(&super::Cpu, &super::Bounds::F32); })+
        }
        mod gpu_f64 {
            $(#[test] fn $body() {
                let context = crate::device::device(stringify!($body), asperity::internals::compute::gpu::Precision::F64);
                let Some(context) = context else { return };
                super::$body::<f64, _>(&super::Gpu(context), &super::Bounds::F64);
            })+
        }
        mod gpu_f32 {
            $(#[test] fn $body() {
                let context = crate::device::device(stringify!($body), asperity::internals::compute::gpu::Precision::F32);
                let Some(context) = context else { return };
                super::$body::<f32, _>(&super::Gpu(context), &super::Bounds::F32);
            })+
        }
    };
}
pub(crate) use for_every_backend;
