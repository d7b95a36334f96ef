//! A folder of texts as one file: POSIX's tar (ustar), which every system can unpack.

use crate::law::export::ExportedFile;

/// Everything is a multiple of this.
const BLOCK: usize = 512;
/// Longest name of a file with its folder.
const LONGEST_NAME: usize = 100;

/// The files in a folder of this name. A name that is too long for the format is cut; this program
/// has none.
pub fn packed(folder: &str, files: &[ExportedFile]) -> Vec<u8> {
    let mut archive = Vec::new();
    for file in files {
        archive.extend_from_slice(&header(&format!("{folder}/{}", file.name), file.content.len()));
        archive.extend_from_slice(file.content.as_bytes());
        archive.resize(archive.len().next_multiple_of(BLOCK), 0);
    }
    // Two empty blocks are the end.
    archive.resize(archive.len() + 2 * BLOCK, 0);
    archive
}

fn header(name: &str, size: usize) -> [u8; BLOCK] {
    let mut block = [0u8; BLOCK];
    let mut put = |at: usize, text: &str| block[at..at + text.len()].copy_from_slice(text.as_bytes());
    put(0, name.get(..LONGEST_NAME).unwrap_or(name));
    put(100, "0000644\0");
    put(108, "0000000\0");
    put(116, "0000000\0");
    put(124, &format!("{size:011o}\0"));
    put(136, &format!("{:011o}\0", 0));
    // The sum is taken with blanks in its own place.
    put(148, "        ");
    put(156, "0");
    put(257, "ustar\0");
    put(263, "00");
    let sum: u32 = block.iter().copied().map(u32::from).sum();
    block[148..156].copy_from_slice(format!("{sum:06o}\0 ").as_bytes());
    block
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sizes_and_sums_are_where_a_reader_looks() {
        let files = ["a", "bc"].map(|text| ExportedFile { name: format!("{text}.h"), content: text.to_owned() });
        let archive = packed("folder", &files);
        assert_eq!(archive.len(), 6 * BLOCK);
        assert!(archive.starts_with(b"folder/a.h\0") && &archive[257..262] == b"ustar");
        assert_eq!((&archive[124..136], archive[BLOCK]), (&b"00000000001\0"[..], b'a'));
        assert!(archive[2 * BLOCK..].starts_with(b"folder/bc.h\0"));
        let own = u32::from_str_radix(std::str::from_utf8(&archive[148..154]).unwrap(), 8).unwrap();
        let sum: u32 = (0..BLOCK).map(|i| if (148..156).contains(&i) { 32 } else { u32::from(archive[i]) }).sum();
        assert_eq!(own, sum);
    }
}
