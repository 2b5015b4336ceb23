#!/bin/sh
# A planar swimmer beside MuJoCo and Pinocchio, in the same run: sh bench/peers/swim/run.sh [--quick] [--json FILE]
#
# Needs Python 3.11 or later, cargo, taskset; some five minutes on a quiet machine.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../../..
if [ ! -x "$here/.venv/bin/python" ]; then
    python3 -m venv "$here/.venv"
    "$here/.venv/bin/pip" install --quiet --requirement "$here/requirements.txt"
fi
cargo build --quiet --release --locked --manifest-path "$root/Cargo.toml" --package froude-swim --example peer
exec taskset -c 0 "$here/.venv/bin/python" "$here/compare.py" "${CARGO_TARGET_DIR:-$root/target}/release/examples/peer" "$@"
