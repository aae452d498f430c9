"""What each effect costs, alone and together with all others.

The scene is two forced rows with Coulomb contact, by "verlet".  "Alone" is the scene with one
effect less that without it.  "Together" is the scene with all effects less that without this one.
Effects that replace one another are measured alone only.  "sums alone" and "no ledger" keep less
than the works of every asperite, and save time.  The loops are timed in turn, and the
shortest of all calls counts.  Every loop is compiled in a process of its own with an empty cache.
The rows of by_hand.py come first.

    python benchmarks/effects.py [--json] [--quick] [--rounds N] [--only EFFECT ...]

--quick takes one effect that every kick meets, and one that a plug-in computes, and compiles their
loops once, in this process: no seconds to compile.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from typing import Any

import by_hand
from effect_scenes import APART, NEEDS, TOGETHER, scene, with_needs

from tribo.explanation.prediction import bytes_of_run
from tribo.integrators.methods import METHODS
from tribo.kernels.status import PAUSED
from tribo.layout.layout import lay_out
from tribo.loops.general import GeneralLoop, compile_loop
from tribo.loops.setting import Setting

# Set in processes whose cache was empty.
EMPTY = "TRIBO_EMPTY_CACHE"

# The effects of --quick.
QUICK = ["springs", "own drive"]

# Step of all loops [time].
STEP = 1e-3

Effects = frozenset[str]
METHOD = METHODS["verlet"]
EVERYTHING: Effects = frozenset(TOGETHER)


class Loop:
    """The time loop of the scene with some effects."""

    def __init__(self, effects: Effects) -> None:
        self._layout = lay_out(scene(effects))
        self._loop = GeneralLoop(self._layout, METHOD, Setting(step=STEP), self._layout.start, 0.0)
        self._times = self._layout.times
        self._columns = self._loop.room(self._times.size)

    def run(self, steps: int) -> None:
        """Take steps from the present state."""
        code = PAUSED
        target = int(self._loop.clocks["steps"][0]) + steps
        while int(self._loop.clocks["steps"][0]) < target:
            left = target - int(self._loop.clocks["steps"][0])
            code = self._loop.advance(self._times, self._columns, left)
            assert code == PAUSED, code

    @property
    def asperites(self) -> int:
        """How many there are."""
        return self._layout.scene.count

    @property
    def bytes(self) -> float:
        """Bytes an asperite."""
        return bytes_of_run(self._layout, METHOD, 1, compared=False) / self.asperites


def less(effects: Effects, effect: str) -> Effects:
    """The effects without one, and without those that need it."""
    return frozenset(e for e in effects if e != effect and effect not in NEEDS.get(e, ()))


def variants(chosen: list[str]) -> list[Effects]:
    """All scenes that are timed."""
    found = [frozenset(), EVERYTHING]
    for effect in chosen:
        found += [with_needs(effect), with_needs(effect) - {effect}]
        found += [] if effect in APART else [less(EVERYTHING, effect)]
    return list(dict.fromkeys(found))


def compile_seconds(effects: Effects) -> float:
    """Seconds of processor time to compile the loop of a scene, with a cache of its own."""
    command = [sys.executable, __file__, "--compile", *sorted(effects)]
    with tempfile.TemporaryDirectory() as cache:
        place = os.environ | {"NUMBA_CACHE_DIR": cache}
        done = subprocess.run(command, env=place, stdout=subprocess.PIPE, text=True, check=True)
    return float(done.stdout)


def nanoseconds(chosen: list[str], rounds: int) -> dict[Effects, float]:
    """Nanoseconds a step and asperite of every scene, timed in turn."""
    loops = {effects: by_hand.timed(Loop(effects)) for effects in variants(chosen)}
    found = dict.fromkeys(loops, math.inf)
    for _ in range(rounds):
        for effects, (loop, steps) in loops.items():
            each = by_hand.nanoseconds(loop, steps) / loop.asperites
            found[effects] = min(found[effects], each)
    return found


def table(chosen: list[str], rounds: int, compiling: bool) -> list[dict[str, Any]]:
    """A row for the scene without effects, one for each effect, and one for all of them.

    Seconds to compile are NaN without `compiling`.
    """
    compiled = {
        effects: compile_seconds(effects) if compiling else math.nan for effects in variants(chosen)
    }
    times = nanoseconds(chosen, rounds)
    sizes = {effects: Loop(effects).bytes for effects in times}

    def whole(name: str, effects: Effects) -> dict[str, Any]:
        seconds = compiled[effects]
        return {"effect": name, "ns": times[effects], "bytes": sizes[effects]} | {
            "compile_seconds": seconds
        }

    found = [whole("none", frozenset())]
    for effect in chosen:
        on, off = with_needs(effect), with_needs(effect) - {effect}
        row = {
            "effect": effect,
            "alone_ns": times[on] - times[off],
            "alone_share": 1.0 - times[off] / times[on],
            "bytes": sizes[on] - sizes[off],
            "compile_seconds": compiled[on] - compiled[off],
        }
        if effect not in APART:
            others = less(EVERYTHING, effect)
            row["together_ns"] = times[EVERYTHING] - times[others]
            row["together_share"] = 1.0 - times[others] / times[EVERYTHING]
        found.append(row)
    return [*found, whole("all", EVERYTHING)]


def measure(chosen: list[str], rounds: int, quick: bool = False) -> dict[str, Any]:
    """Both tables; if `quick`, that of the effects alone, without seconds to compile."""
    effects = table(chosen, rounds, compiling=not quick)
    return {"effects": effects, "rows": [] if quick else by_hand.rows(rounds)}


def with_empty_cache(arguments: list[str]) -> int:
    """Run this program in a process whose cache of machine code is empty."""
    with tempfile.TemporaryDirectory() as cache:
        place = os.environ | {"NUMBA_CACHE_DIR": cache, EMPTY: cache}
        return subprocess.run([sys.executable, __file__, *arguments], env=place).returncode


def report(found: dict[str, Any]) -> str:
    """The tables as text."""
    lines = [
        f"{row['scene']:<16} {row['tribo_ns']:8.0f} ns a step, by hand {row['by_hand_ns']:8.0f}"
        for row in found["rows"]
    ]
    lines += [
        "",
        "ns an asperite and step, share of the whole; bytes an asperite; seconds to compile",
    ]
    for row in found["effects"]:
        alone, together = row.get("alone_ns", row.get("ns")), row.get("together_ns", math.nan)
        shares = [100.0 * row.get(f"{key}_share", math.nan) for key in ("alone", "together")]
        lines.append(
            f"{row['effect']:<16} alone {alone:7.1f} ({shares[0]:4.1f} %), together "
            f"{together:7.1f} ({shares[1]:4.1f} %), {row['bytes']:6.0f} B, "
            f"{row['compile_seconds']:5.1f} s"
        )
    return "\n".join(lines)


def main() -> None:
    """Measure all effects, or compile one loop for it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--quick", action="store_true", help="few effects, in three minutes")
    parser.add_argument("--rounds", type=int, default=by_hand.ROUNDS)
    parser.add_argument("--only", nargs="+", choices=[*TOGETHER, *APART], metavar="EFFECT")
    parser.add_argument("--compile", nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.compile is not None:
        layout = lay_out(scene(frozenset(options.compile)))
        began = time.process_time()
        compile_loop(layout, METHOD)
        print(time.process_time() - began)
        return
    if EMPTY not in os.environ and not options.quick:
        sys.exit(with_empty_cache(sys.argv[1:]))
    chosen = options.only or (QUICK if options.quick else [*TOGETHER, *APART])
    found = measure(chosen, options.rounds, options.quick)
    print(json.dumps(found, indent=1) if options.json else report(found))


if __name__ == "__main__":
    main()
