"""Pages and code find each other: links lead somewhere, pages that comments name exist, and every page of theory/ links to a file that names
the page. A guide begins with a command and ends with what can go wrong, a page of results/ has a command beside its numbers, each of its tables is remade by
a tool or has a date, each page is reached from README.md in three clicks, names of the code on a page are in the code, and the sizes on a page are the
golden ones."""

import pathlib
import re
import sys

import source

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import sizes  # noqa: E402

DOCS = source.ROOT / "lib/docs"
# Pages about the project as a whole, which no file implements.
OVERVIEW = {"theory/architecture.md", "theory/notation.md"}
KINDS = {"adr", "guide", "lab", "reference", "results", "theory"}  # reference/: what is looked up, as bytes of a format
# Tables of results/ that other tools write, or that repeat what other pages measure.
NOT_MEASURED = {"README.md", "decisions.md", "devices.md", "missed.md"}
OLD = r"\*Old numbers, \d{4}-\d\d-\d\d( to \d{4}-\d\d-\d\d)?\.\*\n"  # above a table that tools/remake-results does not make
LAST = "\n## What can go wrong\n"  # section of a guide
NAMES = r"`((?:pf_|PF_)\w+|[A-Z]\w+::\w+)`"  # of the code
PLACEHOLDERS = {"pf_verb_object", "pf_x_t", "PF_X_Y"}  # of theory/notation.md
COMMAND = r"`(pf-|tools/|python3 |PLANEFOLD_|tests/)[^`]+`|^```(sh|console)$|`--[a-z]"
CLICKS = 3
problems = []



def anchors(path):
    """Names of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```$", "", path.read_text(), flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()).replace(" ", "-") for heading in headings}


def links(page):
    """Where a page's links lead, as (path, anchor)."""
    for target, anchor in re.findall(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)", page.read_text()):
        if not re.match(r"[a-z]+:", target):
            yield (page.parent / target).resolve() if target else page, anchor


README = source.ROOT / "README.md"
for page in [*sorted(DOCS.rglob("*.md")), README]:
    for path, anchor in links(page):
        if not path.exists():
            problems.append(f"{source.name(page)} links to {path}, which does not exist")
        elif anchor and path.suffix == ".md" and anchor not in anchors(path):
            problems.append(f"{source.name(page)} links to #{anchor}, which {source.name(path)} does not have")

code = {path: path.read_text() for path in source.files("lib", "platform", "examples", "tools", "tests", suffixes=(".c", ".cpp", ".h", ".py", ".sh"))}
for path, text in code.items():
    for named in re.findall(r"\blib/docs/([\w/]+\.md)", text):
        if not (DOCS / named).is_file():
            problems.append(f"{source.name(path)} names lib/docs/{named}, which does not exist")

words = set(re.findall(r"\w+", "\n".join(code.values())))
for page in [README, *sorted(path for kind in ("guide", "reference", "theory") for path in (DOCS / kind).glob("*.md"))]:
    if page.name != "names.md":  # names of before
        unknown = {name for name in re.findall(NAMES, page.read_text()) if not set(name.split("::")) <= words} - PLACEHOLDERS
        problems += [f"{source.name(page)} names {name}, which is nowhere in the code" for name in sorted(unknown)]

reached = {README}
for _ in range(CLICKS):
    reached |= {path for page in reached if page.suffix == ".md" for path, _ in links(page) if path.exists()}

for page in sorted(DOCS.rglob("*.md")):
    name = page.relative_to(DOCS).as_posix()
    kind = name.split("/")[0]
    text = page.read_text()
    if kind not in KINDS:
        problems.append(f"lib/docs/{name}: belongs in one of the folders {', '.join(sorted(KINDS))}")
    if page not in reached:
        problems.append(f"lib/docs/{name}: more than {CLICKS} clicks from README.md")
    if kind == "guide":
        if not re.match(r"# .+\n\n```(sh|console)\n", text):
            problems.append(f"lib/docs/{name}: a guide begins with a command")
        if LAST not in text or "\n## " in text[text.index(LAST) + 1:].replace(LAST.strip(), "", 1):
            problems.append(f"lib/docs/{name}: a guide ends with the section{LAST.rstrip()}")
    if kind == "results" and not re.search(COMMAND, text, re.M) and page.name not in ("missed.md", "README.md"):
        problems.append(f"lib/docs/{name}: no command is beside its numbers")
    if kind == "results" and page.name not in NOT_MEASURED:
        made = re.sub(r"<!-- remake \w+ -->.*?<!-- end -->", "", text, flags=re.S)
        for before, head in re.findall(r"((?:.*\n){2})(\|.*)\n\|[-|: ]+\|\n", made):
            if not re.search(OLD + "$", before.rstrip("\n") + "\n") and "<!-- no measurement -->" not in before:
                problems.append(f"lib/docs/{name}: '{head[:60]}' is neither made by tools/remake-results nor has a line with the date of its numbers")
    if kind != "theory" or name in OVERVIEW:
        continue
    files = [path for path, _ in links(page) if path.is_file() and path.suffix in (".c", ".cpp", ".h")]
    if not files:
        problems.append(f"lib/docs/{name} links to no source file that does what it describes")
    elif not any(f"lib/docs/{name}" in path.read_text() for path in files):
        named = ", ".join(source.name(path) for path in files)
        problems.append(f"lib/docs/{name}: none of the files that it links to names it ({named})")

if sizes.PAGE.read_text() != sizes.page_of(sizes.read_golden()):
    problems.append(f"{source.name(sizes.PAGE)}: the table of sizes differs from tests/golden/sizes.txt; tools/update-golden writes both")
source.report(problems)
