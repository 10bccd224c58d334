#!/usr/bin/env bash
# Scores what papers published, as docs/benchmark.md explains: bodies and motions in folders that you have. It downloads
# nothing. scripts/benchmark.sh SPHERECHAIN OUT [--r2et FOLDER] [--poseshield FOLDER] [--body CHARACTER]
# R2ET is a copy of its repository (Kebii/R2ET), POSESHIELD of its (lzhyu/PoseShield), whose motions are carried over to
# CHARACTER: a body of SMPL is not in it. Prints a table, and leaves scores and mended bodies in OUT.
set -euo pipefail
tool=${1:?usage: benchmark.sh SPHERECHAIN OUT [--r2et FOLDER] [--poseshield FOLDER] [--body CHARACTER]} out=${2:?an output folder}
shift 2
r2et='' poseshield='' body=/usr/share/assimp/models/Collada/human.zae
while [[ $# -gt 0 ]]; do
  case $1 in
    --r2et) r2et=$2 ;;
    --poseshield) poseshield=$2 ;;
    --body) body=$2 ;;
    *) echo "benchmark.sh: $1 is no option" >&2 && exit 2 ;;
  esac
  shift 2
done
mkdir -p "$out"

# line BODY CLIP SCORES: a row of the table from a folder of scores.
line() {
  awk -F, -v body="$1" -v clip="$2" '
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i }
    NR == 2 { printf "| %s | %s | %.1f | %.1f | %.1f | %.2f | %.1f | %.2f | %.2f |\n", body, clip, 100 * $at["fault_frames"],
              $at["depth_percent_max"], 100 * $at["star_penetration_rate"], 100 * $at["voxel_volume"], $at["far_pairs_50"],
              $at["joint_shift_percent"], $at["hand_acceleration"] }' "$3/score.csv"
}

# score_motion BODY NAME CHARACTER MOTION REFERENCE
score_motion() {
  local folder="$out/$1_$2"
  "$tool" score "$3" --motion "$4" --reference "$5" -o "$folder" >/dev/null
  line "$1" "$2" "$folder"
}

# score_mended BODY BUDGET CHARACTER MOTION: the motion after `fix`, which leaves some faults (5).
score_mended() {
  local name="$1_fix_$2"
  "$tool" fix "$3" --motion "$4" --budget "$2" -o "$out/$name.glb" >"$out/$name.txt" 2>&1 || [[ $? == 5 ]]
  "$tool" score "$out/$name.glb" --reference "$4" -o "$out/$name" >/dev/null
  line "$1" "fix, $2 degrees" "$out/$name"
}

echo '| body | clip | faulty, % | deepest, % | STaR, % | voxels, % | far pairs | joint shift, % | hands, m/s² |'
echo '|---|---|---|---|---|---|---|---|---|'
if [[ -n $r2et ]]; then
  copy="$r2et/datasets/mixamo/demo/Ortiz/Gangnam Style.bvh"
  for name in Sporty_Granny Mousey Big_Vegas; do
    character="$r2et/datasets/mixamo/test_shape/$name.npz"
    own="$r2et/datasets/mixamo/demo/$name/Gangnam Style.bvh"
    [[ ! -f $own ]] || score_motion "$name" Mixamo "$character" "$own" "$copy"
    score_motion "$name" copy "$character" "$copy" "$copy"
    score_motion "$name" R2ET "$character" "$r2et/visualization/bvh_files/Robot_to_${name}_Gangnam Style.bvh" "$copy"
    for budget in 25 60; do score_mended "$name" "$budget" "$character" "$copy"; done
  done
fi
if [[ -n $poseshield ]]; then
  name=$(basename "${body%.*}") demo="$poseshield/demos/contact_render_demo"
  score_motion "$name" original "$body" "$demo/original_motion.npy" "$demo/original_motion.npy"
  score_motion "$name" PoseShield "$body" "$demo/optimized_motion.npy" "$demo/original_motion.npy"
  score_mended "$name" 25 "$body" "$demo/original_motion.npy"
fi
