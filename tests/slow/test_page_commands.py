"""Every command of README.md and of the guides, as written: each block of `sh` runs in a folder of its page, one after the other, and ends with 0.
Blocks of `console` need a device, a network, a file of the reader's or a build of their own, and are counted only. Each option that a page names is
one of a program or tool. --list prints what would be run, and what would not."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PAGES = [script.SOURCE / "README.md", *sorted((script.SOURCE / "lib/docs/guide").glob("*.md"))]
# Lines of sh blocks that are not run here, and what runs them.
ELSEWHERE = {
    "./tools/demo": "installs packages and builds; by hand before a release",
    "./tools/test": "runs this test",
}
SECONDS = 900  # of a block
PROGRAMS = ("pf-capture", "pf-calibrate", "pf-eval", "pf-sim", "pf-bench")
FOREIGN = {"--preset", "--build", "--install", "--prefix", "--test-dir", "--cflags", "--libs", "--strip-components"}  # cmake, pkg-config, tar
OPTION = r"(?<![\w-])--[a-z][a-z-]*[a-z]"


def blocks(page):
    """(line number, language, text) of each block of commands."""
    text = page.read_text()
    for match in re.finditer(r"^```(sh|console)\n(.*?)^```$", text, re.M | re.S):
        yield text.count("\n", 0, match.start()) + 1, match.group(1), match.group(2)


def command_of(line):
    return line.split("#")[0].strip()


def help_of(*command):
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    return done.stdout


def known_options():
    """Options of the programs, by their --help, and of the tools, by their text."""
    texts = [help_of(script.BIN / program, "--help") for program in PROGRAMS]
    for program in ("pf-sim", "pf-bench"):
        commands = re.findall(r"^  ([a-z0-9]+) ", help_of(script.BIN / program, "--help"), re.M)
        texts += [help_of(script.BIN / program, command, "--help") for command in commands]
    tools = script.SOURCE / "tools"
    texts += [path.read_text() for path in [*tools.iterdir(), *tools.rglob("*.py"), script.SOURCE / "tests/lint/test_words.py"] if path.is_file()]
    return FOREIGN | set(re.findall(OPTION, "\n".join(texts)))


def main():
    script.skip_in_cross_builds()
    if "--list" not in sys.argv[1:] and not (script.BIN / "pf-capture").is_file():
        script.skip("pf-capture is not built")
    data = os.environ.get("PLANEFOLD_DATA")
    environment = dict(os.environ, PATH=os.pathsep.join([str(script.BIN), str(script.SOURCE / "tools"), os.environ["PATH"]]))
    ran, left, without_data, problems, elsewhere = 0, 0, 0, [], set()
    for page in PAGES:
        name = page.relative_to(script.SOURCE).as_posix()
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "out").mkdir()
            for line, language, text in blocks(page):
                if language == "console":
                    left += 1
                    if "--list" in sys.argv[1:]:
                        print(f"{name}:{line}: not run\n{text}")
                    continue
                lines = text.splitlines()
                elsewhere |= {command_of(each) for each in lines} & set(ELSEWHERE)
                text = "\n".join(each for each in lines if command_of(each) not in ELSEWHERE)
                if not text.strip():
                    continue
                if "$PLANEFOLD_DATA" in text and not data:
                    without_data += 1
                    continue
                print(f"{name}:{line}\n{text}", flush=True)
                if "--list" in sys.argv[1:]:
                    continue
                try:
                    done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=environment, text=True, timeout=SECONDS,
                                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
                except subprocess.TimeoutExpired:
                    problems.append(f"{name}:{line}: took more than {SECONDS} s")
                    continue
                ran += 1
                if done.returncode != 0:
                    problems.append(f"{name}:{line}: ended with {done.returncode}\n{done.stdout[-2000:]}")
    if "--list" not in sys.argv[1:]:
        known = known_options()
        problems += [f"{page.name}: no program or tool has {option}" for page in PAGES for option in sorted(set(re.findall(OPTION, page.read_text())) - known)]
    problems += [f"{command} stands on no page, and the list of what runs it can go" for command in sorted(set(ELSEWHERE) - elsewhere)]
    print(f"{ran} blocks of commands ran, {left} need a device, a network or a build; {without_data} need PLANEFOLD_DATA, which is not set")
    if problems:
        script.fail("\n".join(problems))


main()
