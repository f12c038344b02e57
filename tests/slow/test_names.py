"""The names in lib/src are as .clang-tidy wants them."""

import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

if shutil.which("clang-tidy") is None:
    script.skip("clang-tidy is not installed")
if script.cache("CMAKE_TOOLCHAIN_FILE") or script.cache("PLANEFOLD_SANITIZE"):
    script.skip("names are the same in every build; the native one without sanitizers checks them")

ONLY_GCC = {"-fno-gnu-unique", "-Winvalid-pch"}

commands = []
for entry in json.loads((script.BUILD / "compile_commands.json").read_text()):
    if "planefold_objects.dir" in entry["command"]:
        command = re.sub(r" -include \S+", "", entry["command"])  # Clang reads no precompiled header of GCC
        entry["command"] = " ".join(word for word in command.split() if word not in ONLY_GCC)
        commands.append(entry)


def check(folder, path):
    result = subprocess.run(["clang-tidy", "-p", folder, "--quiet", "--checks=-*,readability-identifier-naming", path],
                            text=True, capture_output=True, cwd=script.SOURCE)
    return result.returncode, result.stdout


with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    (pathlib.Path(folder) / "compile_commands.json").write_text(json.dumps(commands))
    results = list(pool.map(lambda entry: check(folder, entry["file"]), commands))

said = sorted({line for _, text in results for line in text.splitlines() if "error:" in line})
if said or any(code for code, _ in results):
    script.fail("\n".join(["names that do not hold:"] + said))
print(f"{len(commands)} files read, nothing found")
