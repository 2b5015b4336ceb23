"""What the official Python reader finds in a run of tests/common: the parent of official_reader.json.

    FROUDE_TEST_KEEP=/tmp/run cargo test -p froude-records --test suite official_reader
    pip install mcap==1.6.0 mcap-ros2-support==0.6.0
    python official_reader.py /tmp/run/run.mcap > official_reader.json
"""

import importlib.metadata
import json
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

path = sys.argv[1]
topics = {}
with open(path, "rb") as file:
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    for schema, channel, message, decoded in reader.iter_decoded_messages():
        topic = topics.setdefault(
            channel.topic,
            {"schema": schema.name, "messages": 0, "first_ns": message.log_time, "last_ns": 0, "sums": {}},
        )
        topic["messages"] += 1
        topic["last_ns"] = message.log_time
        for field in decoded.__slots__:
            value = getattr(decoded, field)
            if isinstance(value, (int, float)):
                topic["sums"][field] = topic["sums"].get(field, 0) + value
            elif isinstance(value, str) and value:
                topic.setdefault("texts", []).append(value)
with open(path, "rb") as file:
    reader = make_reader(file)
    statistics = reader.get_summary().statistics
    metadata = [m.metadata for m in reader.iter_metadata()]
versions = {name: importlib.metadata.version(name) for name in ("mcap", "mcap-ros2-support")}
json.dump(
    {
        "versions": versions,
        "messages": statistics.message_count,
        "chunks": statistics.chunk_count,
        "statuses": [m["status"] for m in metadata],
        "target_speed": metadata[-1]["target_speed"],
        "topics": dict(sorted(topics.items())),
    },
    sys.stdout,
    indent=1,
)
print()
