"""A recorded session with a map of 40 features on a Cortex-M7 without an operating system or heap: the same run as the
float library here, to 1e-4 m; and what it takes of flash and RAM."""

import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "session"))
import cross  # noqa: E402
import script  # noqa: E402
import session  # noqa: E402

FRAMES, FEATURES, BOUND = 100, 40, 1e-4
STACK_BOUND = 64 * 1024
CPU = ["-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard", "-mthumb"]

cross.skip_without("cortex-m7")
built = cross.build("cortex-m7", "planefoldf")
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    recording = folder / "session.bin"
    truth = session.write_session(recording, FRAMES, FEATURES)
    cross.run_session(folder, script.BUILD / "lib" / "libplanefoldf.a", recording, folder / "here.bin")

    script.run(cross.compiler("cortex-m7"), *cross.WARNINGS, *CPU, "-nostartfiles", "-T", cross.SESSION / "mps2_an500.ld",
               "-I", script.SOURCE / "lib" / "include", cross.SESSION / "run_session.c", cross.SESSION / "mps2_an500_io.c",
               built / "lib" / "libplanefoldf.a", "-lm", "-lc", "-Wl,--gc-sections",
               "-o", folder / "firmware.elf")
    said = script.run(cross.emulator("cortex-m7"), "-M", "mps2-an500", "-display", "none", "-serial", "none",
                      "-monitor", "none", "-semihosting-config", "enable=on,target=native", "-kernel", folder / "firmware.elf",
                      cwd=folder, timeout=600)
    print(said)
    block, stack = (int(re.search(rf"{what}_bytes (\d+)", said).group(1)) for what in ("block", "stack"))
    sizes = script.run("arm-none-eabi-size", folder / "firmware.elf").splitlines()[1].split()
    print(f"flash {sizes[0]} bytes of code and constants; RAM {block} bytes of block and {stack} bytes of stack")
    page = (script.SOURCE / "lib" / "docs" / "results" / "devices.md").read_text()
    told = re.search(r"takes ([\d,]+) bytes of flash.*?([\d,]+) bytes of block.*?([\d,]+) bytes of stack", page, re.S).groups()
    for what, is_now, was in zip(("flash", "block", "stack"), (int(sizes[0]), block, stack), told):
        if abs(is_now - int(was.replace(",", ""))) > 0.05 * is_now:
            script.fail(f"{what} takes {is_now} bytes, and lib/docs/results/devices.md says {was}")
    names = script.run("arm-none-eabi-nm", folder / "firmware.elf")
    for heap in ("malloc", "_malloc_r", "free", "_sbrk", "_Znwj"):
        if re.search(rf" [TtWD] {heap}$", names, re.M):
            script.fail(f"the firmware holds {heap}")
    if not 0 < stack <= STACK_BOUND:
        script.fail(f"the stack grew to {stack} bytes, allowed {STACK_BOUND}")

    here, there = session.read_result(folder / "here.bin"), session.read_result(folder / "result.bin")
    session.check_tracks(here, truth, FRAMES, FEATURES)
    apart = session.furthest_apart(here, there)
    print(f"at most {apart:.3g} m apart in {FRAMES} frames, allowed {BOUND:g} m")
    if not apart <= BOUND:
        script.fail(f"the two runs are {apart:.3g} m apart")
