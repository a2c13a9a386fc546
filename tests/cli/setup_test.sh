#!/usr/bin/env bash
# Does cmake/setup.sh install what is missing and nothing else, and say why when it cannot? dpkg-query,
# apt-get, id and sudo are replaced by scripts that write down what they are asked for.
# Usage: setup_test.sh ROOT
set -euo pipefail
cd "$1"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
for tool in bash awk nproc basename env cat rm; do ln -s "$(command -v "$tool")" "$work/bin/$tool"; done

stub() { printf '#!/usr/bin/env bash\n%s\n' "$2" >"$work/bin/$1" && chmod +x "$work/bin/$1"; }
all_installed='echo installed'
# shellcheck disable=SC2016  # the script is to expand it
ninja_missing='case ${!#} in ninja-build) exit 1 ;; libgtest-dev) echo config-files ;; *) echo installed ;; esac'
record="echo \"\$(basename \"\$0\") \$*\" >>$work/calls"

# check <what> <expected status> <pattern of the output> <pattern of the calls> <sections...>
# With $function instead of need_packages when that is set.
check() {
  local what=$1 expected=$2 output=$3 calls=$4 status=0
  shift 4
  : >"$work/calls"
  PATH="$work/bin" bash -c 'set -euo pipefail; source cmake/setup.sh; "$@"' setup "${function:-need_packages}" "$@" \
    >"$work/output" 2>&1 || status=$?
  if [ "$status" -ne "$expected" ] || ! [[ $(<"$work/output") =~ $output ]] || ! [[ $(<"$work/calls") =~ $calls ]]; then
    printf 'FAILED: %s\nstatus %s, output:\n%s\ncalls:\n%s\n' "$what" "$status" "$(<"$work/output")" \
      "$(<"$work/calls")"
    exit 1
  fi
  echo "right: $what"
}

stub id 'echo 0'
stub apt-get "$record"
stub dpkg-query "$all_installed"
check 'nothing is missing' 0 '^$' '^$' build test

stub dpkg-query "$ninja_missing"
check 'one package is missing' 0 'Installing Debian packages: ninja-build$' ' update.* install .* ninja-build$' build
check 'one of each section' 0 'ninja-build libgtest-dev$' 'ninja-build libgtest-dev$' build test
check 'only the sections asked for' 0 'packages: libgtest-dev$' 'libgtest-dev$' test

# Node and npm that did not come as Debian's packages are not installed again.
# shellcheck disable=SC2016  # the script is to expand it
node_missing='case ${!#} in nodejs|npm) exit 1 ;; *) echo installed ;; esac'
stub dpkg-query "$node_missing"
check 'node and npm are missing' 0 'packages: nodejs npm$' ' install .* --no-install-recommends nodejs npm$' report
stub node ''
check 'node is there' 0 'packages: npm$' ' --no-install-recommends npm$' report
stub npm ''
check 'node and npm are there' 0 '^$' '^$' report
rm "$work/bin/node" "$work/bin/npm"
stub apt-get "$record; [[ \$* != *install* ]]"
function=want_packages check 'what can be done without cannot be installed' 0 \
  'could not install nodejs npm .*Going on without it: no pictures' 'install' 'no pictures' report
stub dpkg-query "$ninja_missing"

check 'apt-get fails' 1 'could not install ninja-build .*off line' 'install' build

stub apt-get "$record; [[ \$* == *install* ]]"
check 'only the update fails' 0 'could not be refreshed' 'install .* ninja-build$' build

stub id 'echo 1000'
check 'neither root nor sudo' 1 'not root and no sudo; run as root: apt-get install ninja-build' '^$' build
stub sudo "$record; exec \"\$@\""
stub apt-get "$record"
check 'sudo is used' 0 'Installing' 'sudo .*apt-get .*install .* ninja-build' build

rm "$work/bin/apt-get"
check 'no apt-get' 1 'apt-get is missing; install these packages by hand: ninja-build' '^$' build
rm "$work/bin/dpkg-query"
check 'not Debian' 0 'no Debian system' '^$' build
