#!/bin/sh
# Compare Froude with other programs on this machine: sh bench/peers/run.sh [options of compare.py]
#
# Needs Python 3.11 or later, cargo, taskset, 6 GB of memory, and 3.4 GB in $PEERS_DATA
# (default bench/peers/data). $PEERS_ROWS changes the size (default 1e7).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
data=${PEERS_DATA:-$here/data} rows=${PEERS_ROWS:-1e7}
if [ ! -x "$here/.venv/bin/python" ]; then
    python3 -m venv "$here/.venv"
    "$here/.venv/bin/pip" install --quiet --requirement "$here/requirements.txt"
fi
target=${CARGO_TARGET_DIR:-$here/ours/target}
CARGO_TARGET_DIR=$target cargo build --quiet --release --manifest-path "$here/ours/Cargo.toml"
program=$target/release/peer-bench
if [ "$(cat "$data/rows" 2>/dev/null)" != "$rows" ]; then
    "$program" make "$data" "$rows"
    echo "$rows" > "$data/rows"
fi
if [ ! -e "$data/hour.f64" ]; then
    "$program" make-hour "$data" 3600
fi
exec "$here/.venv/bin/python" "$here/compare.py" "$program" "$data" "$@"
