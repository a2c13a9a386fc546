#!/usr/bin/env bash
# Renders the charts of a study: cmake/plots.sh DIR [--png] turns every DIR/*.vl.json into DIR/*.svg, and with
# --png also into DIR/*.png. Needs node and npm; PNG needs rsvg-convert (Debian: librsvg2-bin). The versions of
# Vega and Vega-Lite are those of cmake/plots/package-lock.json.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/plots" && pwd)

die() { echo "plots.sh: $*" >&2 && exit 2; }

[ $# -ge 1 ] && [ $# -le 2 ] && [ "${2---png}" = --png ] || die "usage: plots.sh DIR [--png]"
directory=$1
[ -d "$directory" ] || die "$directory is no directory"
shopt -s nullglob
charts=("$directory"/*.vl.json)
[ ${#charts[@]} -gt 0 ] || die "$directory holds no *.vl.json"
command -v node >/dev/null && command -v npm >/dev/null || die "node and npm are needed (Debian: nodejs, npm)"
if [ $# -eq 2 ] && ! command -v rsvg-convert >/dev/null; then
  die "rsvg-convert is needed for --png (Debian: librsvg2-bin)"
fi

# Anew only when the lock file has changed.
if ! cmp -s "$here/package-lock.json" "$here/node_modules/.installed-lock.json"; then
  npm ci --prefix "$here" --no-audit --no-fund --ignore-scripts
  cp "$here/package-lock.json" "$here/node_modules/.installed-lock.json"
fi
for chart in "${charts[@]}"; do
  svg=${chart%.vl.json}.svg
  node "$here/render.mjs" "$chart" "$svg"
  if [ $# -eq 2 ]; then
    rsvg-convert --zoom 1.5 "$svg" -o "${svg%.svg}.png"
  fi
  echo "$svg"
done
