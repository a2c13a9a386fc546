#!/usr/bin/env bash
# each_command_test.sh PROGRAM SOURCE: every command of marti once, on a small machine. Under the sanitizers it shows
# that no command has a memory error in ordinary use; other tests check what the commands print.
set -euo pipefail
program=$(realpath "$1") source=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

done_commands=()
# marti <words of the command> -- <arguments...>
marti() {
  local words=()
  while [ "$1" != -- ]; do words+=("$1") && shift; done
  shift
  done_commands+=("${words[*]}")
  "$program" "${words[@]}" "$@" >"$work/out.txt" || { echo "marti ${words[*]} $* ended with $?" >&2 && exit 1; }
  [ -s "$work/out.txt" ] || { echo "marti ${words[*]} $* printed nothing" >&2 && exit 1; }
}
small=(--set scene.source=tetra:3 --set image.width=16 --set image.height=12)

marti run -- "$source/configs/marti.toml" "${small[@]}" --set record.timeline=true --set record.heat_maps=true \
  --set record.critical_path=true -o run
marti run -- "$source/configs/pipeline.toml" "${small[@]}" -o other
marti run -- "$source/configs/space.toml" "${small[@]}" --json
marti run -- "$source/configs/marti.toml" "${small[@]}" --within 10%
marti compare -- run other
marti trace -- "$source/configs/marti.toml" "${small[@]}" --set machine.nodes=2 -o traces
marti trace -- "$source/configs/marti.toml" "${small[@]}" --set machine.nodes=2 --format csv -o traces
marti memory -- "$source/configs/marti.toml" traces/requests.csv --set machine.nodes=2 -o memory
marti report -- memory
cp "$source"/tests/fuzz/rays/*.npy .
for rays in any closest; do
  marti run -- "$source/configs/marti.toml" --set scene.source=tetra:3 --set image.integrator=rays \
    --set "image.rays=$PWD/$rays.npy" -o rays
  [ -s rays/hits.npy ] || { echo "a run of given rays says nothing of what they hit" >&2 && exit 1; }
done
marti sweep -- "$source/configs/sweep-small.toml" "${small[@]}" -o sweep
marti sweep -- "$source/configs/sweep-small.toml" "${small[@]}" -o sweep --plan
marti compare -- run sweep
marti compare -- sweep sweep -o compared.html
marti explore -- "$source/configs/marti.toml" "${small[@]}" --for 0.1 --no-browser
marti report -- sweep:3
marti report -- run
marti report -- sweep
marti study operations -- "${small[@]}"
marti study paper -- "$source/configs/paper.toml" --set image.width=8 --set image.height=6 \
  --set 'paper.scenes=["tetra:2"]' --set 'paper.run_scenes=["teapot:2:pot","teapot:2:pot"]' \
  --set 'paper.run_depths=[2,4]' -o paper
marti study frames -- "$source/configs/animation.toml" --set image.width=16 --set image.height=12 \
  --set frames.count=2 --set frames.rate=2 -o frames
marti study error -- "$source/configs/error.toml" --set image.width=9 --set image.height=9 --set scene.source=gears:1 \
  --set error.repeats=1 --set error.side=12 --set 'error.samples=[1,2]' --set 'error.depths=[1]' -o error
marti study stability -- "$source/configs/marti.toml" "${small[@]}" --set stability.rays=100 --set stability.nodes=64 -o stability
cat >suite.toml <<'TOML'
[suite]
baseline = "small"
scene = [{ name = "a", source = "tetra:2" }, { name = "b", source = "gears:1" }]
[image]
width = 8
height = 6
[sweep.points]
small = { cache.size = "1 KiB" }
large = { cache.size = "8 KiB" }
TOML
marti study suite -- suite.toml -o suite
marti scene list --
marti scene info -- tetra:3
marti scene export -- tetra:3 tetra.glb
marti config --
marti config -- cache --json
marti help -- run
marti sweep -- "$source/configs/marti.toml" "${small[@]}" --axis machine.nodes=1..2 -o axis
marti figures --
marti completion bash --
marti completion zsh --
marti completion fish --
marti man --

# No command is forgotten: the program lists its own. The words behind `help` are these commands again.
commands_of() { "$program" __complete "$@" '' | grep -vE '^[:-]' || true; }
for command in $(commands_of); do
  for word in $([ "$command" = help ] || commands_of "$command" | grep -xE '[a-z]+' || true) ''; do
    tried=no
    for name in "${done_commands[@]}"; do
      case "$name" in "$command${word:+ $word}" | "$command${word:+ $word} "*) tried=yes ;; esac
    done
    [ "$tried" = yes ] || { echo "marti $command $word is not tried here" >&2 && exit 1; }
  done
done
