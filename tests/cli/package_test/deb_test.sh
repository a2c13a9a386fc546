#!/usr/bin/env bash
# deb_test.sh BUILD: the Debian package that cpack makes holds the program and what belongs to it, names the packages
# that it needs, and runs from where it is unpacked.
set -euo pipefail
build=$(realpath "$1")
command -v dpkg-shlibdeps >/dev/null || { echo "skipped: no dpkg-dev" && exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cpack --config "$build/CPackConfig.cmake" -B "$work/pack" >"$work/log" 2>&1 || { cat "$work/log" >&2 && exit 1; }
package=$(echo "$work"/pack/marti_*.deb)
[ -f "$package" ] || { echo "no single package: $package" >&2 && exit 1; }
depends=$(dpkg-deb -f "$package" Depends)
for needed in libc6 libopenimageio libtbb12 libsqlite3; do
  [[ $depends == *"$needed"* ]] || { echo "$needed is not in: $depends" >&2 && exit 1; }
done
dpkg-deb -x "$package" "$work/root"
for file in bin/marti share/man/man1/marti.1 share/bash-completion/completions/marti \
  share/fish/vendor_completions.d/marti.fish share/zsh/site-functions/_marti share/marti/configs/marti.toml \
  share/doc/marti/tutorial.md share/doc/marti/examples/marti.ipynb share/doc/marti/copyright; do
  [ -s "$work/root/usr/$file" ] || [ -s "$work/root/usr/$file.gz" ] || { echo "$file is missing" >&2 && exit 1; }
done
module=$work/root/usr/lib/python3/dist-packages
if [ -e "$module" ] && /usr/bin/python3 -c 'import numpy, pandas' 2>/dev/null; then
  frame=$(PYTHONPATH=$module /usr/bin/python3 -B -c 'import marti; print(marti.run(scene__source="tetra:2", image__width=8).end)')
  [ "$frame" -gt 0 ] || { echo "import marti gives $frame" >&2 && exit 1; }
fi
[ ! -e "$work/root/usr/include" ] || { echo "headers are in the program's package" >&2 && exit 1; }
"$work/root/usr/bin/marti" run "$work/root/usr/share/marti/configs/marti.toml" --set scene.source=tetra:3 \
  --set image.width=16 --set image.height=12 -o "$work/out" >/dev/null
[ -s "$work/out/image.png" ]
