#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the site: build.py PERP OUT. From the texts of the repository, and from what the program says of its methods.

Needs mkdocs and, for the formulas, KaTeX: Debian's packages mkdocs and libjs-katex. The site uses no network.

Formulas are written as GitHub renders them, in ```math blocks and between $` and `$. Marks in the texts:
  <!-- options: NAME... KEY... -->   the options of these methods with these keys (options.py); of no name, those that
                                     all share
  <!-- contact-options -->           what `perp contact --help` says of --option
"""

import posixpath
import re
import shutil
import subprocess
import sys
from pathlib import Path

import options

ROOT = Path(__file__).resolve().parent.parent
KATEX = Path("/usr/share/javascript/katex")
OUTSIDE = {  # texts outside of docs/, and where they are in the site
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changes.md",
    "app/README.md": "program.md",
    "bench/README.md": "folders/bench.md",
    "contact/README.md": "folders/contact.md",
    "data/README.md": "folders/data.md",
    "data/baseline/README.md": "folders/baseline.md",
    "data/contact/README.md": "folders/data-contact.md",
    "lcp/README.md": "folders/lcp.md",
    "ncp/README.md": "folders/ncp.md",
    "ncp/ampl/README.md": "folders/ampl.md",
    "collection/README.md": "folders/collection.md",
}


def texts():
    """path in the repository -> path in the site, of all pages."""
    pages = dict(OUTSIDE)
    for folder, place in (("docs", ""), ("bench/results", "results")):
        for page in (ROOT / folder).rglob("*.md"):
            name = page.relative_to(ROOT / folder).as_posix()
            pages[f"{folder}/{name}"] = posixpath.join(place, re.sub(r"(^|/)README\.md$", r"\1index.md", name))
    return pages


def linked(text, source, pages):
    """Links between texts of the repository made links between pages; those to other files lose their link."""

    def link(found):
        words, target, anchor = found[1], found[2], found[3] or ""
        there = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        if there in pages:
            return f"[{words}]({posixpath.relpath(pages[there], posixpath.dirname(pages[source]) or '.')}{anchor})"
        return found[0] if there.startswith("docs/") else words

    return re.sub(r"(?<!!)\[([^\]]+)\]\((?!\w+:)([^)#\s]+)(#[^)]*)?\)", link, text)


def filled(text, perp):
    text = re.sub(r"<!-- options: ?([\w* -]*?) ?-->", lambda found: options.table(perp, found[1].split()), text)
    if "<!-- contact-options -->" in text:
        told = options.said(perp, "contact", "--help")
        said = re.search(r"--option KEY=VALUE +of the method; may be repeated: (.*)", told)
        kinds = options.cell(said[1]).split("; ") if said else []
        text = text.replace("<!-- contact-options -->", "\n".join(f"* {kind}" for kind in kinds))
    return text


def names(perp):
    """The page of all names: what `perp methods` says before its options, with links to the pages."""
    said = re.split(r"^(?:Strategies|Options)", options.said(perp, "methods"), maxsplit=1, flags=re.M)[0]
    lines = ["# All names", "", "What `perp methods` lists: `--method NAME`.", ""]
    for part in re.split(r"\n(?=[A-Z])", said.split("\n", 1)[1]):
        title, *_ = part.strip().split("\n")
        lines += [title if title[0].isupper() else "", "", "| name | what | reference |", "|---|---|---|"]
        for name, what, reference in re.findall(r"^  (\S+).*\n((?:      .*\n)+?)      (.*)(?:\n|$)", part, flags=re.M):
            page = page_of(name)
            shown = f"[{name}]({page})" if page else f"`{name}`"
            lines.append(f"| {shown} | {options.cell(' '.join(what.split()))} | {options.cell(reference)} |")
        lines.append("")
    return "\n".join(lines)


def page_of(name):
    """The page with the name in its heading, seen from the page of all names; None if there is none."""
    for folder in ("methods", "affine"):
        for page in (ROOT / "docs" / folder).glob("*.md"):
            heading = page.read_text(encoding="utf-8").splitlines()[0]
            if name in (word.strip(" #") for word in heading.split(",")):
                return f"../{folder}/{page.name}"
    return None


def navigation(text, pages):
    """mkdocs.yml with each line FOLDER/* replaced by the folder's pages, in the order of the links in its first page."""

    def listed(found):
        indent, folder = found[1], found[2]
        index = next(source for source, place in pages.items() if place == f"{folder}/index.md")
        linked = re.findall(r"\]\(([\w-]+\.md)", (ROOT / index).read_text(encoding="utf-8"))
        there = sorted(place.removeprefix(f"{folder}/") for place in pages.values() if place.startswith(f"{folder}/"))
        names = dict.fromkeys([name for name in linked if name in there] + there)
        return "".join(f"{indent}{folder}/{name}\n" for name in names if name != "index.md")

    return re.sub(r"^( *- )(\w+)/\*\n", listed, text, flags=re.M)


def stage(perp, out):
    """The pages, with generated parts and links, and what they need, in OUT/pages."""
    pages = texts()
    folder = out / "pages"
    for source, place in pages.items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        text = linked((ROOT / source).read_text(encoding="utf-8"), source, pages)
        text = filled(text, perp) if source.startswith("docs/") else text
        (folder / place).write_text(text, encoding="utf-8")
    (folder / "methods/names.md").write_text(names(perp), encoding="utf-8")
    shutil.copytree(ROOT / "docs/pictures", folder / "pictures")
    shutil.copytree(ROOT / "docs/site", folder / "site")
    (folder / "katex").mkdir()
    for name in ("katex.min.js", "katex.min.css"):
        shutil.copy(KATEX / name, folder / "katex")
    shutil.copytree(KATEX / "fonts", folder / "katex/fonts", ignore=shutil.ignore_patterns("*.ttf", "*.woff"))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    perp, out = sys.argv[1], Path(sys.argv[2])
    mkdocs = shutil.which("mkdocs")
    lacking = [name for name, there in (("mkdocs", mkdocs), ("libjs-katex", KATEX.is_dir())) if not there]
    if lacking:
        sys.exit(f"the site needs {' and '.join(lacking)}: apt-get install {' '.join(lacking)}")
    shutil.rmtree(out, ignore_errors=True)
    stage(perp, out)
    config = (ROOT / "docs/mkdocs.yml").read_text(encoding="utf-8")
    (out / "mkdocs.yml").write_text(navigation(config, texts()), encoding="utf-8")
    subprocess.run([mkdocs, "build", "--quiet", "--strict", "--config-file", out / "mkdocs.yml"], check=True)
    print(f"the site is {out / 'site' / 'index.html'}")


if __name__ == "__main__":
    main()
