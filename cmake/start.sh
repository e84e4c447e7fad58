# What ./run and ./test share: install what is missing, configure, build. Sourced by bash in the project's folder.
# Each step is silent when it has nothing to do, one line long when it works, and shows its log's end when it fails.

exec 3>&2  # the terminal, where the output of a step goes to its log

die() {
  echo "error: $*" >&2
  exit 1
}

# Runs a command with its output in a log. On failure prints the log's last lines and where the whole log is.
# $1: log file   $2: what is being done, for the error's text   rest: the command
logged() {
  local log=$1 doing=$2
  shift 2
  mkdir -p "$(dirname "$log")"
  if ! "$@" </dev/null >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    die "$doing failed; all of its output is in $log"
  fi
}

# Names in packages.txt that Debian's package manager does not have installed, one a line. $1: needed, or optional (what
# stands below that heading).
missing_packages() {
  local wanted
  wanted=$(awk -v part="$1" '/^# optional$/ { is_optional = 1 } (part == "optional") == (is_optional == 1)' packages.txt |
    sed -e 's/#.*//' -e '/^[[:space:]]*$/d' -e 's/[[:space:]]//g')
  # dpkg-query fails for a name it has never heard of; that name is missing like any other.
  comm -23 <(sort -u <<<"$wanted") \
    <(xargs dpkg-query -W -f '${db:Status-Status} ${Package}\n' <<<"$wanted" 2>/dev/null | sed -n 's/^installed //p' | sort -u)
}

# Installs the missing packages; asks for nothing and calls neither sudo nor apt-get when all are there.
# $1: which, as above; those needed if it is not said
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "note: this is not a Debian system; the tools and libraries in packages.txt are taken as installed" >&2
    return
  fi
  local missing as_root=()
  missing=$(missing_packages "${1:-needed}" | xargs)
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
      die "Debian packages are missing and there is no sudo; as root, run: apt-get install --no-install-recommends $missing"
    as_root=(sudo)
    [ -t 0 ] || as_root+=(-n)  # nobody is there to type a password: fail instead of waiting
    "${as_root[@]}" true || die "sudo was refused; as root, run: apt-get install --no-install-recommends $missing"
  fi
  echo "installing $(wc -w <<<"$missing") Debian packages (of packages.txt)" >&2
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300)
  logged build/log/apt-update.log "apt-get update" "${apt[@]}" update
  # An optional package that Debian does not have (any more) is a pattern without a match, which is no error.
  [ "${1:-needed}" != optional ] || missing=$(printf '?exact-name(%s) ' $missing)
  # shellcheck disable=SC2086  # one word per package is meant
  logged build/log/apt-install.log "installing packages" "${apt[@]}" install -y --no-install-recommends $missing
}

# The same with the optional ones; what cannot be had is a note. A build that is configured looks for them again.
install_optional_packages() {
  local before missing
  command -v dpkg-query >/dev/null || return 0
  before=$(missing_packages optional | xargs)
  [ -n "$before" ] || return 0
  (install_packages optional) || true
  missing=$(missing_packages optional | xargs)
  [ "$missing" = "$before" ] || rm -f build*/build.ninja
  [ -z "$missing" ] ||
    echo "note: not installed: $missing; what needs them is left out and says so; clang-tidy is then the older one" >&2
}

# Compilers at once: one per core, but 1.8 GB of memory for each (1.6 were seen, of engine/geometry).
jobs_at_once() {
  local cores memory_jobs
  cores=$(nproc)
  memory_jobs=$(awk '/^MemTotal:/ {print int($2 / 1.8e6)}' /proc/meminfo)
  [ "$memory_jobs" -ge 1 ] || memory_jobs=1
  echo $((cores < memory_jobs ? cores : memory_jobs))
}

# Configures (once) and builds. On a terminal shows one line of progress.
# $1: CMake preset   $2: its build folder   rest: targets, all of them if none is named
build() {
  local preset=$1 folder=$2
  shift 2
  # A clone elsewhere finds in the compiler cache what this one compiled.
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
  if [ ! -f "$folder/build.ninja" ] || [ CMakePresets.json -nt "$folder/build.ninja" ]; then
    logged "$folder/log/configure.log" "configuring" cmake --preset "$preset"
  fi
  if cmake --build "$folder" --target "${@:-all}" -- -n 2>/dev/null | grep 'no work to do' >/dev/null; then return; fi
  echo "building in $folder (preset $preset)" >&2
  logged "$folder/log/build.log" "building" with_progress \
    cmake --build "$folder" --target "${@:-all}" -- -j "$(jobs_at_once)"
}

# Runs a build with all of its output on stdout, for the log; repeats ninja's [12/345] on the terminal, in place.
with_progress() {
  if [ ! -t 3 ]; then
    "$@"
    return
  fi
  "$@" 2>&1 | awk '
    { print; fflush() }
    /^\[[0-9]+\/[0-9]+\]/ { printf "\r  %s ", $1 > "/dev/fd/3"; fflush("/dev/fd/3") }
    END { printf "\r                \r" > "/dev/fd/3" }'
}
