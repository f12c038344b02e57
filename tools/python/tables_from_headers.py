"""Makes the tables of the Python bindings from the project's headers: structures field by field, enums, constants and, for every
function, its comment. What is renamed in a header is renamed in Python by the next build.

tables_from_headers.py OUT HEADER...   writes OUT/tables.cpp and OUT/docs.h
"""

import os
import pathlib
import re
import sys

import header_reader

# Not of Python: what only describes memory of the caller, or is given as text, lists and arrays there.
LEFT_OUT = {"pf_image_t", "pf_mask_t", "pf_rectangle_t", "pf_walls_t", "pf_wall_t", "pf_sequence_info_t", "PF_SEQUENCE_MESSAGE", "PF_WALLS_MESSAGE", "PF_WALLS_MAX",
            "PF_WALLS_NAME"}


def camel(name):
    """pf_imu_model_t: ImuModel"""
    return "".join(word.capitalize() for word in name.removeprefix("pf_").removesuffix("_t").split("_"))


def text(words):
    """A C++ literal."""
    return 'R"text(' + words + ')text"'


def short_names(values):
    """Names of an enum's values without what they have in common."""
    common = os.path.commonprefix([value.name for value in values])
    return {value.name: value.name[common.rfind("_") + 1:] for value in values}


def enum_of(comment, enums):
    """The enum that a comment begins with, unless there are other values beside it."""
    match = re.search(r"(?:^|\n\n)(pf_\w+_t)\b(?!,? or )", comment)
    return f'"{camel(match.group(1))}"' if match and match.group(1) in enums else "nullptr"


def enum_rows(item):
    if not item.name:
        return [f'  module.attr("{value.name.removeprefix("PF_")}") = static_cast<int>({value.name});' for value in item.members]
    names = short_names(item.members)
    rows = [f'  nb::enum_<{item.name.removesuffix("_t")}>(module, "{camel(item.name)}", nb::is_arithmetic(), {text(item.comment)})']
    rows += [f'      .value("{names[value.name]}", {value.name}, {text(value.comment)})' for value in item.members]
    return rows[:-1] + [rows[-1] + ";"]


def record_rows(item, kind, name, enums):
    """A structure after the structures inside of it that have no name of their own."""
    rows = []
    for member in item.members:
        if member.kind == "struct":
            rows += [f"  using {kind}_{member.name} = decltype({kind}::{member.name});"]
            rows += record_rows(member, f"{kind}_{member.name}", name + camel(member.name), enums)
    rows += ["  {", f"    Record<{kind}> record(module, \"{name}\", {text(item.comment)});"]
    for member in item.members:
        enum = enum_of(member.comment, enums) if member.kind == "field" else "nullptr"
        rows.append(f"    record.add<decltype({kind}::{member.name})>(\"{member.name}\", offsetof({kind}, {member.name}), "
                    f"{text(member.comment)}, {enum});")
    return rows + ["    record.finish();", "  }"]


def tables(headers):
    rows, records, docs = [], [], []
    items = [item for header in headers for item in header_reader.read(header)]
    enums = {item.name for item in items if item.kind == "enum"}
    for item in items:
        if item.name in LEFT_OUT:
            continue
        if item.kind == "enum":
            rows += enum_rows(item)
        elif item.kind == "constant":
            rows.append(f'  module.attr("{item.name.removeprefix("PF_")}") = {item.name};')
        elif item.kind == "struct" and item.members:
            records += record_rows(item, item.name, camel(item.name), enums)
        elif item.kind == "function":
            docs.append(f"inline constexpr char {item.name}[] = {text(item.comment)};")
    return rows, records, docs


def write(path, lines):
    """Leaves the time of a file whose text stays the same."""
    words = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != words:
        path.write_text(words, encoding="utf-8")


def main(out, *headers):
    out = pathlib.Path(out)
    enums, records, docs = tables(headers)
    mark = "// Made by tables_from_headers.py; a change here is lost."
    includes = [f"#include <{pathlib.Path(header).parent.name}/{pathlib.Path(header).name}>" for header in headers]
    write(out / "tables.cpp", [mark, '#include "tables.h"', "", "#include <cstddef>", "", '#include "docs.h"', '#include "record.h"', "",
                               "namespace pf::python {", "", "void add_enums(nb::module_& module) {", *enums, "}", "",
                               "void add_records(nb::module_& module) {", *records, "}", "", "}  // namespace pf::python"])
    write(out / "docs.h", [mark, "#pragma once", "", *includes, "", "namespace pf::python::doc {", "", *docs, "",
                           "}  // namespace pf::python::doc"])


if __name__ == "__main__":
    main(*sys.argv[1:])
