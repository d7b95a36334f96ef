#!/usr/bin/env python3
"""Opens the tables of a run and of a study as users do.

usage: check_tables.py RUN STUDY
"""
import sys

import pandas as pd
import pyarrow.parquet as pq

run, study = sys.argv[1:]
csv = pd.read_csv(f"{run}/history.csv", float_precision="round_trip")
parquet = pq.read_table(f"{run}/history.parquet").to_pandas()
# Every column and every bit, counts as whole numbers.
pd.testing.assert_frame_equal(parquet, csv, check_exact=True)
assert len(parquet) > 2 and parquet["step"].dtype.kind == "i" and parquet["F_N"].dtype.kind == "f", parquet.dtypes

table = pd.read_csv(f"{study}/study.csv")
ids = list(table["case"])
assert all(isinstance(case, str) for case in ids) and ids == [f"c{i + 1:04}" for i in range(len(ids))], ids
assert all(directory == f"cases/{case}" for case, directory in zip(ids, table["directory"])), table
print("all tables equal,", len(parquet), "steps,", len(ids), "cases")
