#!/usr/bin/env python3
"""Writes the documents of `make doc` as a site. usage: site_pages.py SOURCE_DIR FOLDER

FOLDER/html/index.html is the start page. MkDocs has to be installed in the Python that runs this
(scripts/setup/setup.sh
--test or --dev does it); the pages of the programming interface are ford's and come from `make doc` alone.
"""
import glob
import os
import shutil
import subprocess
import sys

PAGES = (
    "*.md",
    "LICENSE",
    "doc/**",
    "input/*.inp",
    "input/gallery/**",
    "packaging/**",
    "tests/README.md",
    "python/README.md",
)


def copy_pages(source, pages):
    """The documents and what they show, as they lie in the sources."""
    for pattern in PAGES:
        for path in glob.glob(os.path.join(source, pattern), recursive=True):
            target = os.path.join(pages, os.path.relpath(path, source))
            if os.path.isfile(path):
                os.makedirs(os.path.dirname(target), exist_ok=True)
                shutil.copyfile(path, target)


def write_site(source, folder):
    """Pages of the documents in folder/html; what mkdocs says where it fails."""
    folder = os.path.abspath(folder)
    pages = os.path.join(folder, "pages")
    shutil.rmtree(folder, ignore_errors=True)
    copy_pages(source, pages)
    settings = shutil.copyfile(os.path.join(source, "doc", "mkdocs.yml"), os.path.join(folder, "mkdocs.yml"))
    words = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--config-file", settings]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return None if done.returncode == 0 else done.stdout + done.stderr


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0].split(". ")[1])
    sys.exit(write_site(sys.argv[1], sys.argv[2]))
