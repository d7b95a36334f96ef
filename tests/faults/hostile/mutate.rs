//! Changes to an input: of its bytes, of its cells where it is a table, and of its tree where it is
//! JSON or TOML, anywhere in it.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

/// What a changed input may have; larger ones are read no otherwise, only slower.
pub const LARGEST: usize = 1 << 18;

/// Put in place of what stands there, or beside it.
const WORDS: [&str; 40] = [
    "nan",
    "-nan",
    "inf",
    "-inf",
    "0",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e999",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7fffffffffffffff",
    "0b1",
    "1_000_000",
    "true",
    "\"stick\"",
    "\"full-slip\"",
    "[",
    "]",
    "{",
    "}",
    "[[",
    "]]",
    "[[path]]\n",
    "[grid]\n",
    "=",
    ",",
    ".",
    "\"",
    "\"\"\"",
    "'",
    "\\u0000",
    "\u{0}",
    "1979-05-27T07:32:00Z",
    "a.b.c.d",
    "null",
    "\r\n",
];

/// Numbers at the ends of what there is, and such as a count or a share may be by mistake.
const NUMBERS: [f64; 26] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    3.0,
    1.0 + 1e-9,
    1e-3,
    1e3,
    1e-9,
    1e9,
    1e-15,
    1e15,
    1e-30,
    1e30,
    1e-100,
    1e100,
    1e-300,
    1e300,
    5e-324,
    1e308,
    -1e308,
    f64::MAX,
    -1e30,
    1e-75,
];

/// Changes one to four places of the bytes; pieces of `other` may come in.
pub fn bytes(rng: &mut ChaCha8Rng, seed: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..rng.random_range(1..=4) {
        let length = bytes.len();
        let at = rng.random_range(0..=length);
        let end = (at + rng.random_range(0..=16)).min(length);
        match rng.random_range(0..9) {
            0 if at < length => bytes[at] ^= 1 << rng.random_range(0..8),
            1 if at < length => bytes[at] = rng.random(),
            2 => drop(bytes.splice(at..end, [])),
            3 => drop(bytes.splice(at..at, WORDS[rng.random_range(0..WORDS.len())].bytes())),
            4 => {
                // In place of a number or a word.
                let word = |byte: &u8| byte.is_ascii_alphanumeric() || b".+-_\"".contains(byte);
                let end = at + bytes[at..].iter().take_while(|byte| word(byte)).count();
                drop(bytes.splice(at..end, WORDS[rng.random_range(0..WORDS.len())].bytes()));
            }
            5 => bytes.truncate(at),
            6 => {
                let from = rng.random_range(0..=other.len());
                let to = (from + rng.random_range(0..=200)).min(other.len());
                drop(bytes.splice(at..at, other[from..to].iter().copied()));
            }
            7 => {
                let end = (at + rng.random_range(0..=64)).min(length);
                let times = 1 << rng.random_range(0..=10);
                let piece = bytes[at..end].repeat(times);
                drop(bytes.splice(at..at, piece));
            }
            _ => {
                let line = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |line| line + 1);
                let piece: Vec<u8> = bytes[line..].iter().copied().take_while(|byte| *byte != b'\n').collect();
                drop(bytes.splice(line..line, piece.into_iter().chain([b'\n'])));
            }
        }
        bytes.truncate(LARGEST);
    }
    bytes
}

/// Changes one to three cells, rows or columns of a table with a header.
pub fn table(rng: &mut ChaCha8Rng, seed: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(seed);
    let mut rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    for _ in 0..rng.random_range(1..=3) {
        let from = usize::from(rows.len() > 1 && rng.random_range(0..10) > 0);
        let row = rng.random_range(from..rows.len().max(from + 1)).min(rows.len() - 1);
        let column = rng.random_range(0..rows[row].len().max(1));
        match rng.random_range(0..8) {
            0..4 if !rows[row].is_empty() => rows[row][column] = cell(rng),
            4 => {
                let other = rng.random_range(0..rows.len());
                rows.swap(row, other);
            }
            5 => drop(rows.splice(row..row, vec![rows[row].clone(); rng.random_range(1..5)])),
            6 if rows.len() > 1 => drop(rows.remove(row)),
            _ => {
                let other = rng.random_range(0..rows[row].len().max(1));
                for row in rows.iter_mut().filter(|row| row.len() > column.max(other)) {
                    row.swap(column, other);
                }
            }
        }
    }
    rows.iter().map(|row| row.join(",") + "\n").collect::<String>().into_bytes()
}

fn cell(rng: &mut ChaCha8Rng) -> String {
    match rng.random_range(0..3) {
        0 => WORDS[rng.random_range(0..WORDS.len())].to_owned(),
        1 => format!("{}", rng.random_range(0..30)),
        _ => format!("{:?}", NUMBERS[rng.random_range(0..NUMBERS.len())]),
    }
}

/// Changes one to three places of a tree.
pub fn tree(rng: &mut ChaCha8Rng, value: &mut Value) {
    for _ in 0..rng.random_range(1..=3) {
        let other = somewhere(rng, value).clone();
        let place = somewhere(rng, value);
        change(rng, place, other);
    }
}

/// A place in a tree; each step down goes to any child, and now and then the way ends before a
/// leaf.
fn somewhere<'a>(rng: &mut ChaCha8Rng, value: &'a mut Value) -> &'a mut Value {
    let mut place = value;
    loop {
        let children = match &*place {
            Value::Array(values) => values.len(),
            Value::Object(values) => values.len(),
            _ => 0,
        };
        if children == 0 || rng.random_range(0..12) == 0 {
            return place;
        }
        let child = rng.random_range(0..children);
        place = match place {
            Value::Array(values) => &mut values[child],
            Value::Object(values) => values.values_mut().nth(child).expect("a child"),
            leaf => return leaf,
        };
    }
}

fn change(rng: &mut ChaCha8Rng, place: &mut Value, other: Value) {
    let extreme = |rng: &mut ChaCha8Rng| Value::from(NUMBERS[rng.random_range(0..NUMBERS.len())]);
    match place {
        Value::Number(number) => {
            let was = number.as_f64().unwrap_or(0.0);
            *place = match rng.random_range(0..8) {
                0 => Value::from(rng.random_range(-2..40)),
                1 => Value::from(u64::MAX >> rng.random_range(0..64)),
                2 => Value::from(-was),
                // A little beside it: most of these are taken.
                3 => Value::from(was * (1.0 + 1e-3 * (rng.random::<f64>() - 0.5))),
                4 => Value::from(was * 10f64.powi(rng.random_range(-12..=12))),
                5 => other,
                _ => extreme(rng),
            };
        }
        Value::Array(values) if !values.is_empty() => {
            let at = rng.random_range(0..values.len());
            match rng.random_range(0..6) {
                0 => values.truncate(at),
                1 => drop(values.remove(at)),
                2 => drop(values.splice(at..at, vec![values[at].clone(); rng.random_range(1..30)])),
                3 => {
                    let with = rng.random_range(0..values.len());
                    values.swap(at, with);
                }
                4 => values[at] = extreme(rng),
                _ => values[at] = other,
            }
        }
        Value::Object(values) if !values.is_empty() => {
            let key = values.keys().nth(rng.random_range(0..values.len())).expect("a key").clone();
            match rng.random_range(0..4) {
                0 => drop(values.remove(&key)),
                1 => {
                    let value = values.remove(&key).expect("it is there");
                    values.insert(format!("{key}2"), value);
                }
                2 => drop(values.insert(key, Value::Null)),
                _ => drop(values.insert(key, other)),
            }
        }
        Value::String(text) => match rng.random_range(0..4) {
            0 => text.clear(),
            1 => *text = text.repeat(rng.random_range(2..50)),
            2 => *text = WORDS[rng.random_range(0..WORDS.len())].to_owned(),
            _ => *text = String::from_utf8_lossy(&bytes(rng, text.as_bytes(), b"")).into_owned(),
        },
        _ => *place = if rng.random_range(0..2) == 0 { other } else { extreme(rng) },
    }
}
