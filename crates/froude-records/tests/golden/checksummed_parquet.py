"""A Parquet table with page checksums, as other programs write it: checksummed.parquet (pyarrow, see VERSION below).

    python checksummed_parquet.py
"""

import pyarrow as pa
import pyarrow.parquet as pq

VERSION = "26.0.1"
assert pa.__version__ == VERSION, f"made with pyarrow {VERSION}, this is {pa.__version__}"

n = 60
speed = [round(0.05 * (k % 12 + 1), 2) for k in range(n)]
table = pa.table(
    {
        "configuration": [f"H{k % 3 + 1}LT" for k in range(n)],
        "repeat [1]": pa.array([k // 12 + 1 for k in range(n)], pa.int32()),
        "speed [m/s]": speed,
        "f_x [N]": [-10.0 * v * v - 0.001 * (7 * k % 11 - 5) for k, v in enumerate(speed)],
    }
)
pq.write_table(table, "checksummed.parquet", compression="snappy", write_page_checksum=True, row_group_size=30)
