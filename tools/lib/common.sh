# What the commands in tools/ share. To be sourced from the root of the project.

say() {
  printf '\n== %s\n' "$*"
}

jobs_default() {
  nproc 2>/dev/null || echo 2
}

# need_number OPTION VALUE   ends the command where VALUE is no whole number above 0
need_number() {
  case "$2" in
    '' | 0 | *[!0-9]*) echo "$0: $1 needs a whole number above 0, not '$2'; see $0 --help" >&2; exit 2 ;;
  esac
}

# need_value OPTION VALUE   ends the command where VALUE is empty or missing
need_value() {
  [ -n "$2" ] || { echo "$0: $1 needs a value; see $0 --help" >&2; exit 2; }
}

# configure PRESET [-D...]   quiet unless it fails; compiles through ccache where that is installed
configure() {
  local preset=$1 log
  shift
  if command -v ccache >/dev/null; then
    # Precompiled headers are what they are made from.
    export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
    set -- -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"
  fi
  log=build/$preset.configure.log
  mkdir -p build
  if ! cmake --preset "$preset" "$@" >"$log" 2>&1; then
    cat "$log"
    return 1
  fi
}

# build PRESET JOBS [TARGET...]
build() {
  local preset=$1 jobs=$2
  shift 2
  NINJA_STATUS='[%f/%t %es] ' cmake --build "build/$preset" --parallel "$jobs" ${1:+--target "$@"}
}
