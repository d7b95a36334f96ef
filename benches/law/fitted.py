"""Fitted constants of the contact update in their Rust source, `pub const FITTED`."""

import re


def read(source, names):
    """Those of the program."""
    fitted = source.read_text().split("pub const FITTED", 1)[1]
    return {name: float(re.search(rf"^ +{name}: ([-0-9.e]+),", fitted, re.M).group(1)) for name in names}


def write(source, values):
    """Puts them into the source."""
    head, fitted = source.read_text().split("pub const FITTED", 1)
    for name, value in values.items():
        fitted = re.sub(rf"^( +{name}: )[-0-9.e]+,", rf"\g<1>{value!r},", fitted, count=1, flags=re.M)
    source.write_text(f"{head}pub const FITTED{fitted}")
