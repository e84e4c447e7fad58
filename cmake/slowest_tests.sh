#!/bin/bash
# Passes ctest's output on and names the ten slowest tests before ctest's own summary.
awk '
  /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: .* sec *$/ { seconds[$4] = $(NF - 1) }
  /^[0-9]+% tests passed, / && length(seconds) > 10 {
    print "The ten slowest tests:"
    fflush()
    sorted = "sort -rn | head -n 10"
    for (name in seconds) printf "%9.2f s  %s\n", seconds[name], name | sorted
    close(sorted)
    print ""
  }
  { print; fflush() }'
