#!/usr/bin/env bash
# The main job, end to end: bakes the MakeHuman body that Debian's assimp-testmodels installs, plays two animations of 40
# frames and three recordings of people, mends the boxer, draws what it found, and checks the recordings as a library. Results go to
# out/demo; the pages to open are human.html, boxer/clip_0.html (before and after), live.html (three characters to pose) and
# check/index.html.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_packages.sh
cmake --preset release >/dev/null
cmake --build --preset release --target spherechain draw_asset draw_character
page=build/release/share/spherechain/viewer.html
if command -v npm >/dev/null; then cmake --build --preset release --target viewer || true; fi

human=/usr/share/assimp/models/Collada/human.zae
tool=build/release/bin/spherechain
out=out/demo
mkdir -p "$out"

echo
"$tool" bake "$human" -o "$out/human.sphc" --report "$out/human_report.json"
for animation in arms legs; do
  echo
  echo "== animation_$animation"
  "$tool" play "$out/human.sphc" --source "$human" --poses "samples/poses/animation_$animation.json" --frames 40 \
    --json "$out/play_$animation.json"
done

captures=/usr/share/assimp/models/BVH
for capture in Boxing_Toes 01_01 01_03; do
  echo
  echo "== $capture"
  "$tool" play "$out/human.sphc" --source "$human" --motion "$captures/$capture.bvh" --json "$out/play_$capture.json"
  build/release/bin/draw_asset "$out/human.sphc" "$human" --motion "$captures/$capture.bvh" --frames 9 --frame 4 \
    --radius detect -o "$out/$capture.png" >/dev/null
done

echo
echo "== fix"
"$tool" fix "$human" --motion "$captures/Boxing_Toes.bvh" -o "$out/boxer.glb" --report "$out/boxer" ||
  [[ $? == 5 ]] # some faults are only reduced

build/release/bin/draw_character "$human" -o "$out/regions.png"
build/release/bin/draw_asset "$out/human.sphc" "$human" -o "$out/rest.png" >/dev/null
for pose in hands_on_hips arms_crossed hand_behind_head leg_over_leg deep_squat; do
  build/release/bin/draw_asset "$out/human.sphc" "$human" --poses "samples/poses/$pose.json" --radius detect \
    -o "$out/$pose.png" >/dev/null
done

if [[ -f $page ]]; then
  "$tool" view "$out/human.sphc" --source "$human" --motion "$captures/Boxing_Toes.bvh" --fps 15 \
    --report "$out/human_report.json" -o "$out/human.html" >/dev/null
  scripts/live_demo.sh "$tool" "$out"
fi

echo
echo "== check"
recordings=$(mktemp -d)
trap 'rm -r "$recordings"' EXIT
for capture in Boxing_Toes 01_01 01_03; do ln -s "$captures/$capture.bvh" "$recordings"; done
rm -rf "$out/check"
"$tool" check "$human" --motion "$recordings" --fps 30 -o "$out/check" --json "$out/check.json" --fail-on none

echo
echo "Wrote, in $out:"
ls -1 "$out" | sed 's/^/  /'
if [[ -f $page ]]; then
  echo "Open $out/human.html, $out/boxer/clip_0.html, $out/live.html and $out/check/index.html in a browser."
else
  echo "The page of \`spherechain view\` is left out: it is built where Node and npm are."
fi
