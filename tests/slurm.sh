# examples/frames/slurm.sh with Slurm itself, on this machine as its one node: a command of its own, since it starts munged,
# slurmctld and slurmd (Debian: slurm-wlm, munge), for which it must be root. They end with it.
#
#     sh tests/slurm.sh build/release/bin .
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)

fail()
{
    echo "slurm: $*" >&2
    exit 1
}

[ "$(id -u)" = 0 ] || fail "this must be run by root, since it starts Slurm's daemons"
for tool in slurmctld slurmd sbatch munged; do
    command -v $tool >/dev/null || PATH=$PATH:/usr/sbin command -v $tool >/dev/null ||
        fail "$tool is missing (apt-get install slurm-wlm munge)"
done
PATH=$PATH:/usr/sbin
temporary=$(mktemp -d)
chmod 755 "$temporary"
started=
finish()
{
    status=$?
    trap - EXIT
    for file in "$temporary/slurmd.pid" "$temporary/slurmctld.pid"; do
        [ ! -s "$file" ] || kill "$(cat "$file")" 2>/dev/null || true
    done
    [ -z "$started" ] || kill "$(cat /run/munge/munged.pid)" 2>/dev/null || true
    sleep 1
    rm -rf "$temporary"
    exit "$status"
}
trap finish EXIT
cd "$temporary"
mkdir state spool
host=$(hostname -s)
cat >slurm.conf <<END
ClusterName=one
SlurmctldHost=$host
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SlurmUser=root
SlurmctldPidFile=$temporary/slurmctld.pid
SlurmdPidFile=$temporary/slurmd.pid
SlurmdSpoolDir=$temporary/spool
StateSaveLocation=$temporary/state
SlurmctldLogFile=$temporary/slurmctld.log
SlurmdLogFile=$temporary/slurmd.log
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
NodeName=$host CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=60 State=UP
END
SLURM_CONF=$temporary/slurm.conf
NEPH_VIEW=$bin/neph-view
export SLURM_CONF NEPH_VIEW
if ! munge -n >/dev/null 2>&1; then
    mkdir -p /run/munge
    chown munge:munge /run/munge
    su munge -s /bin/sh -c "$(command -v munged)"
    started=yes
fi
slurmctld
slurmd
tries=0
until sinfo -h 2>/dev/null | grep -q idle; do
    tries=$((tries + 1))
    [ "$tries" -lt 30 ] || fail "the node does not come up: $(tail -n 3 slurmctld.log slurmd.log)"
    sleep 1
done

"$bin/neph-gauss" -q --count 8 -o cloud.neph
options="--size 32x18 --samples 1 --light-grid 8 --wind 1,0,0"
mkdir row
# shellcheck disable=SC2086
"$bin/neph-view" -q cloud.neph --frames 0..9 $options -o row/frame.%04d.png
# shellcheck disable=SC2086
sbatch --wait --array=0-3 "$source/examples/frames/slurm.sh" "$temporary/cloud.neph" 0 9 "$temporary/array" $options ||
    fail "the array failed: $(cat neph-frames-*.log)"
[ "$(ls array)" = "$(ls row)" ] || fail "the array drew $(ls array | tr '\n' ' ')"
for frame in row/*; do
    cmp "$frame" "array/${frame#row/}" || fail "a frame of the array is another picture"
done
echo "slurm: $(sinfo --version): an array of 4 tasks drew the 10 frames that one process draws"
