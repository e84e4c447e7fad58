#!/bin/bash
# Names every source line that clang-format ($1) would change. To change them: clang-format -i FILE.
set -euo pipefail
folders=()
for folder in engine tests bench firmware_sim; do [ ! -d $folder ] || folders+=("$folder"); done
find "${folders[@]}" \( -name '*.cpp' -o -name '*.hpp' -o -name '*.ino' \) -print0 |
  xargs -0 -r "$1" --dry-run -Werror
