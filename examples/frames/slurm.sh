#!/bin/sh
# A sequence drawn by a Slurm array (Debian: slurm-wlm): each task draws a stretch of frames. What is there already is left
# alone, so the same job, submitted again, draws what is missing.
#
#     sbatch --array=0-9 examples/frames/slurm.sh CLOUD.neph FIRST LAST FOLDER [OPTION]...
#     sbatch --array=0-9 examples/frames/slurm.sh castellanus.neph 0 249 frames --size 1280x720 --wind 2,0,0
#
# All nodes must see the cloud and the folder by these names. NEPH_VIEW: the program [neph-view].
#SBATCH --job-name=neph-frames
#SBATCH --cpus-per-task=2
#SBATCH --output=neph-frames-%A-%a.log
set -eu
if [ $# -lt 4 ]; then
    echo "usage: sbatch --array=0-N $0 CLOUD FIRST LAST FOLDER [OPTION]..." >&2
    exit 2
fi
cloud=$1 first=$2 last=$3 folder=$4
shift 4
# Task t of n, counted from the array's first, draws frames first + length t / n to first + length (t + 1) / n.
tasks=${SLURM_ARRAY_TASK_COUNT:-1}
task=$((${SLURM_ARRAY_TASK_ID:-0} - ${SLURM_ARRAY_TASK_MIN:-0}))
length=$((last - first + 1))
from=$((first + length * task / tasks))
to=$((first + length * (task + 1) / tasks - 1))
if [ "$from" -gt "$to" ]; then
    exit 0 # more tasks than frames
fi
export OMP_NUM_THREADS="${SLURM_CPUS_PER_TASK:-2}"
mkdir -p "$folder"
exec "${NEPH_VIEW:-neph-view}" -q "$cloud" --frames "$from..$to" -o "$folder/frame.%04d.png" "$@"
