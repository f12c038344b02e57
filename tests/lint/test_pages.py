"""Pages and code find each other: links lead somewhere, pages that comments name exist, and every page that describes code links to a file
that names the page. The sizes that a page tells are the golden ones."""

import pathlib
import re
import sys

import source

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import sizes  # noqa: E402

DOCS = source.ROOT / "lib/docs"
# Pages about the project as a whole, which no file implements.
OVERVIEW = {f"{name}.md" for name in (
    "guide/devices", "guide/where_to_change", "results/decisions", "results/measured", "theory/architecture", "theory/notation")}
KINDS = {"adr", "guide", "lab", "results", "theory"}
problems = []

for page in [*sorted(DOCS.rglob("*.md")), source.ROOT / "README.md"]:
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text()):
        if not re.match(r"[a-z]+:", target) and not (page.parent / target).exists():
            problems.append(f"{source.name(page)} links to {target}, which does not exist")

code = {path: path.read_text() for path in source.files("lib", "platform", "examples", "tools", "tests", suffixes=(".c", ".cpp", ".h", ".py", ".sh"))}
for path, text in code.items():
    for named in re.findall(r"\blib/docs/([\w/]+\.md)", text):
        if not (DOCS / named).is_file():
            problems.append(f"{source.name(path)} names lib/docs/{named}, which does not exist")

for page in sorted(DOCS.rglob("*.md")):
    name = page.relative_to(DOCS).as_posix()
    kind = name.split("/")[0]
    if kind not in KINDS:
        problems.append(f"lib/docs/{name}: belongs in one of the folders {', '.join(sorted(KINDS))}")
    if name in OVERVIEW or kind not in ("guide", "results", "theory"):
        continue
    text = page.read_text()
    linked = [(page.parent / target).resolve() for target in re.findall(r"\]\((\.\./[^)#\s]+)\)", text)]
    files = [path for path in linked if path.is_file() and path.suffix in (".c", ".cpp", ".h")]
    if not files:
        problems.append(f"lib/docs/{name} links to no source file that does what it describes")
    elif not any(f"lib/docs/{name}" in path.read_text() for path in files):
        links = ", ".join(source.name(path) for path in files)
        problems.append(f"lib/docs/{name}: none of the files that it links to names it ({links})")

if sizes.PAGE.read_text() != sizes.page_of(sizes.read_golden()):
    problems.append(f"{source.name(sizes.PAGE)}: the table of sizes differs from tests/golden/sizes.txt; tools/update-golden writes both")
source.report(problems)
