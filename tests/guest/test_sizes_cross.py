"""Code, static data, stack and the block of three profiles on the ARM targets are what tests/golden/sizes.txt says."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import cross  # noqa: E402
import script  # noqa: E402
import sizes  # noqa: E402

script.skip_unless_plain_native_build()
names = [name for name in cross.TRIPLES if not cross.have(name)]
if not names:
    script.skip("there is no cross compiler with its emulator")
for name in names:
    libraries = ("planefoldf",) if name == "cortex-m7" else ("planefold", "planefoldf")
    built = cross.build(name, *libraries)
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for library in libraries:
            archive = built / "lib" / f"lib{library}.a"
            numbers = sizes.of_archive(f"{cross.TRIPLES[name]}-size", archive)
            if name != "cortex-m7":  # where a hosted program runs; the block is the same, its structures being laid out alike
                numbers |= sizes.of_profiles(cross.compiler(name), archive, pathlib.Path(folder), cross.emulator(name), "-L",
                                             cross.root_of(name))
            found.update({(library, what): value for what, value in numbers.items()})
    sizes.check(name, found)
