#!/bin/bash
# Runs the programs given, compares what each prints with what the first one prints, and names the first line that
# differs. Exits with 1 if one differs, fails or prints nothing.
set -uo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
verdict=0
for program in "$@"; do
  name=$(basename "$program")
  if ! "$program" >"$work/this" || [ ! -s "$work/this" ]; then
    echo "$name: failed or printed nothing"
    verdict=1
    continue
  fi
  [ -f "$work/first" ] || { cp "$work/this" "$work/first" && first=$name; }
  if difference=$(diff "$work/first" "$work/this"); then
    echo "$name: $(tail -n 1 "$work/this")"
  else
    printf '%s differs from %s:\n%s\n' "$name" "$first" "$(head -n 4 <<<"$difference")"
    verdict=1
  fi
done
exit $verdict
