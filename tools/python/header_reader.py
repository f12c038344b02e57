"""Reads C headers in the project's style: their structures, enums, constants and functions, each with its comment."""

import dataclasses
import pathlib
import re

COMMENT = re.compile(r"/\*.*?\*/", re.S)
LAST_VALUE = re.compile(r"[A-Z][A-Z0-9_]*(\s*=\s*[^\s=].*)?", re.S)  # of an enum, which has no comma


@dataclasses.dataclass
class Item:
    """name: as in C; comment: its text; members: fields of a structure, or values of an enum."""

    kind: str
    name: str
    comment: str = ""
    members: list = dataclasses.field(default_factory=list)


def plain(comment):
    """Text of a comment without its stars."""
    lines = comment.removeprefix("/*").removesuffix("*/").splitlines()
    return "\n".join(re.sub(r"^\s*\*? ?", "", line).rstrip() if number else line.strip() for number, line in enumerate(lines)).strip()


def scan(text):
    """(comment, declaration) one after the other: a comment belongs to what follows on the next line, or, on the same line, to what
    stands before it. Declarations end with a semicolon or, in an enum, with a comma."""
    before, position, found = "", 0, []
    while True:
        blank = re.compile(r"\s*").match(text, position)
        position = blank.end()
        if position == len(text):
            return found
        comment = COMMENT.match(text, position)
        if comment:
            if found and "\n" not in blank.group():
                found[-1][0] = "\n\n".join(filter(None, [found[-1][0], plain(comment.group())]))
            else:
                before = plain(comment.group())
            position = comment.end()
            if re.match(r"[ \t]*\n[ \t]*\n", text[position:]):
                before = ""  # a heading, or a page of its own
            continue
        end = declaration_end(text, position)
        found.append([before, text[position:end]])
        before, position = "", end


def declaration_end(text, position):
    begin, depth = position, 0
    while position < len(text):
        comment = COMMENT.match(text, position)
        if comment:
            if depth == 0 and LAST_VALUE.fullmatch(text[begin:position].strip()):
                return position
            position = comment.end()
            continue
        letter = text[position]
        depth += (letter in "{(") - (letter in "})")
        position += 1
        if depth == 0 and letter in ";,":
            following = text[position:].lstrip()
            if letter == ";" or re.match(r"(/\*|[A-Z0-9_]+\s*(=|,|/\*|$)|$)", following):
                return position
    return position


def with_inner_comments(comment, declaration):
    """The comment with those that stand inside of the declaration, and the declaration without them."""
    inside = [plain(match) for match in COMMENT.findall(declaration)]
    return "\n\n".join(filter(None, [comment, *inside])), re.sub(r"\s+", " ", COMMENT.sub(" ", declaration)) if inside else declaration


def fields(body):
    """Members of a structure, without pointers."""
    found = []
    for comment, declaration in scan(body):
        if not declaration.startswith("struct"):
            comment, declaration = with_inner_comments(comment, declaration)
        declaration = declaration.rstrip(";").strip()
        inner = re.fullmatch(r"struct\s*\{(.*)\}\s*(\w+)", declaration, re.S)
        if inner:
            found.append(Item("struct", inner.group(2), comment, fields(inner.group(1))))
            continue
        if "(*" in declaration or re.match(r"(const )?\w+\s*\*", declaration):
            continue
        names = re.match(r"\w+\s+(.*)", declaration, re.S).group(1)
        found += [Item("field", re.match(r"\w+", name.strip()).group(), comment) for name in names.split(",")]
    return found


def values(body):
    found = [with_inner_comments(comment, declaration) for comment, declaration in scan(body)]
    return [Item("value", re.match(r"\w+", declaration).group(), comment) for comment, declaration in found]


def read(path):
    """Items of a header, in its order: struct, enum, constant, function."""
    text = pathlib.Path(path).read_text(encoding="utf-8")
    text = re.sub(r"/\*[ -]*-{8}.*?\*/\n", "\n", text)  # headings
    constants = [Item("constant", name) for name in re.findall(r"^#define (PF_\w+) \d+\b", text, re.M)]
    text = re.sub(r"^[ \t]*#.*(?<!\\)\n", "\n", re.sub(r"\\\n", " ", text), flags=re.M)
    text = text.replace('extern "C" {', "\n").rstrip().removesuffix("}")
    items = []
    for comment, declaration in scan(text):
        structure = re.fullmatch(r"typedef struct \w+\s*\{(.*)\}\s*(\w+);", declaration, re.S)
        enum = re.fullmatch(r"(?:typedef )?enum\s*\w*\s*\{(.*)\}\s*(\w*);", declaration, re.S)
        function = re.match(r"(?:PF_API )?[\w ]+[ *]+(pf_\w+)\(", declaration)
        if structure:
            items.append(Item("struct", structure.group(2), comment, fields(structure.group(1))))
        elif enum:
            items.append(Item("enum", enum.group(2), comment, values(enum.group(1))))
        elif function:
            items.append(Item("function", function.group(1), comment))
    return items + constants
