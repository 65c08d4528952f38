#!/usr/bin/env python3
"""Checks dask_campaign.py: two workers, one of them killed in the middle, the joined file compared with
that of one process.

    python check_dask_campaign.py CAMPAIGN FOLDER [MISSIONS]
"""

import filecmp
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from distributed import Client

import dask_campaign

SHARDS = 8


def kill_one(cluster, folder, seen):
    """Kills a worker in the middle of a part, once another part is complete."""
    while not (done := sorted(folder.glob("part-*.jsonl"))) or not list(folder.glob("*.tmp-*")):
        time.sleep(0.01)
    seen["before"] = {path.name: path.stat().st_mtime_ns for path in done}
    victim = next(iter(cluster.workers.values()))
    seen["killed"] = victim.pid
    os.kill(victim.pid, signal.SIGKILL)


def main(program, folder, missions):
    program, folder = dask_campaign.find_program(program), Path(folder)
    parts, one = folder / "parts", folder / "one.jsonl"
    parts.mkdir(parents=True)
    options = ["--missions", missions]
    arguments, options = dask_campaign.parse(
        ["--shards-dir", str(parts), "--workers", "2", "--shards", str(SHARDS), "--", *options]
    )
    seen = {}
    with dask_campaign.local_cluster(2) as cluster:
        killer = threading.Thread(target=kill_one, args=(cluster, parts, seen), daemon=True)
        killer.start()
        with Client(cluster) as client:
            failed = dask_campaign.fly_all(client, arguments, program, options, SHARDS)
        killer.join(timeout=10)
    assert not failed, failed
    assert "killed" in seen, "no worker was killed"
    flown_again = [name for name, at in seen["before"].items() if (parts / name).stat().st_mtime_ns != at]
    assert not flown_again, f"complete parts were flown again: {flown_again}"
    subprocess.run([program, "--merge", str(parts)], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([program, *options, "--out", str(one)], check=True, stdout=subprocess.DEVNULL)
    assert filecmp.cmp(parts / "campaign.jsonl", one, shallow=False), "the joined file differs from one process"
    print(f"{SHARDS} parts, worker {seen['killed']} killed, {missions} missions: as one process")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else "200")
