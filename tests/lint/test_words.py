"""Words of guide/, reference/ and theory/: the glossary of theory/notation.md has one word for one meaning, and names the words that it replaces. How often a
page has one of those is counted in words.tsv, and may not grow; a page that is not in the table has none. --update writes the table, and only
where no count grows. Both kinds that are read from beginning to end, guide/ and theory/, have at most MAX_WORDS words together."""

import pathlib
import re
import sys

import source

DOCS = source.ROOT / "lib/docs"
TABLE = pathlib.Path(__file__).with_name("words.tsv")
MAX_WORDS = 30000
# What is counted, by the word under which the glossary's last column has it.
REPLACED = {
    "tell": r"tells?|told|telling",
    "doubt": r"doubt(s|ed|ing|ful)?",
    "believe": r"believ(e|es|ed|ing|able)",
    "vouch": r"vouch(es|ed)?",
    "refuse": r"refus(e|es|ed|al|als|ing)",
    "honesty": r"(dis)?honest(y|ly)?",
    "young": r"young(er|est)?",
    "proven": r"proven",
    "settle": r"settle(s|d)?",
    "hangs on": r"hangs? on",
    "too sure": r"too sure",
    "likewise": r"likewise",
}


def prose(text):
    """A page without code, equations, addresses and its glossary."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    text = re.sub(r"^ {4,}\S.*$", "", text, flags=re.M)
    text = re.sub(r"`[^`]*`|\]\([^)]*\)", " ", text)
    return re.sub(r"^## Words$.*?(?=^## |\Z)", "", text, flags=re.M | re.S)


def counts():
    found = {}
    for folder in ("guide", "reference", "theory"):
        for page in sorted((DOCS / folder).glob("*.md")):
            text = prose(page.read_text())
            for word, pattern in REPLACED.items():
                number = len(re.findall(rf"\b({pattern})\b", text, re.I))
                if number:
                    found[page.relative_to(DOCS).as_posix(), word] = number
    return found


def table():
    rows = (line.split("\t") for line in TABLE.read_text().splitlines() if line and not line.startswith("#"))
    return {(page, word): int(number) for page, word, number in rows}


problems = []
glossary = (DOCS / "theory/notation.md").read_text()
last_column = " ".join(line.rsplit("|", 2)[1] for line in glossary[glossary.index("\n## Words\n"):].splitlines() if line.startswith("|"))
for word in REPLACED:
    if not re.search(rf"\b{word}\b", last_column):
        problems.append(f"theory/notation.md: the glossary does not have '{word}' in its last column")
number = sum(len(page.read_text().split()) for folder in ("guide", "theory") for page in (DOCS / folder).glob("*.md"))
if number > MAX_WORDS:
    problems.append(f"guide/ and theory/ have {number} words, {MAX_WORDS} at most: tables to look up belong in reference/, numbers in results/, what was tried in lab/")
found, allowed = counts(), table()
for (page, word), number in found.items():
    if number > allowed.get((page, word), 0):
        problems.append(f"lib/docs/{page}: '{word}' {number} times, {allowed.get((page, word), 0)} allowed; theory/notation.md has the word to use")
if "--update" in sys.argv[1:] and not problems:
    rows = [f"{page}\t{word}\t{number}" for (page, word), number in found.items()]
    TABLE.write_text("\n".join(["# page, word that the glossary replaces, how often: by tests/lint/test_words.py --update", *rows]) + "\n")
    allowed = table()
shrunk = [f"{page}: '{word}' {number}, now {found.get((page, word), 0)}" for (page, word), number in allowed.items() if found.get((page, word), 0) < number]
if shrunk:
    print("fewer than in words.tsv, which --update takes down:", *shrunk, sep="\n  ")
source.report(problems)
