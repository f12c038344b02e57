"""The same simulation on a 32-bit ARM processor with NEON: to 1e-9 m, in double."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import test_sessions_aarch64 as sessions  # noqa: E402

sessions.compare("armhf")
