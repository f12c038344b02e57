# What the commands in tools/ share. To be sourced from the root of the project.

say() {
  printf '\n== %s\n' "$*"
}

jobs_default() {
  nproc 2>/dev/null || echo 2
}

# configure PRESET [-D...]   quiet unless it fails
configure() {
  local preset=$1 log
  shift
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
