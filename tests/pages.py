"""Pages whose Python is run, block after block: `python tests/pages.py PAGE …`, in this folder."""

import re
import sys
import tarfile
import time
from pathlib import Path

BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


def put_job(name):
    """Put the files into this folder that CalculiX makes of the job of a tutorial."""
    with tarfile.open(Path(__file__).parent / "calculix_pads.tar.xz") as archive:
        for ending in (".sti", ".mas", ".dof"):
            Path(name + ending).write_bytes(archive.extractfile("pad_springs" + ending).read())


def run_page(page):
    """Run all blocks of a page one after the other."""
    if Path(page).parts[-2:] == ("tutorials", "squeal.md"):
        put_job("pad")
    namespace = {"__name__": "__main__"}
    text = Path(page).read_text(encoding="utf-8")
    for block in BLOCK.finditer(text):
        line = text[: block.start()].count("\n") + 1
        # Blank lines keep the line numbers of a failure those of the page.
        exec(compile("\n" * line + block[1], str(page), "exec"), namespace)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        start = time.perf_counter()
        run_page(name)
        print(f"{Path(name).name}: {time.perf_counter() - start:.1f} s", flush=True)
