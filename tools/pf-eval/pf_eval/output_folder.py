"""Folders that programs write into, as platform/sequence/output_folder.cpp has them: what an earlier run wrote is replaced, and
nothing else is ever touched."""

import pathlib

from . import Refused

LIST = ".planefold"
HEAD = "# Written by planefold's programs. A later run replaces these files and touches no others.\n"


def _names(folder):
    """Names on the folder's list that stay inside of it."""
    lines = (folder / LIST).read_text().splitlines() if (folder / LIST).is_file() else []
    names = [pathlib.PurePosixPath(line) for line in lines if line and not line.startswith("#") and not line.endswith("/")]
    return [name for name in names if not name.is_absolute() and ".." not in name.parts]


def open_output_folder(path, option, reads=None):
    """Makes the folder, or empties it of what its list names. Refused where it holds anything and has no list, or is the folder that is
    read."""
    path = pathlib.Path(path)
    if reads is not None and path.resolve() == pathlib.Path(reads).resolve():
        raise Refused(f"{path}: is the run itself, whose files would be deleted; choose another {option}")
    try:
        path.mkdir(parents=True, exist_ok=True)
        if any(path.iterdir()) and not (path / LIST).is_file():
            raise Refused(f"{path}: holds files of others (it has no {LIST} of an earlier run); choose another {option}, or empty it yourself")
        for name in _names(path):
            if not (path / name).is_dir():
                (path / name).unlink(missing_ok=True)
        (path / LIST).write_text(HEAD)
    except OSError as error:
        raise Refused(f"{path}: cannot be made or written ({error.strerror}); choose another {option}") from error
    return path


def add_output_files(path, *names):
    """Adds names to the folder's list, before the files are made."""
    path = pathlib.Path(path)
    for name in names:
        at = pathlib.PurePosixPath(name)
        if not name.endswith("/") and at.name != LIST and (path / at).exists() and at not in _names(path):
            raise Refused(f"{path / name}: is there already, and no earlier run wrote it; move it away")
    with open(path / LIST, "a") as file:
        file.writelines(name + "\n" for name in names)


def is_foreign(path, mark):
    """Whether a file is there that holds something, and not the mark of what pf-eval writes."""
    path = pathlib.Path(path)
    return path.is_file() and path.stat().st_size > 0 and mark.encode() not in path.read_bytes()


def write(path, text, mark, program="pf-eval"):
    """mark: a part of the text by which a later run knows that it may take the place of this file."""
    try:
        if is_foreign(path, mark):
            raise Refused(f"{path}: is there and was not written by {program}; name another file")
        pathlib.Path(path).write_text(text)
    except OSError as error:
        raise Refused(f"{path}: cannot be written ({error.strerror})") from error
