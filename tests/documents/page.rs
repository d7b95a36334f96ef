//! A page of Markdown: its code blocks with the comments that stand before them, links, headings.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

pub struct Block {
    /// The word after the fence.
    pub language: String,
    pub text: String,
    /// Line of the fence, from 1.
    pub line: usize,
    /// What a comment on the line before the block says: `not run: ...`, `output`, `file: ...`.
    pub remark: Option<String>,
}

pub struct Page {
    pub path: PathBuf,
    pub text: String,
    pub blocks: Vec<Block>,
}

/// Every document: those of the root, and the book.
pub fn pages() -> Vec<Page> {
    let book = fs::read_dir("docs").expect("docs").map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<PathBuf> = book.filter(|path| path.extension().is_some_and(|ending| ending == "md")).collect();
    paths.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(PathBuf::from));
    paths.sort();
    paths.iter().map(|path| Page::read(path)).collect()
}

/// What stands beside scripts and data: each README.md below benches and fixtures.
pub fn records() -> Vec<Page> {
    let (mut folders, mut pages): (Vec<PathBuf>, _) = (["benches", "fixtures"].map(PathBuf::from).into(), Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.ends_with("README.md") {
                pages.push(Page::read(&path));
            }
        }
    }
    assert!(pages.len() > 5, "{} records", pages.len());
    pages
}

impl Page {
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let blocks = blocks(&text);
        Self { path: path.to_owned(), text, blocks }
    }

    /// Lines outside of code and comments, with their numbers.
    pub fn prose(&self) -> Vec<(usize, &str)> {
        let mut fenced = false;
        let mut prose = Vec::new();
        for (number, line) in (1..).zip(self.text.lines()) {
            if line.starts_with("```") {
                fenced = !fenced;
            } else if !fenced && !line.starts_with("<!--") {
                prose.push((number, line));
            }
        }
        prose
    }

    /// Targets of its links and pictures.
    pub fn links(&self) -> Vec<String> {
        let lines: Vec<&str> = self.prose().into_iter().map(|(_, line)| line).collect();
        let text = lines.join("\n");
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        targets.map(|(target, _)| target.to_owned()).collect()
    }

    /// The anchors of its headings, as GitHub and mdBook make them.
    pub fn anchors(&self) -> BTreeSet<String> {
        let heading = |line: &str| line.starts_with('#').then(|| line.trim_start_matches('#').trim().to_owned());
        let kept = |c: char| c.is_alphanumeric() || "-_ ".contains(c);
        let anchor = |heading: String| heading.chars().filter(|&c| kept(c)).collect::<String>().to_lowercase().replace(' ', "-");
        self.prose().into_iter().filter_map(|(_, line)| heading(line)).map(anchor).collect()
    }
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let (mut open, mut before) = (false, "");
    for (line, content) in (1..).zip(text.lines()) {
        if let Some(language) = content.strip_prefix("```") {
            if !open {
                let remark = before.strip_prefix("<!-- ").and_then(|rest| rest.strip_suffix(" -->"));
                let remark = remark.map(str::to_owned);
                blocks.push(Block { language: language.to_owned(), text: String::new(), line, remark });
            }
            open = !open;
        } else if open {
            let block = blocks.last_mut().expect("the open block");
            block.text += content;
            block.text.push('\n');
        }
        before = content;
    }
    assert!(!open, "a block of code has no end");
    blocks
}
