# shellcheck shell=bash
# Shared by marti-quickstart, test and benchmarks: messages, the Debian packages, and configuring. To be sourced by
# bash from the project's root.

if [ -t 1 ]; then bold=$'\e[1m' plain=$'\e[0m'; else bold='' plain=''; fi

say() { printf '%s==> %s%s\n' "$bold" "$*" "$plain"; }

die() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# Is the package installed? Node and npm may be installed from elsewhere, and would then conflict with Debian's
# packages: for them it is enough that the commands exist.
is_there() {
  case $1 in
    nodejs) command -v node >/dev/null && return ;;
    npm) command -v npm >/dev/null && return ;;
  esac
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# The packages of the given sections of cmake/debian-packages.txt that are not installed.
missing_packages() {
  local section='' line
  while read -r line; do
    case $line in
      '' | '#'*) continue ;;
      '['*']') section=${line:1:-1} && continue ;;
    esac
    if [[ " $* " == *" $section "* ]] && ! is_there "$line"; then
      echo "$line"
    fi
  done <cmake/debian-packages.txt
}

# Installs the packages of the given sections that are missing. Quick when none is.
need_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "This is no Debian system: cmake/debian-packages.txt says what must be installed. Going on."
    return
  fi
  local missing
  mapfile -t missing < <(missing_packages "$@")
  if [ ${#missing[@]} -eq 0 ]; then
    return
  fi
  say "Installing Debian packages: ${missing[*]}"
  command -v apt-get >/dev/null || die "apt-get is missing; install these packages by hand: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
      die "not root and no sudo; run as root: apt-get install ${missing[*]}"
    as_root=(sudo)
  fi
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3)
  if ! "${apt[@]}" update; then
    say "The package lists could not be refreshed; trying with those at hand."
  fi
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    die "apt-get could not install ${missing[*]} (see above). Is this machine off line, or not Debian 12?"
}

# Installs optional packages in the same way, but if that fails says so and goes on.
want_packages() {
  local without=$1
  shift
  if ! command -v dpkg-query >/dev/null; then return; fi  # need_packages has said so
  (need_packages "$@") || say "Going on without it: $without"
}

# configure <log> <directory> <option...>: cmake's output goes to build/configure-<log>.log, and is shown if it
# fails.
configure() {
  local log=build/configure-$1.log directory=$2
  shift 2
  mkdir -p build
  cmake -B "$directory" "$@" >"$log" 2>&1 ||
    { cat "$log" >&2 && die "cmake could not configure $directory (see above)"; }
}

# The number of compilers at a time: at most one for each core and for each 1.5 GB of memory.
build_jobs() {
  local cores kilobytes
  cores=$(nproc)
  kilobytes=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo 2>/dev/null)
  local most=$((${kilobytes:-2000000} / 1500000))
  if [ "$most" -lt 1 ]; then most=1; fi
  echo $((cores < most ? cores : most))
}
