#!/usr/bin/env python3
"""Pages of `sgmp-view report` in a browser: every picture shown, nothing in the console, readable at two widths.

The browser is Chromium without a display (chromium of Debian, or what CHROMIUM names; scripts/setup/setup.sh --test
installs it). Without one the pages are only parsed: tags, pictures, nothing from elsewhere. Screenshots stay in the
scratch folder. The start page and three more of `make doc` are written here (by MkDocs, which the same set-up
installs) and looked at, too. What is missing is said at the end.

usage: pages.py SGMP SOURCE_DIR SCRATCH_DIR
"""

import base64
import functools
import html
import html.parser
import http.server
import importlib.util
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import threading

from _runs import ENVIRONMENT, SCRATCH, SGMP, SOURCE, Report

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
    print("skipped: numpy and matplotlib are not installed")
    sys.exit(77)
sys.path.insert(0, os.path.join(SOURCE, "python"))
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from _dumps import Cloud, lattice, write_run  # noqa: E402
from sgmp_view import command  # noqa: E402

WIDTHS = (1280, 400)
DOCUMENTS = {  # pages of `make doc` and what they are made of
    "index.html": "README.md",
    "doc/tasks.html": "doc/tasks.md",
    "doc/verdict.html": "doc/verdict.md",
    "doc/hard-cases.html": "doc/hard-cases.md",
}
DECK = """
title "A block that flies <fast> & far"
units mm g ms
dimension 2
grid cell=1 x=open y=open
method sgmp
time end=4 dt=0.1
material m elastic density=3 young=100 poisson=0
body arrow block material=m lower=(0,0) upper=(6,4) ppc=2
velocity arrow x=2 y=1
history steps=1
gauge corner point=(0,0)
output vtu every=1 fields=stress,pressure
"""
# Looks at the page as it is shown and writes what it has found into the page around it.
LOOK = """<script>window.addEventListener('load', () => {
  const images = [...document.images].map(i => [i.complete && i.naturalWidth > 0, i.getBoundingClientRect().width]);
  const texts = [...document.querySelectorAll('p,li,td,th,h1,h2,a,pre')].filter(e => e.textContent.trim());
  const scrolls = e => e && (['auto', 'scroll'].includes(getComputedStyle(e).overflowX) || scrolls(e.parentElement));
  const wide = texts.filter(e => e.getBoundingClientRect().right > innerWidth + 1 && !scrolls(e)
    && !e.closest('.wy-nav-side'));
  const root = document.documentElement;
  const found = {width: innerWidth, scroll: root.scrollWidth, images: images, texts: texts.length,
    least: Math.min(...texts.map(e => parseFloat(getComputedStyle(e).fontSize))), height: root.scrollHeight,
    wide: wide.map(e => e.textContent.slice(0, 40))};
  parent.document.getElementById('found' + location.pathname.match(/look_(\\d+)/)[1]).textContent =
    JSON.stringify(found);
});</script>"""
# A window cannot be narrower than 500 pixels, a frame in it can.
FRAME = """<script type="found" id="found%d"></script>
<iframe src="%s" style="border:0;width:%dpx;height:%dpx;flex:none"></iframe>"""
FRAMES = """<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<body style="margin:0;display:flex">%s</body>"""
HEIGHT = 900  # of a frame


class Tags(html.parser.HTMLParser):
    """Counts tags that are open and pictures; notes what comes from elsewhere."""

    def __init__(self):
        super().__init__()
        self.open, self.faults, self.pictures, self.elsewhere = [], [], [], []

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        if tag == "img":
            self.pictures.append(values)
        for key in ("src", "href"):
            if key in values and not values[key].startswith(("data:", "#")):
                self.elsewhere.append(values[key])
        if tag not in ("img", "meta", "link", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> at {self.getpos()}")


def parsed(report, path):
    """Tags closed in their order, pictures whole and named, nothing loaded from elsewhere; the number of pictures."""
    tags = Tags()
    with open(path, encoding="utf-8") as file:
        tags.feed(file.read())
    report.check(not tags.faults and not tags.open, f"{path}: {tags.faults[:3]} {tags.open[:3]}")
    report.check(not tags.elsewhere, f"{path}: not in the page: {tags.elsewhere[:3]}")
    for picture in tags.pictures:
        data = base64.b64decode(picture["src"].split(",", 1)[1])
        width, height = struct.unpack(">II", data[16:24])
        report.check(data[:8] == b"\x89PNG\r\n\x1a\n" and data[-8:-4] == b"IEND" and min(width, height) > 100,
                     f"{path}: a picture of {width} x {height}")  # fmt: skip
        report.check(picture.get("alt"), f"{path}: a picture without words")
    return len(tags.pictures)


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves the scratch folder: the search of `make doc` does not work from files."""

    def log_message(self, *words):
        pass


def browser():
    """The program, or None."""
    names = (os.environ.get("CHROMIUM"), "chromium", "chromium-browser", "google-chrome")
    return next((shutil.which(name) for name in names if name and shutil.which(name)), None)


def called(program, *words):
    """The browser without a display; what it prints and what it says."""
    common = [program, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"]
    common += [f"--user-data-dir={SCRATCH}/browser", "--enable-logging=stderr"]
    done = subprocess.run([*common, *words], capture_output=True, text=True, timeout=120, check=False, env=ENVIRONMENT)
    return done.stdout, done.stderr


def shown(program, looks, host):
    """What each page says of itself once it is shown in a frame of its width; lines of the console; a picture of all,
    side by side, which stays in the scratch folder. One browser for all: it starts slowly."""
    frames, sheet = [], os.path.join(SCRATCH, "sheet.png")
    for number, (path, width) in enumerate(looks):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        copy = os.path.join(os.path.dirname(path), f"look_{number}.html")
        with open(copy, "w", encoding="utf-8") as file:
            file.write(text.replace("</body>", LOOK + "</body>"))
        frames.append(FRAME % (number, f"{host}/{os.path.relpath(copy, SCRATCH)}", width, HEIGHT))
    with open(os.path.join(SCRATCH, "frames.html"), "w", encoding="utf-8") as file:
        file.write(FRAMES % "".join(frames))
    page = f"{host}/frames.html"
    dom, said = called(program, "--dump-dom", page)
    wide = sum(width for _, width in looks)
    _, later = called(program, f"--window-size={wide},{HEIGHT}", "--virtual-time-budget=10000",
                      f"--screenshot={sheet}", page)
    for number, (path, _) in enumerate(looks):
        os.remove(os.path.join(os.path.dirname(path), f"look_{number}.html"))
    found = {int(number): json.loads(html.unescape(text))
             for number, text in re.findall(r'<script type="found" id="found(\d+)">(.+?)</script>', dom)}
    console = [line for line in (said + later).splitlines() if "CONSOLE" in line and "Lunr index" not in line]
    return found, console, sheet if os.path.exists(sheet) else None


def looked_at(report, program, pages_of, host):
    """Pages at both widths: pictures are shown and as wide as a third of it, texts are not cut off."""
    looks = [(path, width) for path, _ in pages_of for width in WIDTHS]
    counts = [pictures for _, pictures in pages_of for _ in WIDTHS]
    all_found, console, sheet = shown(program, looks, host)
    report.check(not console, f"console: {console[:3]}")
    report.check(sheet, "no screenshot")
    picture = plt.imread(sheet)[..., :3] if sheet else np.zeros((1, 1, 3))
    start = 0
    for number, ((path, width), pictures) in enumerate(zip(looks, counts)):
        what = f"{os.path.basename(path)} at {width}"
        strip = picture[:, start:start + width]
        start += width
        report.check(strip.size and np.ptp(strip, axis=(0, 1)).max() > 0.5, f"{what}: the screenshot is empty")
        found = all_found.get(number)
        if not report.check(found, f"{what}: not shown"):
            continue
        report.check(found["width"] == width and found["scroll"] <= width, f"{what}: {found['scroll']} pixels wide")
        report.check(not found["wide"], f"{what}: cut off: {found['wide'][:3]}")
        report.check(found["least"] >= 10, f"{what}: letters of {found['least']} pixels")
        report.check(found["texts"] > 5, f"{what}: {found['texts']} texts")
        report.check(len(found["images"]) == pictures, f"{what}: {len(found['images'])} pictures of {pictures}")
        for complete, across in found["images"]:
            report.check(complete and 150 <= across <= width, f"{what}: a picture {across} wide, complete: {complete}")


def pages(report):
    """Reports of a run in the plane with gauges, and of a made one in space with a plug, spall and failed matter."""
    with open("block.inp", "w", encoding="utf-8") as deck:
        deck.write(DECK)
    subprocess.run([SGMP, "block.inp", "--quiet", "--output", "block.out"], check=True, env=ENVIRONMENT)
    points = lattice((-10, -10, -3), (10, 10, 0), 0.5)
    flying = Cloud(lattice((-1, -1, 1), (1, 1, 3), 0.5), (0, 0, -100))
    after = Cloud(points)
    far = np.hypot(points[:, 0], points[:, 1])
    pieces = np.floor(np.arctan2(points[:, 1], points[:, 0]) / (np.pi / 3))
    for number in range(-3, 3):  # six sectors of a plug fly on
        chosen = (far < 6) & (pieces == number)
        angle = (number + 0.5) * np.pi / 3
        after.points[chosen] += (4 * np.cos(angle), 4 * np.sin(angle), -12 - number)
        after.velocity[chosen] = (0, 0, -30 - number)
    after.failed[(far > 6) & (far < 7)] = True
    start = {"ball": flying, "plate": Cloud(points)}
    end = {"ball": Cloud(flying.points - (0, 0, 30), (0, 0, -60)), "plate": after}
    write_run("plug.out", [(0, start), (1, end)], spacing=0.5, cell=1.0)
    for name in ("block", "plug"):
        try:
            command.main(["report", f"{name}.out", "-o", f"{name}.html"])
        except SystemExit as end:
            report.check(not end.code, f"sgmp-view report {name}.out: {end.code}")


def documents(report):
    """Pages of `make doc` with the number of pictures that the source names."""
    sys.path.insert(0, os.path.join(SOURCE, "scripts", "dev"))
    from site_pages import write_site

    said = write_site(SOURCE, os.path.join(SCRATCH, "site"))
    site = os.path.join(SCRATCH, "site", "html")
    if not report.check(not said, f"mkdocs: {said}"):
        return []
    written = []
    for name, source in DOCUMENTS.items():
        with open(os.path.join(SOURCE, source), encoding="utf-8") as file:
            pictures = len(re.findall(r"!\[[^]]*\][\[(]", file.read()))
        path = os.path.join(site, name)
        if report.check(os.path.exists(path), f"{name} is not written"):
            written.append((path, pictures))
    return written


def main():
    """All of it."""
    report = Report()
    os.chdir(SCRATCH)
    pages(report)
    program = browser()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=SCRATCH))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    host = f"http://127.0.0.1:{server.server_port}"
    written = [(os.path.join(SCRATCH, f"{name}.html"), pictures) for name, pictures in (("block", 8), ("plug", 8))]
    for path, pictures in written:
        report.check(parsed(report, path) == pictures, f"{path}: {pictures} pictures")
    if importlib.util.find_spec("mkdocs"):
        written += documents(report)
    else:
        print("not looked at: pages of `make doc`; missing: MkDocs (pip install 'mkdocs>=1.6,<2')")
    if program:
        looked_at(report, program, written, host)
    server.shutdown()
    if not program:
        print("parsed, not shown; missing: Chromium (Debian, Ubuntu: apt-get install chromium; or CHROMIUM=PROGRAM)")
    report.end()


main()
