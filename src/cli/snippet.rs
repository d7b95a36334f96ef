//! Mistakes of a file as messages with the line that is wrong and a caret below it.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::case::{CaseError, Place};

/// Lines longer than this are not shown: a terminal breaks them, and the caret is lost.
const LONGEST: usize = 160;

/// Without colours, and without the word `error` in front of the first.
pub fn plain(errors: &[CaseError], text: &str) -> String {
    let all = rendered(errors, text, &Renderer::plain());
    all.strip_prefix("error: ").map_or(all.clone(), str::to_owned)
}

/// In the colours of a compiler.
pub fn coloured(errors: &[CaseError], text: &str) -> String {
    rendered(errors, text, &Renderer::styled())
}

fn rendered(errors: &[CaseError], text: &str, renderer: &Renderer) -> String {
    let mut messages: Vec<String> = errors.iter().map(|error| message(error, text, renderer)).collect();
    if errors.len() > 1 {
        messages.push(format!("{} mistakes; `asperity explain KEY` says more about a key", errors.len()));
    }
    messages.join("\n\n")
}

fn message(error: &CaseError, text: &str, renderer: &Renderer) -> String {
    let title = error.to_string();
    let bare = Level::ERROR.primary_title(title.as_str());
    let Some((line, number, span)) = line(error, text) else {
        return renderer.render(&[Group::with_title(bare)]);
    };
    let snippet = Snippet::source(line).line_start(number).annotation(AnnotationKind::Primary.span(span));
    let snippet = match error.place() {
        Some(Place::Line { file, .. }) => snippet.path(file.to_string()),
        _ => snippet,
    };
    renderer.render(&[bare.element(snippet)])
}

/// The line on which a mistake begins, its number, and the part of it that is wrong; none where
/// there is no such line or it cannot be shown.
fn line<'t>(error: &CaseError, text: &'t str) -> Option<(&'t str, usize, std::ops::Range<usize>)> {
    let span = error.span()?;
    if span.is_empty() || !text.is_char_boundary(span.start) {
        return None;
    }
    let before = text.get(..span.start)?;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let line = text.get(start..)?.lines().next()?;
    let end = (span.end - start).min(line.len());
    let shown = line.chars().count() <= LONGEST && !line.chars().any(char::is_control) && span.start - start < end;
    shown.then(|| (line, 1 + before.matches('\n').count(), span.start - start..end))
}
