# Processor time by stage: what children of this shell spent, as the shell itself counts it. To be sourced.

stage_names=() stage_seconds=()
stage_started=0

# Sets processor_seconds to what all children that have ended spent, in tenths of a second. No subshell: it has children of its own.
processor_now() {
  local file
  file=$(mktemp) || return
  times >"$file"
  processor_seconds=$(awk 'NR == 2 { for (i = 1; i <= 2; ++i) { split($i, part, /[ms]/); sum += 60 * part[1] + part[2] } }
                           END { printf "%.0f", 10 * sum }' "$file")
  rm -f "$file"
}

stage_begin() {
  processor_now
  stage_started=$processor_seconds
}

# stage_end NAME   adds what was spent since stage_begin
stage_end() {
  processor_now
  stage_names+=("$1")
  stage_seconds+=($((processor_seconds - stage_started)))
}

# print_stages BUDGET   a table in processor minutes; with a budget (0: none) it says when that was passed
print_stages() {
  local i sum=0
  printf '  Processor minutes:\n'
  for i in "${!stage_names[@]}"; do
    sum=$((sum + stage_seconds[i]))
    awk -v name="${stage_names[$i]}" -v tenths="${stage_seconds[$i]}" 'BEGIN { printf "    %6.1f  %s\n", tenths / 600, name }'
  done
  awk -v tenths="$sum" -v budget="$1" 'BEGIN {
    printf("    %6.1f  in all%s\n", tenths / 600, (budget > 0) ? " of " budget : "")
    if (budget > 0 && tenths / 600 > budget)
      printf "  OVER BUDGET: %.1f processor minutes, %d are planned\n", tenths / 600, budget
  }'
}
