"""A run's results for other programs: CSV and Parquet, one row a mission."""

import csv
import os
from contextlib import suppress
from pathlib import Path

from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model import Fault, InputError, MissingDependencyError
from reasoned_explorer.model.disk import disk_error

FORMATS = (".csv", ".parquet")


def export(store: RunStore, path: Path) -> int:
    """Write every mission's figures into a file, by its suffix, whole or not at all; return how many there are.

    The rows are in one order and hold nothing of the machine, so that the same run gives the same CSV to the byte.

    Raises:
        InputError: If the suffix is none of `FORMATS`, or no file can be written there.
        MissingDependencyError: If Parquet is asked for without pyarrow.
        PartError: If the disk fails, e.g. because it is full.
    """
    if path.suffix not in FORMATS:
        raise InputError("export", [Fault(f"{path}", f"a name that ends in {' or '.join(FORMATS)}")])
    half = path.with_name(f"{path.name}.{os.getpid()}.half")
    try:
        count = _csv(store, half) if path.suffix == ".csv" else _parquet(store, half)
        half.replace(path)
    except OSError as error:
        with suppress(OSError):
            half.unlink(missing_ok=True)
        raise disk_error("export", path, error) from error
    return count


def _csv(store: RunStore, path: Path) -> int:
    names, rows = store.results()
    count = 0
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        for row in rows:
            writer.writerow(row)
            count += 1
    return count


def _parquet(store: RunStore, path: Path) -> int:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError as error:
        raise MissingDependencyError(
            "export to Parquet", "pyarrow", "pip install 'reasoned-explorer[parquet]'"
        ) from error
    names, rows = store.results()
    columns = list(zip(*rows, strict=True)) or [()] * len(names)
    table = pa.table({name: pa.array(list(column)) for name, column in zip(names, columns, strict=True)})
    parquet.write_table(table, path, compression="zstd")
    return int(table.num_rows)
