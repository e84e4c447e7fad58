#!/bin/bash
# A batch on a Slurm cluster: an array of jobs, one shard each, and a job that joins the shards when all have ended.
#
#   scenarios/batch/slurm.sh SHARDS FOLDER SCENARIO.lua [OPTIONS of verisim batch]
#   scenarios/batch/slurm.sh 16 runs/pins scenarios/peg_in_hole.lua --vary clearance=1mm,5mm --repeat 500
#
# FOLDER (on a file system that all nodes see) gets shard-1 … shard-N, their logs, and `all`, the whole batch as if one
# machine had made it: its index.csv is equal to the byte. The same command again goes on where jobs were killed: a shard
# does nothing twice. Where runs are missing the joining job says which, and fails.
#
# VERISIM: the program (default: build/verisim beside this file's project, else the one in PATH).
# CPUS: of each job (default 1): so many runs at a time. WAIT=1: return when `all` is there.
# What Slurm wants to know besides (partition, account, time) goes into its own variables: SBATCH_PARTITION=short …
set -euo pipefail
if [ $# -lt 3 ] || ! [[ "$1" =~ ^[1-9][0-9]*$ ]]; then
  sed -n '2,/^set -/{/^set -/d;s/^# \{0,1\}//;p}' "$0" >&2
  exit 2
fi
shards=$1 folder=$2
shift 2
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
verisim=${VERISIM:-$project/build/verisim}
[ -x "$verisim" ] || verisim=$(command -v verisim) || { echo "error: no verisim; name the program in VERISIM" >&2; exit 2; }
verisim=$(realpath "$verisim")
command -v sbatch > /dev/null || { echo "error: no sbatch: this machine submits no jobs to Slurm (apt install slurm-client); without Slurm use verisim batch --shard" >&2; exit 2; }
cpus=${CPUS:-1}
# A shard without a run reads scenario, options and design: what is wrong with them is said here, not in each job's log.
tried=$(mktemp -d)
trap 'rm -rf "$tried"' EXIT
"$verisim" batch "$@" --jobs "$cpus" --shard 10000000/10000000 --quiet -o "$tried/none" > /dev/null
mkdir -p "$folder"
folder=$(realpath "$folder")
# A folder whose merge was killed says so, and is merged again.
if [ -e "$folder/all" ] && ! grep -qs '"merging"' "$folder/all/batch.json"; then
  echo "error: $folder/all is there already; move it away or name another folder" >&2
  exit 3
fi

batch=$(printf '%q ' "$verisim" batch "$@" --jobs "$cpus")
array=$(sbatch --parsable --job-name=verisim --array="1-$shards" --cpus-per-task="$cpus" --output="$folder/shard-%a.log" \
               --wrap="exec $batch --shard \$SLURM_ARRAY_TASK_ID/$shards -o $(printf %q "$folder")/shard-\$SLURM_ARRAY_TASK_ID")
names=()
for ((i = 1; i <= shards; ++i)); do names+=("$folder/shard-$i"); done
# afterany: a shard in which a run timed out ends with 1, and is joined all the same.
sbatch ${WAIT:+--wait} --parsable --job-name=verisim-merge --dependency="afterany:${array%%;*}" --output="$folder/all.log" \
       --wrap="exec $(printf '%q ' "$verisim" batch merge "$folder/all" "${names[@]}")" > "$folder/all.job"
echo "jobs ${array%%;*}, then $(cut -d';' -f1 "$folder/all.job"): $folder/all"
