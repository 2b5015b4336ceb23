#!/bin/sh
# Added mass beside other programs, in the same run: sh bench/peers/added_mass/run.sh [options of compare.py]
#
# Needs Python 3.11 or later, cargo, taskset, 6 GB of memory; some five minutes on a quiet machine.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../../..
if [ ! -x "$here/.venv/bin/python" ]; then
    python3 -m venv "$here/.venv"
    "$here/.venv/bin/pip" install --quiet --requirement "$here/requirements.txt"
fi
cargo build --quiet --release --locked --manifest-path "$root/Cargo.toml" --package froude-panel --example peer
exec "$here/.venv/bin/python" "$here/compare.py" "${CARGO_TARGET_DIR:-$root/target}/release/examples/peer" "$@"
