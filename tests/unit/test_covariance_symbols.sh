#!/bin/bash
# Files compiled for one processor feature must not define functions that the linker may share with other files: it could hand
# them to an older processor. So they have no weak symbols of their own.
set -u
build=${PLANEFOLD_BUILD:?}
objects=$(find "$build/lib" -path '*covariance/tuned/kernels_*' -name '*.o*')
if [ -z "$objects" ] || ! command -v nm >/dev/null; then
  echo "no object files or no nm"
  exit 77
fi
status=0
for object in $objects; do
  weak=$(nm "$object" | awk '($2 ~ /^[WVu]$/) && ($3 ~ /^_Z/)')
  if [ -n "$weak" ]; then
    printf 'shared by the linker, in %s:\n%s\n' "$object" "$weak"
    status=1
  fi
done
[ $status -eq 0 ] && echo "$(echo "$objects" | wc -l) objects, none shares a function"
exit $status
