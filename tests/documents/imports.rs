//! Files do not import each other in a circle, so that each can be read after those that it names.
//!
//! An import is a name: in a `use` or in a path, of an item that stands in another file, however
//! many `pub use` hand it on. What is no import: `mod`, without which Rust does not see a file; a
//! `pub use` of what the file itself does not name or call; tests. Nor are calls of methods, which
//! need no name: two files may each have an `impl` of one type, and call what stands in the other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What a file imports, by the names of files.
type Imports = BTreeMap<String, BTreeSet<String>>;

/// Words and marks of Rust, without comments, texts, characters and lifetimes.
fn words(text: &str) -> Vec<String> {
    let source: Vec<char> = text.chars().collect();
    let (mut words, mut i) = (Vec::new(), 0);
    let starts = |i: usize, what: &str| what.chars().enumerate().all(|(k, c)| source.get(i + k) == Some(&c));
    while i < source.len() {
        let c = source[i];
        if starts(i, "//") {
            while i < source.len() && source[i] != '\n' {
                i += 1;
            }
        } else if starts(i, "/*") {
            while i < source.len() && !starts(i, "*/") {
                i += 1;
            }
            i += 2;
        } else if let Some(marks) = raw_text(&source[i..]) {
            let end = format!("\"{}", "#".repeat(marks));
            i += marks + 2;
            while i < source.len() && !starts(i, &end) {
                i += 1;
            }
            i += end.len();
        } else if c == '"' {
            i += 1;
            while i < source.len() && source[i] != '"' {
                i += if source[i] == '\\' { 2 } else { 1 };
            }
            i += 1;
        } else if c == '\'' {
            // A character, or a lifetime, which has no second mark.
            i += match (source.get(i + 1), source.get(i + 2)) {
                (Some('\\'), _) => 3 + source[i + 3..].iter().take_while(|c| **c != '\'').count() + 1,
                (_, Some('\'')) => 3,
                _ => 1 + source[i + 1..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count(),
            };
        } else if c.is_alphanumeric() || c == '_' {
            let length = source[i..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
            words.push(source[i..i + length].iter().collect());
            i += length;
        } else {
            let mark = if starts(i, "::") { "::".to_owned() } else { c.to_string() };
            i += mark.len().max(c.len_utf8()).min(if mark == "::" { 2 } else { 1 });
            if !c.is_whitespace() {
                words.push(mark);
            }
        }
    }
    words
}

/// The marks of a raw text that starts here.
fn raw_text(source: &[char]) -> Option<usize> {
    let marks = source.strip_prefix(&['r'])?.iter().take_while(|c| **c == '#').count();
    (source.get(1 + marks) == Some(&'"')).then_some(marks)
}

/// A module: its file, what is defined in it, and what it names.
#[derive(Default)]
struct Module {
    file: String,
    items: BTreeSet<String>,
    /// Names that a `use` brings in, and the paths that they stand for.
    names: BTreeMap<String, Vec<String>>,
    /// Modules of which all is brought in.
    globs: Vec<Vec<String>>,
    /// Paths that are named, and single words: all that may be types or constants, and of the
    /// others, which may be fields or variables too, those that are called.
    paths: Vec<Vec<String>>,
    words: BTreeSet<String>,
}

/// The modules of some crates, by their paths, of which the first word is the crate.
#[derive(Default)]
struct Modules(BTreeMap<Vec<String>, Module>);

const ITEMS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];

impl Modules {
    /// Reads a file and those that it declares; `read` has a file's text, where there is one.
    fn add(&mut self, path: Vec<String>, file: &str, folder: &Path, read: &dyn Fn(&str) -> Option<String>) {
        let words = words(&read(file).unwrap_or_else(|| panic!("no {file}")));
        self.body(&words, &path, file, folder, read);
    }

    /// The words of a module's body; `folder` has the files of the modules that it declares.
    fn body(&mut self, words: &[String], path: &[String], file: &str, folder: &Path, read: &dyn Fn(&str) -> Option<String>) {
        let mut module = Module { file: file.to_owned(), ..Module::default() };
        let (mut i, mut depth) = (0, 0);
        let word = |i: usize| words.get(i).map_or("", String::as_str);
        while i < words.len() {
            if word(i) == "#" && word(i + 1) == "[" {
                let end = closed(words, i + 1);
                let only_tests = ["test", "doctest"].contains(&word(i + 4)) && word(i + 2) == "cfg" && word(i + 5) == ")";
                i = if only_tests { item_end(words, end) } else { end };
            } else if word(i) == "use" {
                let end = (i..words.len()).find(|i| word(*i) == ";").unwrap_or(words.len());
                // `use<'a>` of a signature is none.
                if word(i + 1) != "<" {
                    let handed_on = i > 0 && (word(i - 1) == "pub" || word(i - 1) == ")");
                    tree(&words[i + 1..end], &mut Vec::new(), &mut |at, name| match name {
                        Some(name) => {
                            module.names.insert(name.to_owned(), at.to_vec());
                            if !handed_on {
                                module.paths.push(at.to_vec());
                            }
                        }
                        None => module.globs.push(at.to_vec()),
                    });
                }
                i = end + 1;
            } else if word(i) == "mod" && word(i + 2) == ";" {
                let name = word(i + 1).to_owned();
                let beside = folder.join(format!("{name}.rs"));
                let within = folder.join(&name).join("mod.rs");
                let found = [beside, within].map(|path| path.to_string_lossy().into_owned());
                let found = found.iter().find(|path| read(path).is_some()).unwrap_or_else(|| panic!("{file}: no mod {name}"));
                self.add([path, std::slice::from_ref(&name)].concat(), found, &folder.join(&name), read);
                i += 3;
            } else if word(i) == "mod" && word(i + 2) == "{" {
                let end = closed(words, i + 2);
                let name = word(i + 1).to_owned();
                self.body(&words[i + 3..end - 1], &[path, std::slice::from_ref(&name)].concat(), file, &folder.join(name), read);
                i = end;
            } else {
                depth += i32::from(word(i) == "{") - i32::from(word(i) == "}");
                let name = word(i + 1);
                if depth == 0 && ITEMS.contains(&word(i)) && !ITEMS.contains(&name) {
                    module.items.insert(name.to_owned());
                }
                let mut at = vec![word(i).to_owned()];
                while word(i + 1) == "::" && word(i + 2).starts_with(|c: char| c.is_alphanumeric() || c == '_') {
                    at.push(word(i + 2).to_owned());
                    i += 2;
                }
                let called = word(i + 1) == "(" && i > 0 && ![".", "fn"].contains(&word(i - 1));
                match at.len() {
                    1 if called || at[0].starts_with(char::is_uppercase) => module.words.extend(at),
                    1 => {}
                    _ => module.paths.push(at),
                }
                i += 1;
            }
        }
        self.0.insert(path.to_vec(), module);
    }

    /// The module in which the item of a path stands that is named in the module `at`; none for
    /// what is of another crate, of the language, or a module.
    fn home(&self, at: &[String], path: &[String], deep: usize) -> Option<&Module> {
        let module = &self.0[at];
        let (first, rest) = path.split_first()?;
        if deep > 20 {
            return None;
        }
        let inner = |name: &str| [at, &[name.to_owned()]].concat();
        match first.as_str() {
            "crate" => return self.home(&at[..1], rest, deep + 1),
            "self" => return self.home(at, rest, deep + 1),
            "super" => return self.home(&at[..at.len() - 1], rest, deep + 1),
            _ => {}
        }
        if !rest.is_empty() && self.0.contains_key(&inner(first)) {
            return self.home(&inner(first), rest, deep + 1);
        }
        if module.items.contains(first) {
            return Some(module);
        }
        if let Some(stands_for) = module.names.get(first) {
            return self.home(at, &[stands_for, rest].concat(), deep + 1);
        }
        if at.len() > 1 || !rest.is_empty() {
            let root = vec![first.clone()];
            if self.0.contains_key(&root) {
                return self.home(&root, rest, deep + 1);
            }
        }
        module.globs.iter().find_map(|glob| match self.module(at, glob) {
            Some(there) if there != at => self.home(&there, path, deep + 1),
            _ => None,
        })
    }

    /// The module of a path that is named in the module `at`.
    fn module(&self, at: &[String], path: &[String]) -> Option<Vec<String>> {
        let mut place = at.to_vec();
        for (i, word) in path.iter().enumerate() {
            match word.as_str() {
                "crate" => place.truncate(1),
                "self" => {}
                "super" => drop(place.pop()),
                _ => {
                    let inner = [&place[..], std::slice::from_ref(word)].concat();
                    if self.0.contains_key(&inner) {
                        place = inner;
                    } else if let Some(stands_for) = self.0[&place].names.get(word).filter(|path| path[0] != *word) {
                        place = self.module(&place, stands_for)?;
                    } else if i == 0 && self.0.contains_key(std::slice::from_ref(word)) {
                        place = vec![word.clone()];
                    } else {
                        return None;
                    }
                }
            }
        }
        Some(place)
    }

    fn imports(&self) -> Imports {
        let mut imports = Imports::new();
        for (at, module) in &self.0 {
            let single = module.words.iter().map(|word| vec![word.clone()]);
            let named = module.paths.iter().cloned().chain(single);
            let homes = named.filter_map(|path| self.home(at, &path, 0)).map(|home| home.file.clone());
            let homes: BTreeSet<String> = homes.filter(|home| *home != module.file).collect();
            imports.entry(module.file.clone()).or_default().extend(homes);
        }
        imports
    }
}

/// Behind the bracket that closes the one at `i`.
fn closed(words: &[String], i: usize) -> usize {
    let mut depth = 0;
    for (k, word) in words.iter().enumerate().skip(i) {
        depth += i32::from(["[", "{", "("].contains(&word.as_str())) - i32::from(["]", "}", ")"].contains(&word.as_str()));
        if depth == 0 {
            return k + 1;
        }
    }
    words.len()
}

/// Behind the item that starts at `i`.
fn item_end(words: &[String], mut i: usize) -> usize {
    while i < words.len() {
        match words[i].as_str() {
            ";" => return i + 1,
            "{" => return closed(words, i),
            "(" | "[" => i = closed(words, i),
            _ => i += 1,
        }
    }
    i
}

/// The names of a `use`, each with its path; without a name all of a module.
fn tree(words: &[String], path: &mut Vec<String>, found: &mut impl FnMut(&[String], Option<&str>)) {
    let start = path.len();
    let mut i = 0;
    while i < words.len() {
        match words[i].as_str() {
            "::" => {}
            "{" => {
                let end = closed(words, i);
                let (mut from, mut depth) = (i + 1, 0);
                for k in i + 1..end {
                    depth += i32::from(words[k] == "{") - i32::from(words[k] == "}" && k + 1 < end);
                    if k + 1 == end || (depth == 0 && words[k] == ",") {
                        tree(&words[from..k], path, found);
                        from = k + 1;
                    }
                }
                path.truncate(start);
                return;
            }
            "*" => {
                found(path, None);
                path.truncate(start);
                return;
            }
            "as" => {
                found(path, Some(&words[i + 1]));
                path.truncate(start);
                return;
            }
            "self" if i + 1 == words.len() && !path.is_empty() => {}
            word => path.push(word.to_owned()),
        }
        i += 1;
    }
    if !words.is_empty() {
        let name = path.last().cloned();
        found(path, name.as_deref());
    }
    path.truncate(start);
}

/// What the modules of `python/asperity` import of each other, those imports too that are for types
/// alone or stand in a function.
fn imports_of_python(folder: &Path) -> Imports {
    let mut imports = Imports::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "py") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("source");
        let mut there = BTreeSet::new();
        for line in text.lines().filter_map(|line| line.trim_start().strip_prefix("from .")) {
            let (module, names) = line.split_once(" import ").expect("an import");
            let names = names.split(',').map(|name| name.split_whitespace().next().unwrap_or(""));
            let modules: Vec<&str> = if module.is_empty() { names.collect() } else { vec![module] };
            there.extend(modules.iter().map(|module| folder.join(format!("{module}.py"))).filter(|path| path.exists()));
        }
        let name = |path: PathBuf| path.to_string_lossy().into_owned();
        imports.insert(name(path), there.into_iter().map(name).collect());
    }
    imports
}

/// The shortest circle of files there is, each of which imports the next, the last the first.
fn circle(imports: &Imports) -> Option<Vec<String>> {
    let shortest_from = |start: &String| {
        let mut from: BTreeMap<&String, &String> = BTreeMap::new();
        let mut edge = vec![start];
        while !edge.is_empty() {
            let mut next = Vec::new();
            for file in edge {
                for other in imports.get(file).into_iter().flatten() {
                    if other == start {
                        let way = std::iter::successors(Some(file), |file| from.get(file).copied());
                        let mut way: Vec<String> = way.cloned().collect();
                        way.reverse();
                        return Some(way);
                    }
                    if !from.contains_key(other) {
                        from.insert(other, file);
                        next.push(other);
                    }
                }
            }
            edge = next;
        }
        None
    };
    imports.keys().filter_map(shortest_from).min_by_key(Vec::len)
}

/// Each file of the shortest circle with the next; nothing where there is none.
fn shown(imports: &Imports) -> String {
    let arrow = |way: &[String]| way.iter().map(|file| format!("  {file}, which imports\n")).collect::<String>();
    circle(imports).map_or_else(String::new, |way| format!("{}  {}", arrow(&way), way[0]))
}

#[test]
fn no_circle_of_imports() {
    let read = |file: &str| fs::read_to_string(file).ok();
    let mut modules = Modules::default();
    for (name, root) in [("asperity_kernels", "crates/kernels/src"), ("asperity", "src"), ("python", "python/src")] {
        modules.add(vec![name.to_owned()], &format!("{root}/lib.rs"), Path::new(root), &read);
    }
    let imports = modules.imports();
    let arrows: usize = imports.values().map(BTreeSet::len).sum();
    assert!(imports.len() > 300 && arrows > 1000, "{} files, {arrows} imports", imports.len());
    let found = shown(&imports);
    assert!(found.is_empty(), "files import each other in a circle:\n{found}");

    let python = imports_of_python(Path::new("python/asperity"));
    assert!(python.len() > 10, "{} modules", python.len());
    let found = shown(&python);
    assert!(found.is_empty(), "modules import each other in a circle:\n{found}");
}

#[test]
fn a_circle_is_found() {
    let circle = |sphere: &str, layout: &str| {
        let read = |file: &str| match file {
            "lib.rs" => Some("mod sphere; /* mod none; */ pub use sphere::Spec;".to_owned()),
            "sphere.rs" => Some(sphere.to_owned()),
            "sphere/layout.rs" => Some(layout.to_owned()),
            "sphere/spec.rs" => Some("pub struct Spec;".to_owned()),
            _ => None,
        };
        let mut modules = Modules::default();
        modules.add(vec!["shapes".to_owned()], "lib.rs", Path::new(""), &read);
        circle(&modules.imports()).unwrap_or_default()
    };
    let both = ["sphere.rs", "sphere/layout.rs"];
    let here = "mod layout; mod spec; pub struct Spec; fn f(l: layout::Layout<'_>) { \"}\"; '}' }";
    for layout in
        ["use super::Spec;", "use crate::Spec;", "use crate::{sphere::{self, Spec as Given}};", "fn g(s: &crate::Spec) {}"]
    {
        assert_eq!(circle(here, &format!("{layout} pub struct Layout;")), both, "{layout}");
    }
    // In a file of its own it opens the circle, whoever hands it on.
    let elsewhere = "mod layout; mod spec; pub use spec::Spec; use layout::Layout;";
    assert_eq!(circle(elsewhere, "use super::Spec; pub struct Layout;"), [""; 0]);
    assert_eq!(circle(here, "pub struct Layout; #[cfg(test)] mod tests { use super::super::Spec; }"), [""; 0]);
}
