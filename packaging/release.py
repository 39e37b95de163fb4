"""What a release changes in the repository: version, citation, changelog, addresses.

    python packaging/release.py bump 0.2.0 --dry-run    shows what would change
    python packaging/release.py bump 0.2.0              changes it, all files or none
    python packaging/release.py check v0.2.0            fails unless all files are of this version
    python packaging/release.py notes 0.2.0             prints the section of the changelog
    python packaging/release.py address SITE REPOSITORY changes where the project lives

It needs Python 3.11 or newer and nothing else. RELEASING.md says when to run it.
"""

from __future__ import annotations

import argparse
import datetime
import difflib
import io
import os
import re
import secrets
import sys
import tomllib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CRATES = ("asperity", "asperity-py", "asperity-set")
"""Of the workspace's version; others are not published and have versions of their own."""
ADDRESSED = (
    "CITATION.cff",
    "Cargo.toml",
    "README.md",
    "RELEASING.md",
    "packaging/conda/recipe.yaml",
    "pyproject.toml",
)
"""Files that hold addresses of the project."""

_VERSION = re.compile(r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)(?:-rc\.([1-9]\d*))?")


class ReleaseError(Exception):
    """Why a release cannot be made, in words for the person who makes it."""


def rank(version: str) -> tuple[int, int, int, float]:
    """Return what versions are ordered by: a candidate comes before its release."""
    match = _VERSION.fullmatch(version)
    if not match:
        raise ReleaseError(f"a version is 1.2.3 or 1.2.3-rc.4, got {version!r}")
    major, minor, patch, candidate = match.groups()
    return int(major), int(minor), int(patch), float(candidate or "inf")


def versions(root: Path) -> dict[str, str]:
    """Return the version that every place in the repository states."""
    manifest = tomllib.loads(_read(root / "Cargo.toml"))["workspace"]
    found = {"Cargo.toml": manifest["package"]["version"]}
    for name in ("asperity", "asperity-set"):
        found[f"Cargo.toml, dependency {name}"] = manifest["dependencies"][name]["version"]
    locked = tomllib.loads(_read(root / "Cargo.lock"))["package"]
    found |= {f"Cargo.lock, {p['name']}": p["version"] for p in locked if p["name"] in CRATES}
    citation = re.search(r"^version: (\S+)$", _read(root / "CITATION.cff"), re.M)
    found["CITATION.cff"] = citation[1] if citation else "none"
    return found


def current(root: Path) -> str:
    """Return the version of the repository.

    Raises:
        ReleaseError: if places disagree.
    """
    found = versions(root)
    if len(set(found.values())) > 1:
        places = "\n".join(f"  {place}: {version}" for place, version in found.items())
        raise ReleaseError(f"the places that state the version disagree:\n{places}")
    return found["Cargo.toml"]


def notes(root: Path, version: str) -> str:
    """Return the section of a version in the changelog, without its heading."""
    text = _read(root / "CHANGELOG.md")
    match = re.search(
        rf"^## \[{re.escape(version)}\].*?\n(.*?)(?=^## \[|\Z)", text, re.M | re.DOTALL
    )
    if not match:
        raise ReleaseError(f"CHANGELOG.md has no section [{version}]")
    return match[1].strip() + "\n"


def check(root: Path, tag: str) -> None:
    """Compare a tag with all places that state the version.

    Raises:
        ReleaseError: naming what differs.
    """
    version = current(root)
    if tag != f"v{version}":
        raise ReleaseError(f"the tag is {tag}, the repository is of version {version}")
    if not notes(root, version).strip():
        raise ReleaseError(f"the section [{version}] of CHANGELOG.md is empty")


def bumped(root: Path, version: str, date: datetime.date) -> dict[Path, str]:
    """Return the new text of every file that a new version changes.

    Raises:
        ReleaseError: if the version is not a later one, or nothing has changed since the last. A
            release after its own candidates needs no change: it takes over their sections.
    """
    old = current(root)
    if rank(version) <= rank(old):
        raise ReleaseError(f"the new version must be later than {old}, got {version}")
    if not notes(root, "Unreleased").strip() and version != old.partition("-rc.")[0]:
        raise ReleaseError("the section [Unreleased] of CHANGELOG.md is empty")
    quoted = re.escape(old)
    changes: dict[str, Callable[[str], str]] = {
        "Cargo.toml": lambda text: _replaced(
            text, rf'(version = "){quoted}"', rf'\g<1>{version}"', 3
        ),
        "Cargo.lock": lambda text: _replaced(
            text,
            rf'(name = "(?:{"|".join(CRATES)})"\nversion = "){quoted}"',
            rf'\g<1>{version}"',
            len(CRATES),
        ),
        "CITATION.cff": lambda text: _replaced(
            re.sub(r"^date-released: .*\n", "", text, flags=re.M),
            rf"^version: {quoted}$",
            f"version: {version}\ndate-released: {date.isoformat()}",
            1,
        ),
        "CHANGELOG.md": lambda text: _replaced(
            _with_candidates(text, version),
            r"^## \[Unreleased\]$",
            f"## [Unreleased]\n\n## [{version}] - {date}",
            1,
        ),
    }
    return {root / name: change(_read(root / name)) for name, change in changes.items()}


def _with_candidates(text: str, version: str) -> str:
    """Return the changelog in which what the candidates of a version brought is unreleased again.

    Whoever reads of the version wants to know what has changed since the version before.
    """
    candidate = re.compile(
        rf"^## \[{re.escape(version)}-rc\.\d+\].*?\n(.*?)(?=^## \[|\Z)", re.M | re.DOTALL
    )
    brought = candidate.findall(text)
    unreleased = re.compile(r"(^## \[Unreleased\]\n)(.*?)(?=^## \[|\Z)", re.M | re.DOTALL)
    fresh = unreleased.search(text)
    if not brought or fresh is None:
        return text
    # Groups such as "### Fixed" come once, with the newest entries first.
    groups: dict[str, list[str]] = {}
    for part in (fresh[2], *brought):
        first, *others = re.split(r"^(?=### )", part, flags=re.M)
        for group in ("\n" + first, *others):
            title, _, body = group.partition("\n")
            groups.setdefault(title, []).append(body.strip())
    written = (
        "\n\n".join([title] * bool(title) + [body for body in bodies if body])
        for title, bodies in groups.items()
    )
    whole = "\n\n".join(group for group in written if group)
    return unreleased.sub(lambda match: f"{match[1]}\n{whole}\n\n", candidate.sub("", text), 1)


def readdressed(root: Path, site: str, repository: str) -> dict[Path, str]:
    """Return the new text of every file that holds an address of the project.

    Raises:
        ReleaseError: if an address is not one.
    """
    if not re.fullmatch(r"https://[\w-]+(\.[\w-]+)+(/[\w.-]+)*", site):
        raise ReleaseError(
            f"the address of the site is https://host or https://host/path: {site!r}"
        )
    if not re.fullmatch(r"https://github\.com/[\w.-]+/[\w.-]+", repository):
        # Pictures and pages are linked by the paths that GitHub has for them.
        raise ReleaseError(
            f"the repository must be https://github.com/owner/name, got {repository!r}"
        )
    urls = tomllib.loads(_read(root / "pyproject.toml"))["project"]["urls"]
    pairs = {
        urls["Homepage"]: site,
        urls["Repository"]: repository,
        # Pictures of the README: where registries show it, they load them from there.
        _raw(urls["Repository"]): _raw(repository),
    }
    texts = {}
    for name in ADDRESSED:
        text = _read(root / name)
        for old, new in pairs.items():
            text = text.replace(old, new)
        texts[root / name] = text
    return texts


def _raw(repository: str) -> str:
    return repository.replace("https://github.com/", "https://raw.githubusercontent.com/")


def write(texts: Mapping[Path, str]) -> None:
    """Write all files or none: each is complete beside its place before the first is put there."""
    before = {path: path.read_bytes() for path in texts}
    fresh = {path: path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp") for path in texts}
    done: list[Path] = []
    try:
        for path, text in texts.items():
            fresh[path].write_text(text, encoding="utf-8", newline="\n")
        for path, temporary in fresh.items():
            os.replace(temporary, path)
            done.append(path)
    except BaseException:
        for path in done:
            path.write_bytes(before[path])
        raise
    finally:
        for temporary in fresh.values():
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


def difference(root: Path, texts: Mapping[Path, str]) -> str:
    """Return what writing would change."""
    lines: list[str] = []
    for path, text in texts.items():
        name = path.relative_to(root).as_posix()
        old, new = _read(path).splitlines(keepends=True), text.splitlines(keepends=True)
        lines += difflib.unified_diff(old, new, f"a/{name}", f"b/{name}", n=1)
    return "".join(lines)


def _replaced(text: str, pattern: str, by: str, times: int) -> str:
    new, found = re.subn(pattern, by, text, flags=re.M)
    if found != times:
        raise ReleaseError(f"{pattern!r} was found {found} times instead of {times}")
    return new


def _show(text: str) -> None:
    """Print a text of a file in the encoding of the file, which a pipe of Windows may lack."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    print(text, end="")


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return 0, or 1 if the release cannot be made."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--root", type=Path, default=ROOT, help="of the repository")
    verbs = parser.add_subparsers(dest="verb", required=True)
    bump = verbs.add_parser("bump", help="change the version")
    bump.add_argument("version")
    bump.add_argument("--date", type=datetime.date.fromisoformat, default=datetime.date.today())
    address = verbs.add_parser("address", help="change where the project lives")
    address.add_argument("site")
    address.add_argument("repository")
    for one in (bump, address):
        one.add_argument("--dry-run", action="store_true", help="show what would change")
    verbs.add_parser("check", help="compare a tag with the version").add_argument("tag")
    verbs.add_parser("notes", help="print a section of the changelog").add_argument("version")
    options = parser.parse_args(arguments)
    try:
        if options.verb == "check":
            check(options.root, options.tag)
            print(f"everything is of version {options.tag.removeprefix('v')}")
            return 0
        if options.verb == "notes":
            _show(notes(options.root, options.version))
            return 0
        if options.verb == "bump":
            texts = bumped(options.root, options.version, options.date)
        else:
            texts = readdressed(options.root, options.site, options.repository)
        if options.dry_run:
            _show(difference(options.root, texts))
            return 0
        write(texts)
    except (ReleaseError, OSError) as error:
        print(f"release: {error}", file=sys.stderr)
        return 1
    if options.verb == "bump":
        print(f"now: git commit -am 'Version {options.version}' && git tag v{options.version}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
