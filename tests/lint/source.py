"""Reading the project's sources for the lint tests: files, text without comments and strings, includes."""

import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

ROOT = script.SOURCE
CODE = (".c", ".cpp", ".h")


def files(*folders, suffixes=CODE):
    """Files under the folders of the project, in order, without what is generated."""
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in suffixes and path.is_file():
                yield path


def name(path):
    return path.relative_to(ROOT).as_posix()


def code(text):
    """Text with comments and the contents of strings blanked; lines stay where they are."""
    def blank(match):
        word = match.group(0)
        if word.startswith("/"):
            return re.sub(r"[^\n]", " ", word)
        return word[0] + " " * (len(word) - 2) + word[-1]
    return re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'", blank, text, flags=re.S)


def includes(path):
    """(line number, bracket, what) of each #include."""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r"\s*#\s*include\s*([<\"])([^>\"]+)[>\"]", line)
        if match:
            yield number, match.group(1), match.group(2)


def report(problems):
    if problems:
        script.fail("\n  ".join([f"{len(problems)} found:"] + problems))
    print("nothing found")
