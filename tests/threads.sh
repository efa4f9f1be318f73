#!/bin/sh
# The thread sanitizer over the unit tests of what shares work between threads, with four of them: clang's OpenMP and Archer,
# which tells the sanitizer where OpenMP's threads wait for each other (Debian: clang, libomp-14-dev).
# Then neph-view's own threads: a test that draws, and the tests of its window, with four and two (Xvfb, xdotool).
#   sh tests/threads.sh [TEST]...        what shares work, or those named; "window": what is under tests/cli_window*.sh
#   sh tests/threads.sh all [TEST]...    the whole suite but what is left out, cheapest first
# A process that takes more than SECONDS_EACH (600) of processor time is ended, and its test counts as not ended.
# Not looked at: what OpenVDB does in TBB's threads (tests/threads.supp), and the driver of OpenGL.
set -eu
cd "$(dirname "$0")/.."
build=build/tsan
seconds=${SECONDS_EACH:-600}

# What cannot be looked at so, and why.
left_out() {
    case $1 in
    test_mesh_vdb_memory) echo "has a new of its own, as the sanitizer does" ;;
    cli_memory) echo "preloads an allocator; the sanitizer has its own" ;;
    cli_limits) echo "limits the memory below what the sanitizer takes" ;;
    cli_install | cli_headers | cli_same_bytes | cli_contributing | cli_engine) echo "compiles, and runs what it built" ;;
    cli_docs) echo "runs commands of other tests, for minutes" ;;
    test_stop | cli_kill) echo "measures times" ;;
    cli_window*) echo "waits by the clock; \"window\" runs two of them" ;;
    *) return 1 ;;
    esac
}

# The whole suite, cheapest first by what a CTest in this build or in build/release measured.
whole_suite() {
    for file in tests/test_*.c tests/gl_*.c tests/stability/test_stability.c tests/stability/test_budget.c tests/stability/sweep.c \
        tests/cli_*.sh; do
        name=${file##*/}
        echo "${name%.*}"
    done > "$build/suite"
    cat build/release/Testing/Temporary/CTestCostData.txt "$build/Testing/Temporary/CTestCostData.txt" 2> /dev/null |
        awk 'NR == FNR { cost[$1] = $3; next } { print($1 in cost ? cost[$1] : 1e9, $1) }' - "$build/suite" |
        sort -g | cut -d' ' -f2
}

if [ "${1:-}" = all ]; then
    shift
    [ $# -gt 0 ] || {
        cmake --preset tsan > /dev/null
        # shellcheck disable=SC2046
        set -- $(whole_suite)
    }
    for test in "$@"; do
        shift
        if reason=$(left_out "$test"); then
            echo "$test: left out, $reason"
        else
            set -- "$@" "$test"
        fi
    done
elif [ $# = 0 ]; then
    set -- test_pathtrace test_march test_march_light test_lightgrid test_paper test_opaque test_denoise \
        test_imageerror test_interval test_density test_majorant test_simplify test_grid test_volumefit test_morph test_motion \
        gl_preview window
fi
cmake --preset tsan > /dev/null
programs="neph-view neph-gauss neph-lsys neph-edit neph-info neph-meta neph-mesh neph-layer neph-render neph-vdb neph-chart"
targets=
for test in "$@"; do
    case $test in
    window | cli_*) targets="$targets $programs" ;;
    *) targets="$targets $test" ;;
    esac
done
# shellcheck disable=SC2086
cmake --build "$build" --target $targets > "$build/build.log" 2>&1 || {
    tail -n 40 "$build/build.log" >&2
    exit 1
}
archer=$(find /usr/lib/llvm-*/lib -name libarcher.so 2> /dev/null | sort | tail -n 1)
[ -n "$archer" ] || {
    echo "threads.sh: libarcher.so is missing (apt install libomp-14-dev)" >&2
    exit 2
}
# The OpenMP library itself is not instrumented; what it synchronises is told by Archer.
export OMP_NUM_THREADS=4 OMP_WAIT_POLICY=passive NEPHELE_SLOW=20 OMP_TOOL_LIBRARIES="$archer"
# die_after_fork: the process that reads a .vdb is forked, and OpenVDB starts a thread there.
export TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=0 exitcode=66 die_after_fork=0 \
suppressions=$PWD/tests/threads.supp"
# A race must be found, and a sum that OpenMP joins must not be taken for one.
printf '%s\n' '#include <stdlib.h>' 'static long sum;' 'int main(int argc, char **argv) {' 'long *out = &sum, own = 0;' \
    '#pragma omp parallel for num_threads(4) reduction(+ : own)' \
    'for (int i = 0; i < 100000; i++) { own += i; if (argc > 1) *out += i; }' \
    'return own != 4999950000 || (argc > 2 && !argv); }' > "$build/race.c"
clang -g -O1 -fopenmp=libomp -fsanitize=thread "$build/race.c" -o "$build/race" -L"${archer%/*}" -Wl,-rpath,"${archer%/*}"
"$build/race" > "$build/race.log" 2>&1 || {
    echo "threads.sh: a race is reported where there is none (see $build/race.log)" >&2
    exit 1
}
! "$build/race" on purpose > "$build/race.log" 2>&1 || {
    echo "threads.sh: a race made on purpose is not found" >&2
    exit 1
}
failed=
looked=0
late=0

# run TEST COMMAND...: in a folder of its own; what the sanitizer says goes to build/tsan/TEST.tsan.PID
run() {
    name=$1
    shift
    rm -f "$build/$name".tsan.*
    mkdir -p "$build/place"
    code=0
    (
        TSAN_OPTIONS="$TSAN_OPTIONS log_path=$PWD/$build/$name.tsan"
        export TSAN_OPTIONS
        cd "$build/place"
        ulimit -S -t "$seconds"
        exec "$@"
    ) > "$build/$name.log" 2>&1 || code=$?
    races=$(cat "$build/$name".tsan.* 2> /dev/null | grep -c "WARNING: ThreadSanitizer" || true)
    looked=$((looked + 1))
    if [ "$code" = 152 ]; then # SIGXCPU
        late=$((late + 1))
        echo "$name: not ended in $seconds s, $races reports"
        [ "$races" = 0 ] || failed="$failed $name"
    else
        echo "$name: ended, exit code $code, $races reports"
        [ "$code$races" = 00 ] || failed="$failed $name"
    fi
}

for test in "$@"; do
    case $test in
    window)
        OMP_NUM_THREADS=2
        for window in cli_window cli_window_files; do
            run $window sh "$PWD/tests/$window.sh" "$PWD/$build/bin" "$PWD"
        done
        OMP_NUM_THREADS=4
        ;;
    cli_*) run "$test" sh "$PWD/tests/$test.sh" "$PWD/$build/bin" "$PWD" ;;
    sweep) run sweep "$PWD/$build/tests/stability/sweep" 20 ;; # pictures, of CTest's 200
    test_stability | test_budget) run "$test" "$PWD/$build/tests/stability/$test" ;;
    *) run "$test" "$PWD/$build/tests/$test" ;;
    esac
done
echo "threads.sh: $looked tests, $late not ended in their time, with reports or failed:${failed:- none}"
[ -z "$failed" ] || {
    echo "threads.sh: see $build/NAME.log and NAME.tsan.*" >&2
    exit 1
}
