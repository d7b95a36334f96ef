//! The device layer on a device: round trips, limits, and above all that nothing stale is ever
//! handed on.

mod device;

use asperity::case::Case;
use asperity::internals::bench::input;
use asperity::internals::bench::traffic::Sizes;
use asperity::internals::compute::Compute;
use asperity::internals::compute::gpu::adapters::adapters;
use asperity::internals::compute::gpu::arguments::Argument;
use asperity::internals::compute::gpu::error::ArgumentFlaw;
use asperity::internals::compute::gpu::layout;
use asperity::internals::compute::gpu::linear::parts::SolvePart;
use asperity::internals::compute::gpu::material::{self, Answers};
use asperity::internals::compute::gpu::report::{Surroundings, report};
use asperity::internals::compute::gpu::source::{Precision, ShaderSource};
use asperity::internals::compute::gpu::{DeviceRequest, Evaluation, Gpu, GpuContext, GpuError, Kernel, KernelTimes};
use asperity::internals::compute::traffic::Traffic;
use asperity::internals::simulation::drive::{Drive, Ending, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::material::{Elasticity, FlowStress, Material};
use device::device;
use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

static DOUBLE: Kernel = Kernel::new(
    "double",
    &[ShaderSource {
        path: "tests/device_layer.rs",
        text: "
@group(0) @binding(0) var<storage, read_write> values: array<real>;
@compute @workgroup_size(64)
fn double(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&values) {
        values[id.x] = 2.0 * values[id.x];
    }
}
",
    }],
);

fn double(context: &GpuContext, start: &[f32], times: usize) -> Result<Vec<f32>, GpuError> {
    let values = context.array("values", start)?;
    let bound = context.bind(&DOUBLE, Precision::F32, &[values.named("values")])?;
    let mut list = context.record();
    for _ in 0..times {
        list.dispatch(&bound, start.len(), 1)?;
    }
    list.submit()?;
    context.download(&values)
}

#[test]
fn kernels_of_a_list_run_in_order_and_come_back() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    for n in [1, 2, 63, 64, 65, 1000, 100_003] {
        let start: Vec<f32> = (0..n).map(|i| i as f32).collect();
        let expected: Vec<f32> = start.iter().map(|x| 32.0 * x).collect();
        assert_eq!(double(&context, &start, 5).unwrap(), expected);
    }
}

/// As a driver that gives a device up after two seconds needs it. The first list goes whole, as
/// nothing is known before it; the account has it as one submission, like the others.
#[test]
fn a_list_after_a_slow_one_goes_in_pieces_with_the_same_numbers() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let context = context.with_longest_submission(Duration::ZERO);
    let values = context.array("values", &[1.0f32; 1000]).unwrap();
    let bound = context.bind(&DOUBLE, Precision::F32, &[values.named("values")]).unwrap();
    let before = context.traffic();
    for (lists, ahead) in [(1, 0), (2, 4), (3, 8)] {
        let mut list = context.record();
        for _ in 0..5 {
            list.dispatch(&bound, 1000, 1).unwrap();
        }
        // Comes before all of the list, however many pieces that has.
        context.upload(&values, &[3.0; 1000]).unwrap();
        let mut out = [0.0; 1000];
        list.submit_and_read(&mut [values.read(0, &mut out).unwrap()]).unwrap();
        assert_eq!(out, [96.0; 1000]);
        assert_eq!((context.pieces_sent_ahead(), (context.traffic() - before).submissions), (ahead, lists));
    }
    let context = context.with_longest_submission(Duration::from_secs(1000));
    assert_eq!(double(&context, &[1.0; 10], 5).unwrap(), [32.0; 10]);
    assert_eq!(context.pieces_sent_ahead(), 0);
}

/// Of the account that `summary.json` has: every transfer comes with a ticket of eight bytes, by
/// which it is known to be fresh.
#[test]
fn what_passes_to_the_device_and_back_is_counted() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let before = context.traffic();
    double(&context, &[1.0; 1000], 5).unwrap();
    let expected = Traffic { dispatches: 5, submissions: 2, waits: 1, bytes_up: 4008, bytes_down: 4008 };
    assert_eq!(context.traffic() - before, expected);
    double(&context, &[1.0; 1000], 0).unwrap();
    let nothing_run = Traffic { submissions: 1, dispatches: 0, ..expected };
    assert_eq!(context.traffic() - before, expected + nothing_run);
}

#[test]
fn parts_of_arrays_and_empty_ones() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let values = context.array("values", &[1u32, 2, 3, 4, 5, 6, 7]).unwrap();
    context.upload_at(&values, 2, &[30, 40]).unwrap();
    let mut part = [0u32; 3];
    context.download_at(&values, 3, &mut part).unwrap();
    assert_eq!(part, [40, 5, 6]);
    assert_eq!(context.download(&values).unwrap(), [1, 2, 30, 40, 5, 6, 7]);
    assert!(matches!(context.upload_at(&values, 6, &[1, 2]), Err(GpuError::Length { expected: 7, given: 8, .. })));
    assert!(matches!(context.download_at(&values, 5, &mut part), Err(GpuError::Length { .. })));
    let empty = context.zeros::<f32>("nothing", 0).unwrap();
    assert!(empty.is_empty());
    assert!(context.download(&empty).unwrap().is_empty());
    // larger than one piece of an upload
    let long: Vec<u32> = (0..20_000_000).collect();
    let buffer = context.array("long", &long).unwrap();
    assert!(context.download(&buffer).unwrap() == long);
}

/// After a loss submissions do nothing and buffers keep old numbers: no call may pretend otherwise.
#[test]
fn a_lost_device_hands_out_nothing() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let values = context.array("values", &[1.0f32; 100]).unwrap();
    let bound = context.bind(&DOUBLE, Precision::F32, &[values.named("values")]).unwrap();
    assert_eq!(context.download(&values).unwrap(), [1.0; 100]);
    let mut list = context.record();
    list.dispatch(&bound, 100, 1).unwrap();
    context.destroy();
    let submitted = list.submit();
    let downloaded = context.download(&values);
    assert!(downloaded.is_err(), "submitted {submitted:?}, downloaded {downloaded:?}");
    assert!(context.check().is_err() && context.upload(&values, &[2.0; 100]).is_err());
    assert!(context.zeros::<f32>("more", 10).is_err() && double(&context, &[1.0], 1).is_err());
}

#[test]
fn what_does_not_fit_is_refused_before_it_is_tried() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let limit = context.adapter().max_binding.min(context.adapter().max_buffer);
    let error = context.zeros::<f32>("everything", limit as usize / 4 + 4).unwrap_err();
    assert!(matches!(error, GpuError::TooLarge { .. }), "{error}");
    let (used, total) = (context.budget().used(), context.budget().limit());
    assert_eq!(used, 0);
    let piece = limit.min(64 << 20);
    let mut held = Vec::new();
    let refused = loop {
        match context.zeros::<f32>("a piece", piece as usize / 4) {
            Ok(buffer) => held.push(buffer),
            Err(error) => break error,
        }
        assert!(held.len() as u64 <= total / piece);
    };
    assert!(matches!(refused, GpuError::OutOfBudget { .. }), "{refused}");
    assert_eq!(held.len() as u64, total / piece);
    drop(held);
    assert_eq!(context.budget().used(), 0);
    context.check().unwrap();
}

#[test]
fn a_fault_of_the_program_is_an_error_with_its_place() {
    static BROKEN: Kernel = Kernel::new(
        "broken",
        &[ShaderSource {
            path: "shaders/broken.wgsl",
            text: "@compute @workgroup_size(1)\nfn broken() {\n    let a: real = 1u;\n}\n",
        }],
    );
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let error = context.pipeline(&BROKEN, Precision::F32).unwrap_err();
    assert!(matches!(&error, GpuError::Shader { place, .. } if place == "shaders/broken.wgsl:3"), "{error}");
    // an argument that is missing, unknown or there twice, and one of the wrong kind
    let values = context.array("values", &[1.0f32]).unwrap();
    let block = context.block::<[f32; 4]>("block").unwrap();
    let bind = |arguments: &[Argument<'_>]| context.bind(&DOUBLE, Precision::F32, arguments).map(drop).unwrap_err();
    let flawed = |name: &str, flaw| GpuError::Argument { kernel: "double", name: name.to_owned(), flaw };
    assert_eq!(bind(&[]), flawed("values", ArgumentFlaw::Missing));
    let [right, other] = ["values", "value"].map(|name| values.named(name));
    assert_eq!(bind(&[right.clone(), other]), flawed("value", ArgumentFlaw::Unknown));
    assert_eq!(bind(&[right.clone(), right]), flawed("values", ArgumentFlaw::Doubled));
    assert!(matches!(bind(&[block.named("values")]), GpuError::Rejected { .. }));
    // none of this harms the device
    assert_eq!(double(&context, &[3.0], 1).unwrap(), [6.0]);
}

#[test]
fn chunks_give_the_same_bits_as_one_piece() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let context = context.with_budget(4 << 20);
    let material = |yield_stress: f64| Material::<f32> {
        elasticity: Elasticity::new(1.0, 0.3),
        hardening: FlowStress::linear(yield_stress, 0.1).unwrap(),
    };
    let points = 1000;
    let materials: Vec<_> = (1..=40).map(|i| material(1e-3 * f64::from(i))).collect();
    let value = |i: usize| ((i * 7919) % 1009) as f32 * 2e-5 - 1e-2;
    let relative: Vec<f32> = (0..materials.len() * layout::RELATIVE * points).map(value).collect();
    let committed = vec![0.0f32; materials.len() * layout::STATE * points];
    // 20 MB in all, in 4 MiB
    assert!(material::ReturnMapping::new(&context, &materials, points).is_err());
    let chunked = material::return_mapping(&context, &materials, points, &relative, &committed).unwrap();
    for case in [0, 17, 39] {
        let part = |data: &[f32], components: usize| data[case * components * points..][..components * points].to_vec();
        let (relative, committed) = (part(&relative, layout::RELATIVE), part(&committed, layout::STATE));
        let alone = material::return_mapping(&context, &materials[case..=case], points, &relative, &committed).unwrap();
        let expected = Answers {
            answer: part(&chunked.answer, layout::ANSWER),
            tangent: part(&chunked.tangent, layout::TANGENT),
            status: chunked.status[case * points..][..points].to_vec(),
        };
        assert!(alone == expected, "case {case}");
    }
}

/// Each has its own staging buffer and counters, and hears of its own numbers alone, whichever
/// thread the driver tells.
#[test]
fn parts_of_a_device_are_used_side_by_side() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let work = |thread: usize| {
        let part = context.part(8 << 20);
        for round in 0..100 {
            let numbers: Vec<f32> = (0..64).map(|i| (1000 * thread + 64 * round + i) as f32).collect();
            let twice: Vec<f32> = numbers.iter().map(|x| 2.0 * x).collect();
            assert_eq!(double(&part, &numbers, 1).unwrap(), twice, "thread {thread}, round {round}");
        }
        (part.traffic(), part.budget().used())
    };
    let work = &work;
    let counted: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..3).map(|thread| scope.spawn(move || work(thread))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert!(counted.iter().all(|of_part| *of_part == counted[0] && of_part.0.waits >= 100), "{counted:?}");
    assert!(context.traffic().waits == 0 && context.check().is_ok());
}

/// Release builds compile without bounds checks.
#[test]
fn bounds_checks_do_not_change_a_bit() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let laws = [
        FlowStress::power(1e-3, 0.1, 0.3),
        FlowStress::hollomon(0.01, 5.0, 1.0),
        FlowStress::table(&[[0.0, 1e-3], [0.01, 2e-3]]),
    ];
    let materials = laws.map(|law| Material::<f32> { elasticity: Elasticity::new(1.0, 0.3), hardening: law.unwrap() });
    let points = 100;
    let relative: Vec<f32> = (0..3 * layout::RELATIVE * points).map(|i| ((i * 7919) % 1009) as f32 * 2e-5 - 1e-2).collect();
    let committed = vec![0.0f32; 3 * layout::STATE * points];
    let map = |context: &GpuContext| material::return_mapping(context, &materials, points, &relative, &committed).unwrap();
    let context = context.with_checks(true);
    let checked = map(&context);
    let trusted = map(&context.with_checks(false));
    assert!(checked == trusted);
}

#[test]
fn only_the_active_cases_are_touched() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let material = Material::<f32> { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::ideal(1e-3).unwrap() };
    let kernel = material::ReturnMapping::new(&context, &vec![material; 3], 2).unwrap();
    let committed = [0.0f32; 3 * 2 * layout::STATE];
    let relative = |size: f32| (0..3 * 2 * layout::RELATIVE).map(|i| size * (i % 7) as f32).collect::<Vec<_>>();
    let first = kernel.run(&context, &[0, 1, 2], &relative(1e-4), &committed).unwrap();
    let second = kernel.run(&context, &[2, 0], &relative(2e-4), &committed).unwrap();
    let case = |a: &Answers<f32>, c: usize| a.answer[c * 2 * layout::ANSWER..][..2 * layout::ANSWER].to_vec();
    assert_eq!(case(&first, 1), case(&second, 1));
    assert!(case(&first, 0) != case(&second, 0) && case(&first, 2) != case(&second, 2));
    assert!(matches!(kernel.run(&context, &[3], &relative(0.0), &committed), Err(GpuError::Length { .. })));
}

fn dispatches(times: &KernelTimes) -> u64 {
    times.kernels.iter().map(|kernel| kernel.dispatches).sum()
}

/// More dispatches than a set of timestamps holds, in one list and with lists that nobody waits
/// for.
#[test]
fn a_profile_has_every_dispatch() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    assert!(context.kernel_times().is_none());
    let adapter = context.adapter().clone();
    let start = [1.0f32; 1000];
    let plain = context.traffic();
    let expected = double(&context, &start, 5).unwrap();
    let plain = context.traffic() - plain;
    let context = context.with_profile();
    let begun = Instant::now();
    assert_eq!(double(&context, &start, 5).unwrap(), expected);
    // What a profile reads is not in the account of the program's own traffic.
    assert_eq!(context.traffic() - plain, plain);
    let times = context.kernel_times().unwrap();
    assert_eq!((times.timed, dispatches(&times), times.kernels.len()), (adapter.timestamps, 5, 1));
    // `double` makes arrays of which nothing is declared.
    assert_eq!((times.kernels[0].kernel, times.kernels[0].bytes), ("double", Some(0)));

    let part = context.part(1 << 20);
    let values = part.array("values", &start).unwrap().whole();
    let bound = part.bind(&DOUBLE, Precision::F32, &[values.named("values")]).unwrap();
    let mut list = part.record();
    list.count_for(Some(0));
    list.dispatch(&bound, start.len(), 1).unwrap();
    list.submit().unwrap();
    let mut list = part.record();
    for _ in 0..5000 {
        list.dispatch(&bound, start.len(), 1).unwrap();
    }
    list.submit().unwrap();
    assert_eq!(context.kernel_times().unwrap().unread, if adapter.timestamps { 5001 } else { 0 });
    part.download(&values).unwrap();
    let wall = begun.elapsed().as_secs_f64();
    let times = context.kernel_times().unwrap();
    assert_eq!((dispatches(&times), times.unread, part.traffic().dispatches), (5006, 0, 5001));
    // Read and written, but where it was said that nobody counts.
    assert_eq!(times.kernels[0].bytes, Some(5000 * 2 * 4000));
    let seconds = times.kernels[0].seconds;
    eprintln!("{seconds} s of {wall} s, {} without", times.unusable);
    assert!(!times.timed || (seconds > 0.0 && seconds <= wall && times.unusable < 5006), "{times:?}");
}

#[test]
fn a_device_without_timestamps_has_no_times() {
    let Some(context) = device("device_layer", Precision::F32) else { return };
    let context = context.without_timestamps().with_profile();
    assert_eq!(double(&context, &[1.0; 100], 3).unwrap(), [8.0; 100]);
    let times = context.kernel_times().unwrap();
    assert_eq!((times.timed, times.unusable, times.unread, dispatches(&times)), (false, 0, 0, 3));
    assert_eq!(times.kernels[0].seconds, 0.0);
}

/// Keeps displacements and what is recorded, bit by bit, and sums Krylov iterations.
#[derive(Default)]
struct Bits(Vec<u64>, usize);

impl Observer for Bits {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        let r = view.record.0;
        self.0.extend([r.h, r.f_n, r.f_t, r.a, r.merit, r.energy_elastic, r.work_plastic].map(f64::to_bits));
        self.1 += r.krylov_iterations;
        self.0.extend(view.displacement()?.iter().map(|u| u.to_bits()));
        Ok(())
    }

    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }

    fn note(&mut self, _: &str) {}

    fn stop_requested(&self) -> bool {
        false
    }
}

/// Whole paths, one of which holds a force, with a profile and without, and in pieces of one kernel
/// each: the same bits and, with a profile, the same traffic; every kernel has its time, and all of
/// them no more than the run.
#[test]
fn neither_a_profile_nor_pieces_change_a_bit_of_a_run() {
    let Some(_) = device("device_layer", Precision::F64) else { return };
    for name in ["ideal", "normal-force"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/cases/{name}.toml"));
        let set = ["mesh.elements_per_contact_radius=4", "solver.press_steps=3", "solver.shear_steps=2"].map(String::from);
        let problem = Problem::new(&Case::load(&file, &set).unwrap()).unwrap();
        let run = |context: GpuContext| {
            let (context, mut bits) = (Arc::new(context), Bits::default());
            let begun = Instant::now();
            let mut gpu = Gpu::<f64>::with_tangents_in_single(context.clone(), vec![problem.model.clone()]).unwrap();
            let ending = Drive::new(&problem, &mut gpu, 0, problem.newton().unwrap()).run(&mut bits).unwrap();
            assert!(matches!(ending, Ending::Done), "{name}: {ending:?}");
            let product = gpu.solver().unwrap().account(SolvePart::Product);
            let product = bits.1 * 4 * (product.numbers + product.shared);
            let cost = (begun.elapsed().as_secs_f64(), product as u64, context.pieces_sent_ahead());
            (bits.0, gpu.about().traffic.unwrap(), context.kernel_times(), cost)
        };
        let open = || GpuContext::open(DeviceRequest::Gpu).unwrap().unwrap();
        let (bits, traffic, nothing, _) = run(open());
        assert!(nothing.is_none() && bits.len() > 1000);
        let (cut, .., (_, _, ahead)) = run(open().with_longest_submission(Duration::ZERO));
        assert!(cut == bits && ahead > traffic.submissions, "{name}: other bits in {ahead} pieces");
        let (again, profiled, times, (wall, product, _)) = run(open().with_profile());
        assert!(again == bits, "{name}: other bits with a profile");
        assert_eq!(profiled, traffic, "{name}");
        let times = times.unwrap();
        assert_eq!((dispatches(&times), times.unread), (traffic.dispatches, 0), "{name}");
        if !times.timed {
            #[allow(clippy::explicit_write)] // the print macros are captured
            writeln!(std::io::stderr(), "SKIPPED: no timestamps (times of {name})").unwrap();
            continue;
        }
        assert_eq!(times.unusable, 0, "{name}");
        let all: f64 = times.kernels.iter().map(|kernel| kernel.seconds).sum();
        eprintln!("{name}: {all:.2} s of {:.2} s, {wall:.2} s with what came before", times.span);
        assert!(all <= times.span && times.span <= wall, "{name}: {all} s in {} s of {wall} s", times.span);
        for kernel in &times.kernels {
            assert!(kernel.seconds > 0.0, "{name}: {kernel:?}");
            assert!(kernel.bytes != Some(0), "{name}: {kernel:?}");
        }
        let bytes = |kernel: &str| times.kernels.iter().find(|k| k.kernel == kernel).unwrap().bytes.unwrap();
        // Of every Krylov iteration that ran the product with the finest matrix, and not of those
        // that were sent and left out. Where a force is held there are the responses too.
        eprintln!("{name}: {} bytes in products, {product} in those of recorded iterations", bytes("krylov_product"));
        assert!(if name == "ideal" { bytes("krylov_product") == product } else { bytes("krylov_product") >= product });
    }
}

/// The bytes of the element's kernels are those that `asperity bench` counts for its evaluations.
#[test]
fn a_profile_counts_bytes_as_the_bench_does() {
    let Some(context) = device("device_layer", Precision::F64) else { return };
    let context = Arc::new(context.with_profile());
    let mesh = input::mesh(4).unwrap();
    let gpu = Gpu::<f64>::new(context.clone(), input::models(&mesh, 1).unwrap()).unwrap();
    let bytes = || context.kernel_times().unwrap().kernels.iter().filter_map(|kernel| kernel.bytes).sum::<u64>();
    // A list of starts has one more, which the bench leaves out.
    for (evaluation, more) in [(Evaluation::InternalForce, 4), (Evaluation::Tangent, 4), (Evaluation::Update, 0)] {
        let before = bytes();
        gpu.repeat(evaluation, &[0], 2).unwrap();
        let expected = 2 * (Sizes::of(&mesh).on_device(evaluation, 8) as u64 + more);
        assert_eq!(bytes() - before, expected, "{evaluation:?}");
    }
}

/// Runs one of the tests below in a process with another environment.
fn in_process(test: &str, environment: &[(&str, &str)]) {
    let mut child = Command::new(std::env::current_exe().unwrap());
    child.args(["--exact", test, "--nocapture"]).env("ASPERITY_CHILD", "1").envs(environment.iter().copied());
    let output = child.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && text.contains("child: done"), "{text}");
}

fn is_child() -> bool {
    std::env::var_os("ASPERITY_CHILD").is_some()
}

/// `VK_DRIVER_FILES` is how the Vulkan loader is told that there is no driver.
#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_the_cpu_is_chosen_and_gpu_is_one_clear_error() {
    if !is_child() {
        let name = "without_a_driver_the_cpu_is_chosen_and_gpu_is_one_clear_error";
        let nothing = [("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null"), ("ASPERITY_ADAPTER", "")];
        return in_process(name, &nothing);
    }
    assert!(GpuContext::open(DeviceRequest::Auto).unwrap().is_none());
    let error = GpuContext::open(DeviceRequest::Gpu).unwrap_err();
    assert_eq!(error, GpuError::NoAdapter);
    assert!(report(&adapters(), &Surroundings::default()).contains("No GPU adapter"));
    println!("child: done");
}

#[test]
fn an_adapter_is_taken_by_name_or_not_at_all() {
    if is_child() {
        let wanted = std::env::var("ASPERITY_ADAPTER").unwrap();
        match GpuContext::open(DeviceRequest::Auto) {
            Ok(Some(context)) => assert!(context.adapter().name.contains(&wanted)),
            Ok(None) => panic!("a named adapter is not optional"),
            Err(e) => assert!(matches!(e, GpuError::NoSuchAdapter { .. }) && wanted == "no such adapter", "{e}"),
        }
        println!("child: done");
        return;
    }
    let name = "an_adapter_is_taken_by_name_or_not_at_all";
    in_process(name, &[("ASPERITY_ADAPTER", "no such adapter")]);
    let Some(context) = device(name, Precision::F32) else { return };
    in_process(name, &[("ASPERITY_ADAPTER", &context.adapter().name)]);
}
