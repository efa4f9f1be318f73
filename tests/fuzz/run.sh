#!/bin/sh
# Builds the fuzzers and runs each for SECONDS (60 where not given), or for so many inputs:
#   sh tests/fuzz/run.sh [SECONDS] [NAME]...
#   sh tests/fuzz/run.sh --runs N [NAME]...
#   sh tests/fuzz/run.sh --plain --runs N [NAME]...
# --plain does not trace comparisons: two to five times the runs, once the inputs worth keeping have been found without it.
# What they find worth keeping goes to build/fuzz/corpus/NAME; tests/fuzz/corpus/NAME are the seeds. A crash leaves its
# input in build/fuzz/crashes and ends with exit code 1.
set -eu
cd "$(dirname "$0")/../.."
plain=OFF
build=build/fuzz
if [ "${1:-}" = --plain ]; then
    plain=ON
    build=build/fuzz-plain
    shift
fi
limit=-max_total_time
if [ "${1:-}" = --runs ]; then
    limit=-runs
    shift
fi
many=${1:-60}
case $many in
'' | *[!0-9]*)
    echo "run.sh: \"$many\" is no number of seconds or runs" >&2
    exit 2
    ;;
esac
[ $# = 0 ] || shift

cmake --preset fuzz -B "$build" -DNEPHELE_FUZZ_PLAIN=$plain > /dev/null
if [ $# = 0 ]; then
    for source in tests/fuzz/fuzz_*.c; do
        set -- "$@" "$(basename "$source" .c | sed s/^fuzz_//)"
    done
fi
mkdir -p "$build/crashes"
# A heap that is small and keeps no stacks is several times quicker; a crash is run again for its stacks.
export ASAN_OPTIONS="malloc_context_size=0:quarantine_size_mb=16${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
failed=
for name in "$@"; do
    cmake --build "$build" --target "fuzz_$name" > "$build/fuzz_$name.build" 2>&1 || {
        cat "$build/fuzz_$name.build" >&2
        exit 1
    }
    seeds=tests/fuzz/corpus/$name
    found=build/fuzz/corpus/$name
    mkdir -p "$found"
    [ -d "$seeds" ] || seeds=
    options=
    timeout=10
    malloc=512
    length=4096
    case $name in
    cmdline)
        options=-detect_leaks=0 # a run ends in the middle of main, and its memory stays: a million runs are a process
        length=1024
        ;;
    grammar) # long texts are looked at with comparisons traced
        [ $plain = OFF ] || length=512
        ;;
    vdb) # the reader has limits of its own; what it may not have must reach it, and not the fuzzer
        seeds="$seeds tests/frozen/vdb"
        length=65536
        timeout=300
        malloc=1000000
        ;;
    esac
    [ ! -f "tests/fuzz/$name.dict" ] || options="$options -dict=tests/fuzz/$name.dict"
    # Ten seconds for an input are a hang, half a gigabyte at once is a hole.
    left=$many
    while [ "$left" -gt 0 ]; do
        now=$left
        [ "$name$limit" != cmdline-runs ] || [ "$now" -le 1000000 ] || now=1000000
        left=$((left - now))
        # shellcheck disable=SC2086
        "$build/fuzz/fuzz_$name" "$limit=$now" -timeout=$timeout -rss_limit_mb=1024 -malloc_limit_mb=$malloc \
            -max_len=$length -artifact_prefix="$build/crashes/$name-" -print_final_stats=1 $options \
            "$found" $seeds > "$build/fuzz_$name.log" 2>&1 || {
            failed="$failed $name"
            left=0
        }
        grep -E 'stat::number_of_executed_units|ERROR|SUMMARY' "$build/fuzz_$name.log" | sed "s/^/$name: /"
    done
done
if [ -n "$failed" ]; then
    echo "run.sh: failed:$failed (see $build/fuzz_NAME.log, inputs in $build/crashes)" >&2
    exit 1
fi
