#!/bin/sh
# A sequence drawn by several processes: GNU parallel hands out single frames (Debian: parallel). Frames are independent,
# and those that are there already are left alone, so a run that broke off goes on by the same command, on one machine or,
# with --sshlogin and a folder that all can see, on several.
#
#     sh examples/frames/parallel.sh CLOUD.neph FIRST LAST FOLDER [OPTION]...
#     sh examples/frames/parallel.sh castellanus.neph 0 249 frames --size 1280x720 --wind 2,0,0 --shear 0.02
#
# JOBS: how many at once [the number of processors / 2, since each process uses several]. NEPH_VIEW: the program [neph-view].
set -eu
if [ $# -lt 4 ]; then
    echo "usage: $0 CLOUD FIRST LAST FOLDER [OPTION]..." >&2
    exit 2
fi
cloud=$1 first=$2 last=$3 folder=$4
shift 4
processors=$(nproc)
jobs=${JOBS:-$(((processors + 1) / 2))}
mkdir -p "$folder"
# Each frame is one process; --halt tells of the first that fails, --joblog and --resume would do what is done anyway.
seq "$first" "$last" | parallel --jobs "$jobs" --halt soon,fail=1 --quote \
    "${NEPH_VIEW:-neph-view}" -q "$cloud" --frames {} -o "$folder/frame.%04d.png" "$@"
