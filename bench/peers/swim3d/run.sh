#!/bin/sh
# A swimmer in three dimensions beside MuJoCo and Pinocchio: sh bench/peers/swim3d/run.sh [--json FILE]
#
# Needs Python 3.11 or later and cargo; a minute.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../../..
if [ ! -x "$here/.venv/bin/python" ]; then
    python3 -m venv "$here/.venv"
    "$here/.venv/bin/pip" install --quiet --requirement "$here/requirements.txt"
fi
cargo build --quiet --release --locked --manifest-path "$root/Cargo.toml" --package froude-swim --example peer_3d
exec "$here/.venv/bin/python" "$here/compare.py" "${CARGO_TARGET_DIR:-$root/target}/release/examples/peer_3d" "$@"
