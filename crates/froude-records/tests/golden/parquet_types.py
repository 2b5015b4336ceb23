"""Every type of number and time that writers of Parquet have, for tests/suite/parquet_types.rs.

python3 parquet_types.py; needs pyarrow 26, polars 1 and fastparquet 2026.
"""

import datetime as dt
from decimal import Decimal
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq

HERE = Path(__file__).parent / "parquet"
HERE.mkdir(exist_ok=True)


def arrow(name, columns, **options):
    pq.write_table(pa.table(columns), HERE / f"{name}.parquet", **options)


START = dt.datetime(2026, 3, 31, 23, 59, 59, 500000)
STAMPS = [START + dt.timedelta(microseconds=us) for us in (0, 250_000, 1_000_123)]
SPANS = [dt.timedelta(microseconds=us) for us in (1_500_000, 1_750_000, 2_500_123)]

numbers = {
    "half [N]": pa.array(np.array([0.5, -2.0, 65504.0], np.float16)),
    "float [N]": pa.array([0.5, -2.0, 3.0], pa.float32()),
    "int8 [N]": pa.array([-128, 0, 127], pa.int8()),
    "uint8 [N]": pa.array([0, 128, 255], pa.uint8()),
    "uint16 [N]": pa.array([0, 1, 65535], pa.uint16()),
    "uint32 [N]": pa.array([0, 1, 4294967295], pa.uint32()),
    "int64 [N]": pa.array([-(2**53), 0, 2**53], pa.int64()),
    "uint64 [N]": pa.array([0, 1, 2**63], pa.uint64()),
    "decimal [N]": pa.array([Decimal("-1.23"), Decimal("0.07"), Decimal("99.99")], pa.decimal128(4, 2)),
    "long_decimal [N]": pa.array([Decimal("-0.1"), Decimal("0.3"), Decimal("12345678901234567890.5")], pa.decimal128(38, 10)),
    "wide_decimal [N]": pa.array([Decimal("-0.1"), Decimal("0.3"), Decimal("7")], pa.decimal256(60, 10)),
    "is_wet": pa.array([True, False, True]),
    "category": pa.array(["a", "b", "a"]).dictionary_encode(),
    "day": pa.array([dt.date(2026, 3, 31), dt.date(1969, 12, 31), dt.date(2000, 2, 29)]),
}
arrow("numbers", numbers)
arrow("decimals_as_integers", {k: numbers[k] for k in ("decimal [N]",)}, store_decimal_as_integer=True)

for unit in ("ms", "us", "ns"):
    arrow(f"timestamp_{unit}", {"time": pa.array([s.replace(microsecond=s.microsecond // 1000 * 1000) if unit == "ms" else s for s in STAMPS], pa.timestamp(unit))})
    arrow(f"zoned_{unit}", {f"time [{unit}]": pa.array([s.replace(microsecond=s.microsecond // 1000 * 1000) if unit == "ms" else s for s in STAMPS], pa.timestamp(unit, tz="UTC"))})
arrow("int96", {"time": pa.array(STAMPS, pa.timestamp("us"))}, use_deprecated_int96_timestamps=True)
for unit in ("s", "ms", "us", "ns"):
    per = {"s": 1, "ms": 1000, "us": 1_000_000, "ns": 1_000_000_000}[unit]
    arrow(f"duration_{unit}", {"t": pa.array([per, 3 * per // 2, -2 * per], pa.duration(unit)), "x [m]": pa.array([1.0, 2.0, 3.0])})
clock = [dt.time(0, 0, 1, 250000), dt.time(12), dt.time(23, 59, 59, 999000)]
arrow("clock_ms", {"clock": pa.array(clock, pa.time32("ms"))})
arrow("clock_us", {"clock": pa.array(clock, pa.time64("us"))})
arrow("clock_ns", {"clock": pa.array(clock, pa.time64("ns"))})
arrow("two_clocks", {"a": pa.array([START, START], pa.timestamp("us")), "b": pa.array([STAMPS[1], STAMPS[2]], pa.timestamp("ns"))})
arrow("contradiction", {"time [ms]": pa.array(SPANS, pa.duration("us"))})
arrow("stated", {"time [us]": pa.array(SPANS, pa.duration("us"))})
arrow("stamp_for_force", {"f_x [N]": pa.array(STAMPS, pa.timestamp("us"))})
arrow("dates_for_time", {"time [s]": pa.array([dt.date(2026, 3, 31)])})
arrow("list", {"f_x [N]": pa.array([[1.0, 2.0]]), "speed [m/s]": pa.array([1.0])})
arrow("struct", {"wrench": pa.array([{"x": 1.0, "y": 2.0}]), "speed [m/s]": pa.array([1.5])})
arrow("map", {"m": pa.array([[("a", 1)]], pa.map_(pa.string(), pa.int64()))})
arrow("bytes", {"id": pa.array([b"0123456789abcdef"], pa.binary(16))})
arrow("gzip", {"x [m]": pa.array([1.0])}, compression="gzip")
arrow("two_groups", {"time": pa.array(STAMPS, pa.timestamp("us")), "x [m]": pa.array([1.0, 2.0, 3.0])}, row_group_size=1)
arrow("nulls", {"v_x [m/s]": pa.array([1.0, None, 2.0]), "f_x [N]": pa.array([None, 5.0, 6.0]), "f_y [N]": pa.array([1, 2, None], pa.int16())})
arrow("null_time", {"time": pa.array([STAMPS[0], None], pa.timestamp("us"))})

frame = pd.DataFrame({"time": pd.to_timedelta([0, 10, 25], unit="ms"), "x [m]": [0.0, 0.1, 0.2]})
frame.to_parquet(HERE / "pandas_timedelta.parquet")
frame.iloc[[0, 2, 1]].to_parquet(HERE / "pandas_index.parquet")
frame.to_parquet(HERE / "fastparquet_timedelta.parquet", engine="fastparquet")
stamps = pd.DataFrame({"time": pd.to_datetime([1_700_000_000_000, 1_700_000_000_040], unit="ms")})
stamps.to_parquet(HERE / "fastparquet_stamps.parquet", engine="fastparquet")
pl.DataFrame({"time": SPANS, "clock": clock, "n": pl.Series([1, 2, 3], dtype=pl.UInt32)}).rename({"n": "n [1]"}).write_parquet(HERE / "polars.parquet")
