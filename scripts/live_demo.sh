#!/usr/bin/env bash
# Three characters to pose by hand, in one page that opens from disk: OUT/live.html, which shows OUT/live/*.html.
# scripts/live_demo.sh build/release/bin/spherechain OUT
set -euo pipefail
tool=${1:?usage: live_demo.sh SPHERECHAIN OUT} out=${2:?usage: live_demo.sh SPHERECHAIN OUT}
models=/usr/share/assimp/models  # Debian: assimp-testmodels
mkdir -p "$out/live"

show() {  # NAME SOURCE, then how it moves
  local name=$1 source=$2
  shift 2
  "$tool" bake "$source" -o "$out/live/$name.sphc" >/dev/null
  "$tool" view "$out/live/$name.sphc" --source "$source" "$@" -o "$out/live/$name.html" >/dev/null
}
show human "$models/Collada/human.zae" --poses samples/poses/arms_crossed.json
show dancer "$models/X/BCN_Epileptic.X"
show bison "$models/X/Testwuson.X"

cat >"$out/live.html" <<'END'
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>spherechain: three characters to pose</title>
<style>
  body { margin: 0; height: 100vh; display: flex; flex-direction: column; font: 14px system-ui, sans-serif; }
  nav { display: flex; gap: 16px; padding: 8px 12px; background: #16202b; color: #9daab8; }
  nav a { color: #fff; }
  iframe { flex: 1; border: 0; }
</style>
<nav>
  <a href="live/human.html" target="character">Human</a>
  <a href="live/dancer.html" target="character">Dancer</a>
  <a href="live/bison.html" target="character">Bison</a>
  <span>Click Pose, then drag a handle: contacts follow.</span>
</nav>
<iframe name="character" title="The character" src="live/human.html"></iframe>
</html>
END
echo "Open $out/live.html in a browser."
