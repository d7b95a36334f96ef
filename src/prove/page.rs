//! A report as a Markdown page, to be pasted where people read.

use std::fmt::Write;

use serde_json::Value;

use super::{Jobs, ProofReport};
use crate::bench::whole_job::WholeJob;
use crate::output::in_words;

/// The page.
pub fn page(report: &ProofReport) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_page(&mut text, report);
    text
}

fn word<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or("unknown")
}

fn write_page(text: &mut String, report: &ProofReport) -> std::fmt::Result {
    let a = &report.adapter;
    writeln!(text, "# asperity prove: {}\n", word(a, "name"))?;
    let how = if report.quick { ", the quick run" } else { "" };
    if report.agrees() {
        writeln!(text, "**Everything that was compared agrees with the CPU**{how}.\n")?;
    } else {
        writeln!(text, "**This disagrees with the CPU**{how}:\n")?;
        report.disagreements.iter().try_for_each(|line| writeln!(text, "- {line}"))?;
        writeln!(text)?;
    }
    if !report.left_out.is_empty() {
        writeln!(text, "The quick run leaves something out. {}\n", report.left_out.join(" "))?;
    }
    if report.software {
        writeln!(text, "A software driver: its times are no measure of any GPU.\n")?;
    }
    writeln!(text, "| | |\n|---|---|")?;
    writeln!(text, "| adapter | {}, {} |", word(a, "name"), word(a, "type"))?;
    writeln!(text, "| driver | {}, {} |", word(a, "backend"), word(a, "driver"))?;
    writeln!(text, "| double precision | {} |", if a["double_precision"] == true { "yes" } else { "no" })?;
    writeln!(text, "| beside it | {}, {} threads, {} |", report.processor, report.threads, report.system)?;
    writeln!(text, "| asperity | {} |", report.version)?;
    write_needs(text, report)?;
    write_kernels(text, report)?;
    write_parity(text, report)?;
    write_times(text, report)?;
    report.jobs.iter().try_for_each(|jobs| write_jobs(text, jobs))
}

fn write_needs(text: &mut String, report: &ProofReport) -> std::fmt::Result {
    const HAS: [&str; 5] =
        ["max_storage_buffers", "max_uniform_buffers", "max_uniform_buffer", "max_workgroup", "max_workgroup_memory"];
    writeln!(text, "\n## Limits\n\n| | needed | the adapter has | by |\n|---|---|---|---|")?;
    for (need, has) in report.needs.as_array().into_iter().flatten().zip(HAS) {
        let (what, kernel) = (word(need, "what"), word(need, "kernel"));
        writeln!(text, "| {what} | {} | {} | `{kernel}` |", need["needed"], report.adapter[has])?;
    }
    Ok(())
}

fn write_kernels(text: &mut String, report: &ProofReport) -> std::fmt::Result {
    let kernels = &report.kernels;
    if kernels.comparisons.is_empty() {
        return Ok(());
    }
    writeln!(text, "\n## Kernels against the CPU\n\n| comparison | precision | | s |\n|---|---|---|---|")?;
    for of in &kernels.comparisons {
        let verdict = of.disagrees.as_deref().map_or("agrees".to_owned(), |why| format!("**disagrees**: {}", cell(why)));
        writeln!(text, "| {} | {} | {verdict} | {:.1} |", of.name, of.precision, of.seconds)?;
    }
    let wrong: Vec<String> = (kernels.kernels.iter().filter(|of| of.disagree > 0))
        .map(|of| format!("`{}` ({}) in {} of {}", of.kernel, of.precision, of.disagree, of.comparisons))
        .collect();
    writeln!(text, "\n{} kernels took part, counted by precision.", kernels.kernels.len())?;
    if !wrong.is_empty() {
        writeln!(text, "In comparisons that disagree: {}.", wrong.join(", "))?;
    }
    if !kernels.not_compared.is_empty() {
        writeln!(text, "In whole cases alone: {}.", kernels.not_compared.join(", "))?;
    }
    Ok(())
}

fn write_parity(text: &mut String, report: &ProofReport) -> std::fmt::Result {
    if report.parity.rows.is_empty() {
        return Ok(());
    }
    writeln!(text, "\n## Nine whole cases\n")?;
    writeln!(
        text,
        "The largest difference of F_N, F_T, moments and a from the CPU's, over the steps; Newton's iterations; the bits again \
         and alone.\n"
    )?;
    writeln!(text, "| precision | tolerance | case | difference | Newton | on the CPU | again | alone |")?;
    writeln!(text, "|---|---|---|---|---|---|---|---|")?;
    let same = |bits: Option<bool>| match bits {
        Some(true) => "same bits",
        Some(false) => "**other bits**",
        None => "",
    };
    for row in &report.parity.rows {
        for of in &row.cases {
            let difference = of.difference.map_or("another number of steps".to_owned(), |d| format!("{d:.1e}"));
            let (newton, on_cpu, again, alone) = (of.newton_device, of.newton_cpu, same(of.repeated), same(of.alone));
            writeln!(
                text,
                "| {} | {:e} | {} | {difference} | {newton} | {on_cpu} | {again} | {alone} |",
                row.precision, row.tolerance, of.case
            )?;
        }
        if let Some(why) = &row.failed {
            writeln!(text, "| {} | {:e} | | **{}** | | | | |", row.precision, row.tolerance, cell(why))?;
        }
    }
    Ok(())
}

fn write_times(text: &mut String, report: &ProofReport) -> std::fmt::Result {
    if report.latency.is_none() && report.copies.is_none() {
        return Ok(());
    }
    writeln!(text, "\n## Latency and copies\n\n| | |\n|---|---|")?;
    if let Some(latency) = &report.latency {
        writeln!(text, "| a submission, waited for | {:.1} us |", latency.submission_us)?;
        writeln!(text, "| an empty dispatch | {:.2} us |", latency.dispatch_us)?;
        writeln!(text, "| a barrier | {:.2} us |", latency.barrier_us)?;
    }
    match &report.copies {
        Some(copies) => {
            let rates = [
                ("on the device", copies.device),
                ("to the device", copies.to_device),
                ("from the device", copies.from_device),
                ("on one core", Some(copies.one_core)),
                ("on all cores", Some(copies.all_cores)),
            ];
            for (where_to, rate) in rates {
                let rate = rate.map_or("none".to_owned(), |rate| format!("{:.1} GB/s", 1e-9 * rate));
                writeln!(text, "| copies {where_to} | {rate} |")?;
            }
        }
        None => writeln!(text, "| copies | not measured |")?,
    }
    Ok(())
}

fn write_jobs(text: &mut String, jobs: &Jobs) -> std::fmt::Result {
    let Jobs { elements, report, too_large, breaks_even_at, failed } = jobs;
    writeln!(text, "\n## Whole jobs at {elements} elements\n")?;
    if let Some(why) = failed {
        return writeln!(text, "None: {why}");
    }
    writeln!(text, "| where | jobs | unknowns | Newton | cases a call | s, all | s a job |\n|---|---|---|---|---|---|---|")?;
    for job in &report.jobs {
        let WholeJob { device, batch, unknowns, newton_iterations, wall_s, .. } = job;
        let shared = job.cases_a_call.map_or(String::new(), |[cases, places]| format!("{cases:.2} of {places:.0}"));
        let each = wall_s / *batch as f64;
        writeln!(text, "| {device} | {batch} | {unknowns} | {newton_iterations} | {shared} | {wall_s:.2} | {each:.3} |")?;
    }
    match breaks_even_at {
        Some(batch) => writeln!(text, "\nFrom {batch} jobs at a time on, one takes less time there than on all cores.")?,
        None => writeln!(text, "\nNo batch takes less time for a job than all cores.")?,
    }
    if !too_large.is_empty() {
        let sizes: Vec<String> = too_large.iter().map(usize::to_string).collect();
        writeln!(text, "Left out, as the device has no memory for them: {} at a time.", sizes.join(", "))?;
    }
    for kernels in &report.kernels {
        let span = in_words(kernels.span_s.max(1.0));
        writeln!(text, "\nKernels of {} jobs at a time, over {span}:\n", kernels.batch)?;
        kernels.missing.iter().try_for_each(|line| writeln!(text, "{line}\n"))?;
        writeln!(text, "| kernel | precision | dispatches | share | GB/s |\n|---|---|---|---|---|")?;
        for of in kernels.kernels.iter().take(12) {
            let share = of.share.map_or(String::new(), |share| format!("{:.1} %", 100.0 * share));
            let rate = of.bytes_per_s.map_or(String::new(), |rate| format!("{:.1}", 1e-9 * rate));
            writeln!(text, "| `{}` | {} | {} | {share} | {rate} |", of.kernel, of.precision, of.dispatches)?;
        }
    }
    Ok(())
}

/// Words in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
