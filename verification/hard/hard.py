#!/usr/bin/env python3
"""Hard cases: where particle methods break, by four methods beside references made without the program.

    python3 verification/hard/hard.py                    all of them: build/hard/results.json and pictures
    python3 verification/hard/hard.py flight membrane    some
    python3 verification/hard/hard.py --publish          and doc/hard-cases.md; of some cases: these anew
    python3 verification/hard/hard.py --again            all runs once more, in a folder of their own: the same
    results.json to the bit?

A value outside its bound is a weakness; those that are known have their reason in the table. Ends with exit code 1
where one has none. The same executable gives the same results.json.
"""
import argparse
import json
import shutil
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import filling  # noqa: E402
import gas  # noqa: E402
import motion  # noqa: E402
import solids  # noqa: E402
import touching  # noqa: E402
import turning  # noqa: E402
from table import Table, common  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent.parent
CASES = {
    "alone": motion.alone,
    "flight": motion.flight,
    "single": motion.single,
    "thin": motion.thin,
    "drift": motion.drift,
    "units": motion.units,
    "taylor": solids.taylor,
    "membrane": solids.membrane,
    "vacuum": gas.vacuum,
    "grazing": touching.grazing,
    "ratios": touching.ratios,
    "rest": touching.rest,
    "penetrator": touching.penetrator,
    "spin": turning.spin,
    "slope": turning.slope,
    "charge": filling.charge,
    "gas": filling.gas,
    "stretch": filling.stretch,
    "debris": filling.debris,
}
HEAD = """# Hard cases

<!-- written by `make hard`; do not edit -->

Where particle methods break: nineteen cases, four methods, each beside a reference made without the program. Look
here for what is near your scene before you believe it.

* **Free flight, rotation.** What flies through the grid keeps its shape best with SGMP
  ([flight](#free-flight-through-100-cells)). What [spins](#free-disk-and-ring-that-turn) or
  [rolls](#cylinder-on-a-slope) wants `method sgmp rotation=exact` ([rotation.md](rotation.md)).
* **Thin parts** want at least [two particles](#plate-one-particle-thick) across, four to be safe.
* **Nearly incompressible material.** SGMP does not lock, but pressures of particles are rough from nu = 0.499 on
  ([Cook's membrane](#cooks-membrane-nearly-incompressible)).
* **Material stretched many times over**: [gas](#expansion-into-vacuum) and
  [solids](#bar-pulled-to-ten-times-its-length) want `split=0.75`; gas and explosives
  [between](#explosive-in-a-box-that-it-half-fills) [walls](#gas-that-expands-into-ten-times-its-room)
  `volumes=kept`, too ([volumes.md](volumes.md)).
* **Contact** keeps energy and momentum ([ratios](#density-ratio-104-stiffness-ratio-105), [blocks at
  rest](#blocks-at-rest-on-each-other), [penetrator](#sharp-penetrator-in-soft-metal)); bodies that
  [graze](#grazing-disks) each other with SGMP are deflected a tenth too little.

All of it is run anew by `make hard`, one case by `build/venv/bin/python verification/hard/hard.py flight`.
Geometry, material, loads and what is measured stand with each case, so that any code can repeat it; lengths, masses
and times are in any consistent units. h is the side of a cell, c the wave speed sqrt((lambda + 2 mu)/rho); unless
said otherwise 2 particles per cell and axis in the middle of cubes, plane strain in 2D, elasticity in rates
(hypo-elastic, Jaumann), `update=musl`, one thread. **Bold** values miss their bound; the reason follows the table.
"Verdict" is what the program said of its own runs ([verdict.md](verdict.md)); where only some methods are named,
the others were sound.
"""


def differences(before, after, whole):
    """What two results.json do not have in common, in words; only of what the second has where it is not the whole
    suite."""
    before, after = (
        {
            (row["case"], row["quantity"], method): cell
            for row in json.loads(path.read_text())["results"]
            for method, cell in row["methods"].items()
        }
        for path in (before, after)
    )
    return [
        f"{' | '.join(key)}: {before.get(key)} is now {after.get(key)}"
        for key in ({**before, **after} if whole else after)
        if before.get(key) != after.get(key)
    ]


def main():
    """All cases, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", choices=[*CASES, []], metavar="CASE", help="of " + ", ".join(CASES))
    parser.add_argument("--publish", action="store_true", help="write doc/hard-cases.md")
    parser.add_argument("--again", action="store_true", help="all runs anew, compared with build/hard/results.json")
    chosen = parser.parse_args()
    first = ROOT / "build/hard"
    if chosen.again:
        common.BUILD = first / "again"
        shutil.rmtree(common.BUILD, ignore_errors=True)
    table, started = Table(common.BUILD if chosen.again else first), time.monotonic()
    for name in chosen.cases or CASES:
        CASES[name](table)
    table.write("make hard")
    if chosen.publish:
        table.publish(ROOT / "doc/hard-cases.md", HEAD, keep=bool(chosen.cases))
    cells = list(table.cells())
    print(
        f"\n{len(cells)} values, {sum(not cell['met'] for *_, cell in cells)} outside their bounds; "
        f"{time.monotonic() - started:.0f} s"
    )
    for line in table.unexplained():
        print("no reason:", line)
    changed = (
        differences(first / "results.json", common.BUILD / "results.json", not chosen.cases) if chosen.again else []
    )
    for line in changed:
        print("not as before:", line)
    if chosen.again:
        print(f"{len(changed)} of {len(cells)} values differ from those of the run before")
    sys.exit(1 if table.unexplained() or changed else 0)


if __name__ == "__main__":
    main()
