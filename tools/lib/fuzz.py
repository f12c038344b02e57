"""Runs the fuzz targets of build/fuzz one after the other:  fuzz.py MINUTES [NAME]

One line per target, then the line coverage of each folder of lib/src over all of them together. Exit status 1 where one of them
found something, whose input is kept in build/fuzz.
"""

import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "fuzz"
FOLDERS = sorted(f"lib/src/{room.name}" for room in (ROOT / "lib" / "src").iterdir() if room.is_dir())
# Targets that find what is known and not repaired yet. They run, what they find is kept and printed, and the run goes on.
KNOWN = {}


def source_name(target):
    """fuzz_frame_float runs the source, and has the seeds, of fuzz_frame."""
    return re.sub("_float$", "", target)


def run(target, seconds):
    """Executions, or None where the target found something."""
    corpus = BUILD / "corpus" / target.name
    corpus.mkdir(parents=True, exist_ok=True)
    seeds = ROOT / "tests" / "fuzz" / (source_name(target.name)[len("fuzz_"):] + "_seeds")
    command = [target, f"-max_total_time={seconds}", "-timeout=120", "-rss_limit_mb=2048", "-max_len=4096", "-len_control=0",
               "-verbosity=0", "-print_final_stats=1", f"-artifact_prefix={BUILD}/{target.name}-", corpus]
    command += [seeds] if seeds.is_dir() else []
    profile = BUILD / "profiles" / f"{target.name}.profraw"
    result = subprocess.run([str(word) for word in command], text=True, errors="replace", stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, env={"LLVM_PROFILE_FILE": str(profile), "PATH": "/usr/bin:/bin"})
    executions = re.search(r"number_of_executed_units:\s*(\d+)", result.stdout)
    if result.returncode != 0 or executions is None:
        print(result.stdout[-8000:])
        return None
    return int(executions.group(1))


def print_coverage(targets):
    tools = [shutil.which(name) or shutil.which(f"{name}-14") for name in ("llvm-profdata", "llvm-cov")]
    profiles = sorted((BUILD / "profiles").glob("*.profraw"))
    if None in tools or not profiles:
        print("  No coverage: llvm-profdata and llvm-cov are missing (Debian: llvm)")
        return
    merged = BUILD / "profiles" / "all.profdata"
    subprocess.run([tools[0], "merge", "-sparse", "-o", str(merged), *map(str, profiles)], check=True)
    objects = [word for target in targets[1:] for word in ("-object", str(target))]
    report = subprocess.run([tools[1], "report", f"-instr-profile={merged}", str(targets[0]), *objects,
                             *[str(ROOT / folder) for folder in FOLDERS]], text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL, check=True).stdout
    # FILE  regions missed %  functions missed %  lines missed %  branches missed %
    lines = {folder: [0, 0] for folder in FOLDERS}
    for row in report.splitlines():
        words = row.split()
        if len(words) < 10 or not words[7].isdigit():
            continue
        path = words[0] if words[0].startswith("lib/src") else "lib/src/" + words[0]
        for folder in FOLDERS:
            if path.startswith(folder + "/"):
                lines[folder][0] += int(words[7])
                lines[folder][1] += int(words[8])
    total = [sum(counts[i] for counts in lines.values()) for i in range(2)]
    for folder, (all_lines, missed) in [*lines.items(), ("together", total)]:
        if all_lines > 0:
            print(f"  lines of {folder:<14} {100 * (all_lines - missed) / all_lines:5.1f} % of {all_lines}")


def main():
    minutes = float(sys.argv[1])
    only = sys.argv[2] if len(sys.argv) > 2 else ""
    targets = sorted(path for path in (BUILD / "fuzzers").glob("fuzz_*") if only in path.name)
    if not targets:
        sys.exit(f"fuzz.py: no target has '{only}' in its name")
    built = {source_name(target.name) for target in targets}
    for source in sorted((ROOT / "tests" / "fuzz").glob("fuzz_*.cpp")):
        if only in source.stem and source.stem not in built:  # the summary of tools/test repeats lines of this kind
            print(f"{source.name}:1:{source.stem}:IGNORE: left out of the build; its configuration says why")
    shutil.rmtree(BUILD / "profiles", ignore_errors=True)
    seconds = max(1, round(60 * minutes / len(targets)))
    found = []
    for target in targets:
        executions = run(target, seconds)
        print(f"  {target.name:<28} " + ("FOUND SOMETHING" if executions is None else f"{executions} executions in {seconds} s"), flush=True)
        if executions is None and target.name in KNOWN:
            print(f"{target.name}:1:{target.name}:IGNORE: {KNOWN[target.name]}")
        elif executions is None:
            found.append(target.name)
    print_coverage(targets)
    if found:
        sys.exit(f"fuzz.py: {', '.join(found)} found something; the inputs are in {BUILD}")


main()
