#!/usr/bin/env bash
# program_test.sh PREFIX BINDIR SOURCE: the installed program writes images with the library that was installed beside
# it, and serves the page of explore; without those libraries it runs all the same, and refuses only these.
set -euo pipefail
program=$1/$2/marti
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
run=(run "$3/configs/marti.toml" --set scene.source=tetra:3 --set image.width=16 --set image.height=12)

LD_DEBUG=files LD_DEBUG_OUTPUT="$work/libraries" "$program" "${run[@]}" -o "$work/out" >/dev/null
[ -s "$work/out/image.exr" ] && [ -s "$work/out/image.png" ]
loaded=$(grep -ho 'calling init: .*marti_image_codec.so' "$work"/libraries.* | sed 's/calling init: //')
[ "$(realpath "$loaded")" = "$(realpath "$1")/${loaded##*/../}" ] || { echo "loaded $loaded" >&2 && exit 1; }

"$program" explore "${run[@]:1}" --for 0.01 | grep -q '^http://127.0.0.1:'

mkdir "$work/alone"
cp "$program" "$work/alone"
"$work/alone/marti" "${run[@]}" >/dev/null
status=0
"$work/alone/marti" "${run[@]}" -o "$work/none" >/dev/null 2>"$work/message" || status=$?
[ "$status" = 2 ] && grep -q '^marti: image files can be neither read nor written.*marti_image_codec.so' "$work/message" ||
  { echo "status $status: $(cat "$work/message")" >&2 && exit 1; }
status=0
"$work/alone/marti" explore "${run[@]:1}" --for 0.01 >/dev/null 2>"$work/message" || status=$?
[ "$status" = 2 ] && grep -q '^marti: explore: a library cannot be loaded.*marti_http_server.so' "$work/message" ||
  { echo "status $status: $(cat "$work/message")" >&2 && exit 1; }
