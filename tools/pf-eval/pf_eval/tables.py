"""Text tables as spreadsheets, scripts and other programs write them."""

import csv
import pathlib
import re

import numpy as np

from . import Refused

MARKS = ((b"\xef\xbb\xbf", "utf-8"), (b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be"))


def read_text(path):
    """Text of a file without a byte order mark."""
    path = pathlib.Path(path)
    if not path.exists():
        raise Refused(f"{path}: there is no such file")
    if path.is_dir():
        raise Refused(f"{path}: is a folder, a file is needed")
    try:
        data = path.read_bytes()
        for mark, encoding in MARKS:
            if data.startswith(mark):
                return data[len(mark):].decode(encoding)
        return data.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise Refused(f"{path}: cannot be read ({error})") from error


def split(line):
    """Fields of a line: cut at commas, at semicolons or blanks (both also with decimal commas); without quotes."""
    if ";" in line:
        return [re.sub(r"^([-+\d]*),(\d)", r"\1.\2", word.strip()) for word in next(csv.reader([line], delimiter=";"))]
    if "," in line:
        words = line.split()
        if len(words) > 1 and all(re.fullmatch(r"[-+]?\d+(,\d+)?(e[-+]?\d+)?", word, re.IGNORECASE) for word in words):
            return [word.replace(",", ".") for word in words]
        fields = [word.strip() for word in next(csv.reader([line], skipinitialspace=True))]
        return fields[:-1] if fields and not fields[-1] else fields
    return [word.strip('"') for word in line.split()]


def split_header(line):
    """Names of columns; a unit in brackets belongs to the name before it."""
    return split(re.sub(r"\s+([\[(])", r"\1", line)) if not re.search("[,;]", line) else split(line)


def split_unit(column):
    """("timestamp", "ns") of "#Timestamp [ns]" or of timestamp_ns."""
    found = re.fullmatch(r"#?\s*(.*?)\s*(?:[\[(](.*?)[\])]|_(s|ms|us|ns))?\s*", column.strip().lower())
    return found[1], (found[2] or found[3] or "").strip()


def is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True


class Table:
    """numbers (n, columns), lines (n) in the file, header: names or None; has_header_row: it is no remark behind a #.

    texts  {column: word of the first row} of columns that begin with a word, which are NaN in numbers; refused unless asked for
    """

    def __init__(self, path, texts=False):
        self.path, self.header, self.lines, self.texts = path, None, [], {}
        rows, remark = [], None
        for number, line in enumerate(read_text(path).splitlines(), 1):
            line = line.strip()
            if not line:
                continue
            if line[0] in "#%":
                remark = line.lstrip("#% \t") if not rows else remark
                continue
            fields = split(line.split("#", 1)[0].strip())
            if not rows and self.header is None and not any(is_number(word) for word in fields):
                self.header = split_header(line)
                continue
            for column, word in enumerate(fields):
                if texts and not rows and not is_number(word):
                    self.texts[column] = word
                elif not is_number(word) and column not in self.texts:
                    raise Refused(f"{path}: line {number} has '{word}' in column {column + 1}, which is no number")
            if rows and len(fields) != len(rows[0]):
                raise Refused(f"{path}: line {number} has {len(fields)} columns, the rows before have {len(rows[0])}")
            rows.append([float("nan" if column in self.texts else word) for column, word in enumerate(fields)])
            self.lines.append(number)
        if not rows:
            raise Refused(f"{path}: is empty")
        self.numbers = np.array(rows)
        self.has_header_row = self.header is not None
        if self.header is None and remark is not None and len(split_header(remark)) == len(rows[0]):
            self.header = split_header(remark)
        elif self.header is not None and len(self.header) != len(rows[0]):
            raise Refused(f"{path}: its header names {len(self.header)} columns, and line {self.lines[0]} has {len(rows[0])}")

    def require_finite(self, columns):
        bad = np.flatnonzero(~np.isfinite(self.numbers[:, columns]).all(axis=1))
        if len(bad):
            raise Refused(f"{self.path}: line {self.lines[bad[0]]} has a number that is not finite")


def read_numbers(path, columns):
    """A table of so many columns; an array (n, columns)."""
    table = Table(path)
    if table.numbers.shape[1] != columns:
        raise Refused(f"{path}: line {table.lines[0]} has {table.numbers.shape[1]} columns, {columns} are needed")
    return table.numbers
