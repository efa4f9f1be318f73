# Sequences spread over processes: by examples/frames/parallel.sh with GNU parallel, and by examples/frames/slurm.sh as the
# tasks of a Slurm array, whose variables are set here (tests/slurm.sh does it with Slurm itself). Each gives the frames that
# one process draws in a row, every one, and none twice. $1: programs, $2: source folder.
set -eu
bin=$1
source=$2
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_spread: $*" >&2
    exit 1
}

command -v parallel >/dev/null || fail "parallel is missing (tests/run.sh installs what the tests need)"
NEPH_VIEW=$bin/neph-view
export NEPH_VIEW
"$bin/neph-gauss" -q --count 8 -o "a cloud.neph"
options="--size 32x18 --samples 1 --light-grid 8 --wind 1,0,0 --fps 2"
mkdir row
# shellcheck disable=SC2086
"$bin/neph-view" -q "a cloud.neph" --frames 3..7 $options -o row/frame.%04d.png
# is_row FOLDER: it holds the same pictures
is_row()
{
    [ "$(ls "$1")" = "$(ls row)" ] || fail "$1 holds $(ls "$1" | tr '\n' ' ')"
    for frame in row/*; do
        cmp "$frame" "$1/${frame#row/}" || fail "$1 has another picture"
    done
}
# shellcheck disable=SC2086
JOBS=2 sh "$source/examples/frames/parallel.sh" "a cloud.neph" 3 7 "by parallel" $options || fail "parallel.sh failed"
is_row "by parallel"
! JOBS=2 sh "$source/examples/frames/parallel.sh" missing.neph 3 4 none >/dev/null 2>&1 || fail "parallel.sh hides a failure"

# tasks FIRST COUNT: the array's, one after the other; from any first number on
tasks()
{
    task=$1
    while [ "$task" -lt $(($1 + $2)) ]; do
        # shellcheck disable=SC2086
        SLURM_ARRAY_TASK_COUNT=$2 SLURM_ARRAY_TASK_MIN=$1 SLURM_ARRAY_TASK_ID=$task \
            sh "$source/examples/frames/slurm.sh" "a cloud.neph" 3 7 "by $2 tasks" --overwrite $options ||
            fail "task $task of $2 failed"
        ls -l --time-style=full-iso "by $2 tasks" >"listing.$task" 2>/dev/null || true
        task=$((task + 1))
    done
}
tasks 0 3
is_row "by 3 tasks"
# --overwrite draws a frame again that another task has drawn: then its time would change after that task's listing.
[ "$(wc -l <listing.0)" = 2 ] && [ "$(wc -l <listing.1)" = 4 ] || fail "three tasks share five frames as $(wc -l listing.*)"
tail -n +2 listing.0 | while read -r line; do
    grep -qF -- "$line" listing.2 || fail "a frame was drawn twice"
done
tasks 5 7
is_row "by 7 tasks"
# Without an array it is one task.
# shellcheck disable=SC2086
sh "$source/examples/frames/slurm.sh" "a cloud.neph" 3 7 "by one" $options
is_row "by one"
