#!/usr/bin/env bash
# tools/lib/processor.sh: stages get the processor time of what ran in them, and a budget that was passed is told.
set -euo pipefail
. "$PLANEFOLD_SOURCE/tools/lib/processor.sh"

fail() {
  echo "FAIL: $1"
  exit 1
}

burn() { # about so many seconds of processor time, however busy the machine is
  python3 -c "import sys, time
while time.process_time() < float(sys.argv[1]): pass" "$1"
}

stage_begin
burn 1.5
stage_end "busy"
stage_begin
sleep 1
stage_end "idle"
[ "${stage_seconds[0]}" -ge 15 ] && [ "${stage_seconds[0]}" -le 40 ] || fail "1.5 s of work were counted as ${stage_seconds[0]} tenths"
[ "${stage_seconds[1]}" -le 2 ] || fail "a second of sleep was counted as ${stage_seconds[1]} tenths"

table=$(print_stages 60)
echo "$table"
grep -q 'busy' <<<"$table" && grep -q 'in all of 60' <<<"$table" || fail "the table lacks a stage or the sum"
! grep -q OVER <<<"$table" || fail "a budget was passed that was not"
stage_seconds[0]=37000
grep -q 'OVER BUDGET: 61.7 processor minutes, 60 are planned' <<<"$(print_stages 60)" || fail "a budget was passed without a word"
! grep -q OVER <<<"$(print_stages 0)" || fail "there was no budget to pass"
