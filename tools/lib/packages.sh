# The Debian packages that building, testing and the demo need, in one place; and installing what is missing.
# To be sourced by the commands in tools/, after common.sh.

packages_build=(cmake ninja-build gcc g++ binutils libeigen3-dev pkg-config dpkg-dev file)
packages_programs=(libpng-dev libjpeg62-turbo-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev
  libsdl2-dev libcairo2-dev ffmpeg python3 python3-venv)
packages_package=(help2man) # man pages
packages_test=(libbenchmark-dev clang-format python3-dev "${packages_package[@]}") # python3-dev: headers for the Python package

# Without these some tests and comparisons are left out: the peers in pf-bench, pf-calibrate and (of libopencv-contrib-dev) its
# ChArUco, the fuzzers and the checker of names, the cross builds.
optional_peers=(libopenblas-dev libblis-dev libopencv-core-dev libopencv-imgproc-dev libopencv-video-dev
  libopencv-calib3d-dev libopencv-contrib-dev libceres-dev)
optional_targets=(g++-aarch64-linux-gnu gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-user qemu-system-arm)
# Without these pf-capture has no libcamera and no inertial units, and its window is not tried without a screen.
optional_cameras=(libcamera-dev libiio-dev)
optional_devices=("${optional_cameras[@]}" xvfb)
optional_arm=(g++-arm-linux-gnueabihf)
optional_fuzz=(clang libclang-rt-dev llvm)
optional_all=("${optional_fuzz[@]}" clang-tidy valgrind doxygen make xz-utils)

# missing_packages NAME...   prints those that are not installed
missing_packages() {
  local package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || echo "$package"
  done
}

# install_packages required|optional NAME...
# Installs what is missing and says what. Asks first where it is neither root nor CI.
install_packages() {
  local need=$1 missing sudo=() answer
  shift
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "This is no Debian system: nothing is installed. Needed are the equivalents of: $*"
    return 0
  fi
  mapfile -t missing < <(missing_packages "$@")
  [ ${#missing[@]} -gt 0 ] || return 0

  say "Missing ($need): ${missing[*]}"
  if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
      say "Neither root nor sudo. As root: apt-get install ${missing[*]}"
      [ "$need" = optional ] && return 0 || return 1
    fi
    sudo=(sudo)
    if [ -n "${CI:-}" ]; then
      sudo=(sudo -n)
    elif [ -t 0 ]; then
      read -r -p "Install them with sudo apt-get? [Y/n] " answer
      case "$answer" in
        '' | [Yy]*) ;;
        *) [ "$need" = optional ] && return 0 || return 1 ;;
      esac
    else
      say "Nobody can be asked here. Run: sudo apt-get install ${missing[*]}"
      [ "$need" = optional ] && return 0 || return 1
    fi
  fi

  say "Installing with apt-get"
  if "${sudo[@]}" apt-get -q update >/dev/null &&
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends \
      "${missing[@]}" >/dev/null; then
    return 0
  fi
  say "apt-get could not install: ${missing[*]}"
  [ "$need" = optional ]
}
