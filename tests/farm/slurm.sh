#!/usr/bin/env bash
# A library on a real Slurm of two nodes on this machine, one of which is killed in the middle: the merged report must be
# that of one machine, byte for byte. slurm.sh TOOL [CLIPS]. Installs slurm-wlm; not part of ctest.
set -euo pipefail
tool=$(realpath "$1") clips=${2:-200}
root=$(cd "$(dirname "$0")/../.." && pwd)
command -v slurmctld >/dev/null || apt-get install -y --no-install-recommends slurm-wlm >/dev/null

work=$(mktemp -d)
host=$(hostname -s)
export SLURM_CONF=$work/slurm.conf PATH=$(dirname "$tool"):$PATH
mkdir -p "$work/state" "$work/n1" "$work/n2" "$work/clips"
cat > "$SLURM_CONF" <<EOF
ClusterName=farm
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
ReturnToService=2
SlurmdTimeout=10
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/%n
SlurmctldPidFile=$work/ctld.pid
SlurmdPidFile=$work/%n.pid
SlurmctldLogFile=$work/ctld.log
SlurmdLogFile=$work/%n.log
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17001-17002] CPUs=1
PartitionName=all Nodes=ALL Default=YES State=UP
EOF
node() { slurmd -D -N "$1" -f "$SLURM_CONF" >/dev/null 2>&1 & echo $!; }
slurmctld -D -f "$SLURM_CONF" >/dev/null 2>&1 &
controller=$!
n1=$(node n1) n2=$(node n2)
trap 'kill $controller $n1 $n2 2>/dev/null || true; rm -rf "$work"' EXIT
until [[ $(sinfo -h -t idle -o %D 2>/dev/null) == 2 ]]; do sleep 1; done

# Clips of 60 frames, cut out of a recording.
recording=/usr/share/assimp/models/BVH/Boxing_Toes.bvh
start=$(grep -n MOTION "$recording" | cut -d: -f1)
for i in $(seq 0 $((clips - 1))); do
  { head -n "$start" "$recording"; echo "Frames: 60"; sed -n "$((start + 2))p" "$recording"
    sed -n "$((start + 3 + 14 * i)),$((start + 62 + 14 * i))p" "$recording"; } > "$work/clips/$(printf %04d "$i").bvh"
done
cat > "$work/library.json" <<EOF
{"characters": ["/usr/share/assimp/models/Collada/human.zae"], "motions": ["clips"]}
EOF

spherechain check "$work/library.json" -o "$work/whole" --json "$work/whole.json" >/dev/null || [[ $? == 6 ]]
"$root/scripts/farm/slurm.sh" "$work/library.json" 8 "$work/out"
until [[ -n $(squeue -h -t running -o %N | grep n2) ]]; do sleep 0.2; done
sleep 3
kill -9 "$n2"
echo "killed n2 with $(squeue -h -t running | wc -l) tasks running"
n2=$(sleep 15; node n2)
until [[ -z $(squeue -h) ]]; do sleep 1; done
cmp "$work/whole.json" "$work/out/check.json"
diff -r "$work/whole" "$work/out/report"
echo "$clips clips, 8 shards, two nodes, one killed: the report of one machine, byte for byte"
