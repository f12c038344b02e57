"""Classes and functions of a C++ file, read without a compiler, for the lint tests."""

import collections
import dataclasses
import re

import source

CLASS = re.compile(r"\b(?:class|struct|union)\s+(?:alignas\([^)]*\)\s*)?(?P<name>\w+)(?P<rest>[^()]*)$")
FUNCTION = re.compile(r"(?:(?P<owner>\w+)(?:<[^<>]*>)?::)?(?P<name>~?\w+|operator\s*[^\s\w(]+|operator\s*\(\)|operator \w+)\s*\(")
INITIALISER = re.compile(r"\)\s*(?:const\s*|noexcept\s*)*:(?!:)")
NOT_A_MEMBER = re.compile(r"^(?:using|typedef|friend|static_assert|enum)\b")


@dataclasses.dataclass
class Class:
    name: str  # with the class that it stands in, as in Outer::Data
    file: object
    line: int
    methods: set = dataclasses.field(default_factory=set)  # without constructors
    members: list = dataclasses.field(default_factory=list)
    sources: set = dataclasses.field(default_factory=set)  # .cpp files that define its methods


@dataclasses.dataclass
class Function:
    name: str
    owner: str  # "" for one that belongs to no class
    file: object
    line: int
    lines: int


def without_arguments(text):
    """Text without what stands between angle brackets."""
    while True:
        shorter = re.sub(r"<[^<>()]*>", "", text)
        if shorter == text:
            return text
        text = shorter


def method_of(head, owner):
    """What a declaration within a class declares if that is a method, None for all else. Overloads count by themselves, constructors not."""
    plain = without_arguments(head)
    if re.search(r"=\s*(?:default|delete)\s*$", head) or re.match(rf"^(?:explicit\s+|constexpr\s+)*~?{owner}\s*\(", plain):
        return None
    declared = re.split(r"=(?!=)|\boperator\b", plain, maxsplit=1)[0]
    return re.sub(r"\s+", " ", head) if "(" in declared or "operator" in head else None


def members_of(head):
    """Names of the data members that a declaration within a class makes."""
    if re.search(r"\bstatic\b|\bconstexpr\b", head):
        return []
    names = []
    for part in re.sub(r"\[[^\]]*\]", "", re.sub(r"\{[^{}]*\}", "", without_arguments(head))).split(","):
        match = re.search(r"(\w+)\s*(?::\s*\w+)?\s*(?:=.*)?$", part.strip(), re.S)
        if match:
            names.append(match.group(1))
    return names


class Reader:
    """One pass over a file's text: scopes in a stack, and the text since the last end of a statement in each."""

    def __init__(self, path):
        self.path = path
        self.text = re.sub(r"(?m)^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: re.sub(r"[^\n]", " ", m.group(0)), source.code(path.read_text()))
        self.classes, self.functions = [], []
        self.stack = [("namespace", None, 0)]
        self.begin = 0  # of the statement that is being read

    def line(self, at):
        return self.text.count("\n", 0, at) + 1

    def head(self, end):
        text = re.sub(r"\b(?:public|private|protected)\s*:(?!:)", " ", self.text[self.begin:end])
        return re.sub(r"^\s*template\s*<(?:[^<>]|<[^<>]*>)*>", "", text).strip()

    def statement(self, end):
        """A declaration that ends at `end`, within a class."""
        kind, owner, _ = self.stack[-1]
        head = self.head(end)
        if kind != "class" or not head or NOT_A_MEMBER.match(head) or re.match(r"^(?:class|struct|union)\s+\w+\s*$", head):
            return
        method = method_of(head, owner.name.split("::")[-1])
        if method:
            owner.methods.add(method)
        elif not re.search(r"=\s*(?:default|delete)\s*$", head) and "(" not in re.split(r"[={]", without_arguments(head), maxsplit=1)[0]:
            owner.members += members_of(head)

    def open(self, at):
        kind, owner, _ = self.stack[-1]
        head = self.head(at)
        if kind in ("function", "other"):
            self.stack.append(("other", None, self.begin))
        elif re.search(r"\bnamespace\b|\bextern\s*\"", head):
            self.stack.append(("namespace", None, self.begin))
        elif (match := CLASS.search(without_arguments(head))) and not head.startswith("enum"):
            outer = f"{owner.name}::" if kind == "class" else ""
            found = Class(outer + match["name"], self.path, self.line(at))
            self.classes.append(found)
            self.stack.append(("class", found, self.begin))
        elif "(" in without_arguments(head) and not re.search(r"\)\s*=|^[^(]*[^=!<>]=[^=]", without_arguments(head)) and \
                not (INITIALISER.search(head) and re.search(r"\w$", head)):
            self.stack.append(("function", (head, owner if kind == "class" else None), self.begin))
        else:
            self.stack.append(("value", None, self.begin))
            return
        self.begin = at + 1

    def close(self, at):
        kind, what, begin = self.stack.pop()
        if kind == "value":
            return
        if kind == "function":
            head, owner = what
            match = FUNCTION.search(without_arguments(head))
            name = match["name"] if match else head
            first = begin + len(self.text[begin:]) - len(self.text[begin:].lstrip())
            self.functions.append(Function(name, owner.name if owner else (match and match["owner"] or ""), self.path, self.line(first),
                                           self.line(at) - self.line(first) + 1))
            if owner and (method := method_of(head, owner.name.split("::")[-1])):
                owner.methods.add(method)
        self.begin = at + 1

    def read(self):
        parentheses = 0
        for at, letter in enumerate(self.text):
            if letter in "(":
                parentheses += 1
            elif letter == ")":
                parentheses -= 1
            elif parentheses == 0 or self.stack[-1][0] in ("function", "other"):
                if letter == "{":
                    self.open(at)
                    if self.stack[-1][0] == "function":
                        parentheses = 0
                elif letter == "}":
                    self.close(at)
                elif letter == ";" and self.stack[-1][0] in ("class", "namespace"):
                    self.statement(at)
                    self.begin = at + 1
        return self


def read(*folders):
    """(classes, functions) of folders; a class knows the .cpp files that define its methods."""
    classes, functions = [], []
    for path in source.files(*folders):
        reader = Reader(path).read()
        classes += reader.classes
        functions += reader.functions
    sources = collections.defaultdict(set)
    for function in functions:
        if function.owner and function.file.suffix == ".cpp":
            sources[function.owner].add(source.name(function.file))
    for one in classes:
        one.sources = sources[one.name] if one.file.suffix == ".h" else {source.name(one.file)}
    return classes, functions
