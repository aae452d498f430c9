"""Run random scenes and judge every recorded number by a reference that shares no code.

    python benchmarks/random_scenes.py --seeds 0:1000 --out random.jsonl [--failures DIR]
    python benchmarks/random_scenes.py --store 0,5,450

It needs a C compiler and Linux's /proc.  FILE gets a line for each seed; seeds that it has already
are not run again, so that a run continues where it stopped.  Scenes that fail are written to DIR as
scene files.  At the end it prints how many scenes there were, every outcome, and each failure on a
line.  A scene that gives no answer within HANG seconds of the processor is a hang; its process is
ended.  What else the machine does changes no outcome.

Seeds from 1000000 on have tiny or huge energies of interaction beside torsion springs of any
stiffness; `--seeds 1000000:1002000` runs 2000 of them.

The second form adds scenes and their references to those of tests/accuracy/test_random_scenes.py.
"""

import argparse
import json
import os
import select
import subprocess
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

# Seconds of the processor without an answer that count as a hang: a run is interrupted after 15,
# and a second solution in quadruple precision can take 150.
HANG = 400.0
# Seconds between two looks at the processor's time.
INTERVAL = 1.0
# Outcomes that are failures.
FAILURES = ("silent", "boast", "warning", "traceback", "hang", "slow", "crash")


def main() -> None:
    """Run the seeds that the file lacks, then summarise the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="0:1000", help="first:last, the last excluded")
    parser.add_argument("--out", type=Path, default=Path("random.jsonl"))
    parser.add_argument("--failures", type=Path)
    parser.add_argument("--store", help="seeds of the scenes to store for the tests")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        return serve()
    if options.store:
        return store([int(seed) for seed in options.store.split(",")])
    first, last = map(int, options.seeds.split(":"))
    done = {row["seed"] for row in rows_of(options.out)}
    worker = Worker()
    with options.out.open("a", encoding="utf-8") as file:
        for seed in range(first, last):
            if seed not in done:
                row = {"seed": seed} | worker.ask(seed)
                file.write(json.dumps(row) + "\n")
                file.flush()
                if row["outcome"] in FAILURES:
                    print(line_of(row), flush=True)
                    keep(options.failures, seed, row)
    worker.end()
    summarise([row for row in rows_of(options.out) if first <= row["seed"] < last])
    return None


def rows_of(path: Path) -> list[dict]:
    """The lines of a file of verdicts."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


class Worker:
    """A process that judges scenes, and is started again when one hangs."""

    def __init__(self) -> None:
        self.process: subprocess.Popen[str] | None = None

    def ask(self, seed: int) -> dict:
        """The verdict on a seed."""
        if self.process is None:
            command = [sys.executable, __file__, "--serve"]
            pipe = subprocess.PIPE
            self.process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
        asked, answers = self.process.stdin, self.process.stdout
        assert asked is not None and answers is not None
        asked.write(f"{seed}\n")
        asked.flush()
        began, ready = cpu_seconds(self.process.pid), []
        while not ready and cpu_seconds(self.process.pid) - began < HANG:
            ready, _, _ = select.select([answers], [], [], INTERVAL)
        line = answers.readline() if ready else ""
        if line:
            return json.loads(line)
        self.process.kill()
        self.process.wait()
        crashed, self.process = bool(ready), None
        return {"outcome": "crash" if crashed else "hang"}

    def end(self) -> None:
        """End the process."""
        if self.process is not None and self.process.stdin is not None:
            self.process.stdin.close()
            self.process.wait()


def cpu_seconds(process: int) -> float:
    """Time of the processor that a process has used [s]."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def serve() -> None:
    """Answer each seed on the standard input with a verdict on the standard output."""
    from support.verdicts import judged
    from support.wide_scenes import wide_scene

    for line in sys.stdin:
        print(json.dumps(judged(wide_scene(int(line)))), flush=True)


def store(seeds: list[int]) -> None:
    """Add scenes and their solutions to those of the default tests."""
    from support.reference import solve
    from support.verdicts import STORED
    from support.wide_scenes import wide_scene

    rows = {row["seed"]: row for row in json.loads(STORED.read_text(encoding="utf-8"))}
    for seed in seeds:
        table = wide_scene(seed)
        rows[seed] = {"seed": seed, "scene": table, "solution": solve(table).as_table()}
    lines = ",\n".join(json.dumps(rows[seed], separators=(",", ":")) for seed in sorted(rows))
    STORED.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


def keep(folder: Path | None, seed: int, row: dict) -> None:
    """Write a scene that failed as a scene file, with the verdict as its first line."""
    if folder is None:
        return
    from support.wide_scenes import wide_scene
    from tribo.model.scene_file import scene_from

    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{row['outcome']}_{seed}.toml"
    scene_from(wide_scene(seed)).save(path)
    path.write_text(f"# {line_of(row)}\n" + path.read_text(encoding="utf-8"), encoding="utf-8")


def line_of(row: dict) -> str:
    """One line about a verdict."""
    return ", ".join(f"{key} {value}" for key, value in row.items())


def summarise(rows: list[dict]) -> None:
    """Print all outcomes and all failures."""
    print(f"{len(rows)} scenes")
    for outcome, count in Counter(row["outcome"] for row in rows).most_common():
        print(f"{count:6} {outcome}")
    for status, count in Counter(r["status"] for r in rows if r["outcome"] == "stopped").items():
        print(f"{count:6} stopped with {status}")
    for row in rows:
        if row["outcome"] in FAILURES:
            print(line_of(row))


if __name__ == "__main__":
    main()
