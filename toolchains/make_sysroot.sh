#!/usr/bin/env bash
# Libraries of Debian for another processor, unpacked into a folder:  make_sysroot.sh ARCHITECTURE FOLDER [PACKAGE...]
#
#   toolchains/make_sysroot.sh arm64 build/sysroot/aarch64
#   toolchains/make_sysroot.sh armhf build/sysroot/armhf
#
# For cross builds of the programs; the library alone needs none of it. Packages come from the machine's own mirrors
# through an apt state in a temporary folder: no architecture is added to the machine, nothing is installed, and no
# root rights are needed. PACKAGES come besides a list that SYSROOT_PACKAGES replaces; what they depend on comes along.
set -euo pipefail

architecture=${1:?which architecture: arm64 or armhf}
target=${2:?which folder}
# The window (SDL2) and OpenCV are left out: they bring a desktop along.
packages=${SYSROOT_PACKAGES:-libc6-dev libstdc++-12-dev linux-libc-dev libpng-dev libjpeg62-turbo-dev libyaml-cpp-dev
  libcairo2-dev libiio-dev libeigen3-dev libcli11-dev nlohmann-json3-dev}
packages="$packages ${*:3}"
stamp="$architecture $(echo $packages)"
[ "$(cat "$target/sysroot.stamp" 2>/dev/null)" != "$stamp" ] || exit 0

command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || {
  echo "make_sysroot.sh: this is no Debian system; unpack these packages for $architecture into $target: $packages" >&2
  exit 1
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/lists/partial" "$work/cache/archives/partial" "$work/etc/sources.list.d" "$work/etc/preferences.d"
: >"$work/status"

# The machine's own sources, without what ties them to its architecture.
shopt -s nullglob
sed -e '/^deb-src/d' -e 's/arch=[^] ]*//' /etc/apt/sources.list 2>/dev/null >"$work/etc/sources.list" || true
for list in /etc/apt/sources.list.d/*; do
  sed -e '/^deb-src/d' -e 's/arch=[^] ]*//' -e '/^Architectures:/d' "$list" >"$work/etc/sources.list.d/$(basename "$list")"
done

apt=(apt-get -q -y -o APT::Architecture="$architecture" -o APT::Architectures::="$architecture"
  -o Dir::Etc::sourcelist="$work/etc/sources.list" -o Dir::Etc::sourceparts="$work/etc/sources.list.d"
  -o Dir::Etc::preferencesparts="$work/etc/preferences.d" -o Dir::State="$work" -o Dir::State::lists="$work/lists"
  -o Dir::State::status="$work/status" -o Dir::Cache="$work/cache" -o APT::Sandbox::User=""
  -o Dir::Cache::pkgcache="" -o Dir::Cache::srcpkgcache="" -o Acquire::Retries=3)
echo "Fetching for $architecture: $(echo $packages)"
# A mirror may lack one list, of updates say: what the packages are fetched from decides.
"${apt[@]}" update >"$work/log" 2>&1 || grep '^E:' "$work/log" >&2 || true
# shellcheck disable=SC2086  # a list of words
"${apt[@]}" install --no-install-recommends --download-only $packages >"$work/log" 2>&1 ||
  { tail -15 "$work/log" >&2; exit 1; }

partial=$target.partial
rm -rf "$partial"
mkdir -p "$partial"
for package in "$work"/cache/archives/*.deb; do
  case "$(basename "$package")" in
    # Only what is linked against or needed to run what was linked.
    lib* | zlib* | nlohmann-json* | linux-libc-dev* | x11proto* | gcc-*-base* | uuid-dev*) ;;
    *) continue ;;
  esac
  dpkg-deb --fsys-tarfile "$package" | tar -x -C "$partial" --exclude='./usr/share/doc' --exclude='./usr/share/man' \
    --exclude='./usr/share/locale' --exclude='./etc'
done

# Debian's packages assume that /lib is /usr/lib, and absolute links point into the machine that builds.
if [ ! -L "$partial/lib" ]; then
  mkdir -p "$partial/usr/lib" "$partial/lib"
  cp -a "$partial/lib/." "$partial/usr/lib/"
  rm -rf "$partial/lib"
  ln -s usr/lib "$partial/lib"
fi
find "$partial" -type l -lname '/*' | while read -r link; do
  ln -snf "$(realpath -ms --relative-to="$(dirname "$link")" "$partial$(readlink "$link")")" "$link"
done
echo "$stamp" >"$partial/sysroot.stamp"
mkdir -p "$(dirname "$target")"
rm -rf "$target"
mv "$partial" "$target"
echo "$(du -sm "$target" | cut -f1) MB in $target"
