#!/usr/bin/env bash
# From the raw scans of a small cave to a lit picture: installs what is needed, builds, converts the six
# bundled stations (each in its own frame, no poses given), prints the octree's statistics and renders.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
scripts/build.sh

out=out/demo
mkdir -p "$out"
glowworm=build/release/glowworm
view=build/release/glowworm-view

echo
echo "== convert: six raw scans to one octree"
"$glowworm" convert demo/scans -o "$out/cave.svo" --force

echo
echo "== info: what is in it"
"$glowworm" info "$out/cave.svo"

render() {   # name camera flags...
    local name=$1 camera=$2
    shift 2
    "$view" "$out/cave.svo" --headless --scene demo/scene.json --camera "$camera" "$@" \
        -o "$out/$name" --force
}
echo
echo "== render: the chamber, then a place where no lamp can be seen, before and after bounces"
render chamber.exr chamber --converge
render chamber.png chamber --converge
render bend_direct.png round_the_bend --bounces 0 --exposure 6
render bend_bounces.png round_the_bend --converge --exposure 6

echo
echo "Pictures: $out/chamber.png, $out/bend_direct.png (no bounces: black), $out/bend_bounces.png"
echo "Linear frame with layers: $out/chamber.exr"
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    echo "Walk through it: $view $out/cave.svo --scene demo/scene.json"
    if command -v xdg-open >/dev/null; then xdg-open "$out/chamber.png" >/dev/null 2>&1 || true; fi
fi
