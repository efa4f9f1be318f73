#!/bin/sh
# The thread sanitizer over the unit tests of what shares work between threads, with four of them: clang's OpenMP and Archer,
# which tells the sanitizer where OpenMP's threads wait for each other (Debian: clang, libomp-14-dev).
# Then neph-view's own threads: a test that draws, and the tests of its window, with four and two (Xvfb, xdotool).
#   sh tests/threads.sh [TEST]...        all, or those named; "window": what is under tests/cli_window*.sh
# Not looked at: OpenVDB and what of the tests links it (TBB is not instrumented), and the driver of OpenGL.
set -eu
cd "$(dirname "$0")/.."
build=build/tsan
[ $# -gt 0 ] || set -- test_pathtrace test_march test_march_light test_lightgrid test_paper test_opaque test_denoise \
    test_imageerror test_interval test_density test_majorant test_simplify test_grid test_volumefit test_morph test_motion \
    gl_preview window
cmake --preset tsan > /dev/null
targets=
for test in "$@"; do
    [ "$test" != window ] || test="neph-view neph-gauss neph-lsys neph-edit neph-info neph-meta neph-mesh neph-render"
    targets="$targets $test"
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
export OMP_NUM_THREADS=4 OMP_TOOL_LIBRARIES="$archer"
export TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=0 exitcode=66"
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
for test in "$@"; do
    [ "$test" != window ] || continue
    code=0
    "$build/tests/$test" > "$build/$test.log" 2>&1 || code=$?
    races=$(grep -c "WARNING: ThreadSanitizer" "$build/$test.log" || true)
    echo "$test: exit code $code, $races reports"
    [ "$code" = 0 ] || failed="$failed $test"
done
case " $* " in
*" window "*)
    for test in cli_window cli_window_files; do
        rm -f "$build/$test".tsan.*
        code=0
        OMP_NUM_THREADS=2 TSAN_OPTIONS="$TSAN_OPTIONS log_path=$PWD/$build/$test.tsan" \
            sh "tests/$test.sh" "$PWD/$build/bin" "$PWD" > "$build/$test.log" 2>&1 || code=$?
        races=$(cat "$build/$test".tsan.* 2> /dev/null | grep -c "WARNING: ThreadSanitizer" || true)
        echo "$test: exit code $code, $races reports"
        [ "$code$races" = 00 ] || failed="$failed $test"
    done
    ;;
esac
[ -z "$failed" ] || {
    echo "threads.sh: failed:$failed (see $build/NAME.log)" >&2
    exit 1
}
