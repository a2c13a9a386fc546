#!/usr/bin/env bash
# read_store_test.sh MARTI SOURCE PYTHON [PYTHON_WITH_MATPLOTLIB]: docs/examples/read_store.py on the store of a sweep.
set -euo pipefail
marti=$1 source=$2 python=$3 drawing=${4-}
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
"$marti" sweep "$source/configs/sweep-small.toml" --set image.width=16 --set image.height=16 -o "$directory" --quiet >/dev/null

rows=$("$python" "$source/docs/examples/read_store.py" "$directory/results.sqlite" --csv)
[ "$(head -1 <<<"$rows")" = cache.size,machine.nodes,speed_up ]
[ "$(wc -l <<<"$rows")" -eq 33 ]
# The same figures as the program's own table.
points=$(wc -l <"$directory/points.csv")
[ "$points" -eq 33 ]
! "$python" "$source/docs/examples/read_store.py" "$directory/results.sqlite" --y speed 2>"$directory/said"
grep -q 'there is no column speed; there are .*speed_up' "$directory/said"

if [ -n "$drawing" ]; then
  for name in a b; do
    "$drawing" "$source/docs/examples/read_store.py" "$directory/results.sqlite" -o "$directory/$name.svg"
  done
  cmp "$directory/a.svg" "$directory/b.svg"
  grep -q '<svg' "$directory/a.svg"
else
  echo "there is no matplotlib: the figure is not drawn"
fi
