#!/usr/bin/env python3
"""Flies a campaign in parts on a Dask cluster, and joins the parts.

Each part is one `campaign --shard I/N` process, so a crash costs a part and no more. Parts that are in
the folder are not flown again: start the same command again after an interruption. Options after `--`
go to `campaign`.

    python dask_campaign.py --shards-dir parts --workers 2 -- --missions 20000
    python dask_campaign.py --shards-dir parts --scheduler tcp://node1:8786 -- --missions 1000000

With --scheduler, program, folder and mission files must have the same paths on every machine.
"""

import argparse
import ctypes
import json
import logging
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import dask
from distributed import Client, LocalCluster, as_completed

ROOT = Path(__file__).resolve().parents[2]
# What a part should last: long beside the start of a process, short beside a lost machine.
SHORTEST_S, LONGEST_S = 30.0, 300.0
MOST_SHARDS = 1_000_000
# Parts that each worker flies at least, where they last SHORTEST_S or more.
PARTS_A_WORKER = 20
# Workers only start processes and wait. Dask's profiler, ticks and memory monitor would cost a tenth of a core.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.scheduler.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.worker.memory.monitor-interval": "5s",
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.terminate": False,
}
# Missions flown to learn how long one takes.
SAMPLE = 20


def die_with_parent():
    """Ends the child when its Dask worker is killed (Linux), before it execs."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


def fly(program, options, data, shard, shards, folder):
    """Flies one part on a worker. Bad input is returned: to try it again would not help."""
    command = [program, *options, "--threads", "1", "--json"]
    command += ["--shard", f"{shard}/{shards}", "--shards-dir", folder]
    before = die_with_parent if sys.platform == "linux" else None
    done = subprocess.run(
        command, capture_output=True, text=True, preexec_fn=before, check=False, env={**os.environ, **data}
    )
    if done.returncode == 2:
        return done.stderr.strip()
    if done.returncode != 0:
        raise RuntimeError(f"part {shard}: exit code {done.returncode}: {done.stderr[-2000:].strip()}")
    return None


def runs_and_seconds(program, options):
    """The number of runs of the whole campaign, and the seconds that one takes on one thread."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--missions", type=int, default=100)
    parser.add_argument("--faults")
    given = parser.parse_known_args(options)[0]
    missions = given.missions
    # With faults a mission is many runs.
    sample = min(1 if given.faults else SAMPLE, missions)
    if sample == 0:
        return 0, 0.0
    started = time.monotonic()
    command = [program, *without(options, "--missions"), "--missions", str(sample), "--threads", "1", "--json"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.returncode)
    answer = json.loads(done.stdout)
    flown = answer.get("runs", sample)
    return missions * flown // sample, (time.monotonic() - started) / flown


def without(options, name):
    """The options without one that has a value."""
    kept, skip = [], False
    for word in options:
        if skip:
            skip = False
        elif word == name:
            skip = True
        elif not word.startswith(name + "="):
            kept.append(word)
    return kept


def number_of_parts(arguments, program, options, workers):
    """The parts that the folder was begun with, those asked for, or as many as last --seconds each."""
    manifest = Path(arguments.shards_dir, "manifest.json")
    if manifest.exists():
        try:
            begun = json.loads(manifest.read_text(encoding="utf-8"))["shards"]
        except (ValueError, KeyError, TypeError):
            sys.exit(f"{manifest}: is not a manifest of a campaign: give an empty folder")
        if arguments.shards not in (None, begun):
            sys.exit(f"{manifest}: the folder was begun with {begun} parts: leave out --shards")
        return begun
    if arguments.shards is not None:
        return arguments.shards
    runs, seconds = runs_and_seconds(program, options)
    total_s = runs * seconds
    parts = max(total_s / arguments.seconds, min(PARTS_A_WORKER * workers, total_s / SHORTEST_S), 1)
    # As many for each worker, so that none waits long for the last parts.
    parts = -(-int(parts) // workers) * workers
    return min(parts, max(runs, 1), MOST_SHARDS)


def fly_all(client, arguments, program, options, shards):
    """Flies what is missing; gives the parts that failed with the reason of each."""
    folder = str(Path(arguments.shards_dir).resolve())
    missing = [i for i in range(shards) if not Path(folder, f"part-{i:06}.jsonl").exists()]
    bar = Bar(shards, shards - len(missing))
    # Workers look for data where this process does.
    data = {name: os.environ[name] for name in ("AUV_DATA_DIR",) if name in os.environ}
    # If no part is missing, part 0 is asked for: `campaign` then compares the options with those that the
    # folder was begun with.
    futures = {
        client.submit(fly, program, options, data, i, shards, folder, retries=arguments.retries, pure=False): i
        for i in missing or [0]
    }
    failed, workers = {}, set(client.nthreads())
    for future in as_completed(list(futures)):
        if future.status == "finished":
            refused = future.result()
            if refused:
                client.cancel(list(futures))
                bar.end()
                print(refused, file=sys.stderr)
                sys.exit(2)
        else:
            failed[futures[future]] = future.exception()
        if missing:
            bar.one()
    bar.end()
    if lost := workers - set(client.nthreads()):
        print(f"workers lost: {len(lost)}; their parts were flown again", file=sys.stderr)
    return failed


class Bar:
    """Parts done, rate and time left on stderr, where it is a terminal."""

    def __init__(self, total, done):
        self.total, self.done, self.before = total, done, done
        self.started = time.monotonic()
        self.shown = sys.stderr.isatty()
        print(f"{total} parts, {done} of them there", file=sys.stderr)

    def one(self):
        self.done += 1
        if not self.shown:
            return
        rate = (self.done - self.before) / max(time.monotonic() - self.started, 1e-3)
        left = (self.total - self.done) / rate
        width = 40 * self.done // self.total
        print(
            f"\r\x1b[K[{'#' * width}{'.' * (40 - width)}] {self.done}/{self.total} parts, {left:.0f} s left",
            end="", file=sys.stderr, flush=True,
        )

    def end(self):
        if self.shown:
            print(file=sys.stderr)


def find_program(given):
    """The campaign program: as given, on the PATH, or as cargo builds it."""
    built = ROOT / "target" / "release" / "examples" / "campaign"
    if given is None:
        given = shutil.which("campaign") or (str(built) if built.exists() else None)
    if given is None:
        sys.exit("no campaign program: give --campaign, or run `cargo build --release --example campaign`")
    return str(Path(given).resolve())


def parse(words):
    parser = argparse.ArgumentParser(
        description=__doc__, allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shards-dir", required=True, help="folder of the parts, on a file system all workers see")
    parser.add_argument("--scheduler", help="address of a running Dask scheduler (default: a cluster of this machine)")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="workers of the local cluster (default: all cores)")
    parser.add_argument("--shards", type=int, help="number of parts (default: from --seconds)")
    parser.add_argument("--seconds", type=float, default=60.0, help="what a part should last, 30 to 300 s (default: 60)")
    parser.add_argument("--retries", type=int, default=3, help="how often a part that crashes is tried again (default: 3)")
    parser.add_argument("--campaign", help="the campaign program (default: on the PATH, else target/release/examples)")
    own, options = words, []
    if "--" in words:
        at = words.index("--")
        own, options = words[:at], words[at + 1:]
    arguments = parser.parse_args(own)
    if not SHORTEST_S <= arguments.seconds <= LONGEST_S:
        parser.error(f"--seconds is {arguments.seconds}: give {SHORTEST_S:.0f} to {LONGEST_S:.0f}")
    if arguments.shards is not None and not 1 <= arguments.shards <= MOST_SHARDS:
        parser.error(f"--shards is {arguments.shards}: give 1 to {MOST_SHARDS}")
    if arguments.workers < 1:
        parser.error(f"--workers is {arguments.workers}: give at least 1")
    for name in ("--shard", "--shards-dir", "--merge", "--out", "--threads", "--json", "--replay", "--table"):
        if any(word == name or word.startswith(name + "=") for word in options):
            parser.error(f"{name} after `--` is given by this script: leave it out")
    return arguments, [str(Path(word).resolve()) if Path(word).is_file() else word for word in options]


def local_cluster(workers):
    """Workers on this machine that only this machine reaches."""
    dask.config.set(QUIET)
    # What fails is reported by fly_all; Dask would log each heartbeat that fails while the cluster closes.
    return LocalCluster(
        n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, silence_logs=logging.CRITICAL
    )


@contextmanager
def connect(arguments):
    """A client of the scheduler given, or of one on this machine."""
    if arguments.scheduler:
        with Client(arguments.scheduler) as client:
            yield client
        return
    with local_cluster(arguments.workers) as cluster, Client(cluster) as client:
        yield client


def main(words):
    arguments, options = parse(words)
    program = find_program(arguments.campaign)
    with connect(arguments) as client:
        workers = sum(client.nthreads().values())
        shards = number_of_parts(arguments, program, options, max(workers, 1))
        failed = fly_all(client, arguments, program, options, shards)
    for shard, why in sorted(failed.items()):
        print(f"part {shard} failed: {why}", file=sys.stderr)
    # The merge names what is missing, with the command that flies it.
    return subprocess.run([program, "--merge", arguments.shards_dir], check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
