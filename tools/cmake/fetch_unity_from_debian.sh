#!/usr/bin/env bash
# Unpacks Unity from Debian's source package ntpsec:  fetch_unity_from_debian.sh TARGET_DIR
#
# Uses an apt state of its own, with deb-src lines derived from the machine's own sources, so that
# nothing of the machine's configuration is changed and no root rights are needed.
set -euo pipefail

target=$1
command -v apt-get >/dev/null && command -v dpkg-source >/dev/null || exit 1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/state/lists/partial" "$work/cache/archives/partial" "$work/sources.list.d"

shopt -s nullglob
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
  [ -f "$list" ] && sed -n 's/^deb\(\s\)/deb-src\1/p' "$list" >>"$work/sources.list"
done
touch "$work/sources.list"
for list in /etc/apt/sources.list.d/*.sources; do
  sed 's/^Types:.*/Types: deb-src/' "$list" >"$work/sources.list.d/$(basename "$list")"
done

apt=(apt-get -q
  -o Dir::Etc::sourcelist="$work/sources.list"
  -o Dir::Etc::sourceparts="$work/sources.list.d"
  -o Dir::State="$work/state" -o Dir::State::lists="$work/state/lists"
  -o Dir::State::status=/var/lib/dpkg/status
  -o Dir::Cache="$work/cache" -o APT::Sandbox::User="")
echo "Fetching Unity from Debian's source package ntpsec"
"${apt[@]}" update >"$work/log" 2>&1 || { tail -5 "$work/log"; exit 1; }
cd "$work"
"${apt[@]}" source --download-only ntpsec >"$work/log" 2>&1 || { tail -5 "$work/log"; exit 1; }
dpkg-source --no-check -x "$work"/ntpsec_*.dsc "$work/ntpsec" >"$work/log" 2>&1 ||
  { tail -5 "$work/log"; exit 1; }

unity=$(dirname "$(find "$work/ntpsec" -name unity.c | head -1)")
[ -f "$unity/unity.c" ] || exit 1
mkdir -p "$(dirname "$target")"
rm -rf "$target.partial"
mkdir "$target.partial"
cp "$unity"/unity*.[ch] "$target.partial/"
cp "$work"/ntpsec/tests/unity/LICENSE* "$work"/ntpsec/LICENSES/MIT* "$target.partial/" 2>/dev/null || true
rm -rf "$target"
mv "$target.partial" "$target"
