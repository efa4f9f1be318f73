#!/bin/sh
# The whole test suite under valgrind's memcheck: unit tests and tests that draw themselves, and tests/cli_*.sh with each
# program that they start. Called by valgrind.sh: sh tests/valgrind.sh PROGRAMS SOURCE all [TEST]...
# Cheapest first, by what CTest measured; one thread. A process that takes more than SECONDS_EACH (600) of processor time is ended,
# and its test counts as not ended. LOGS, a folder, keeps what valgrind and the tests said.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
shift 3
build=$(dirname "$bin")
seconds=${SECONDS_EACH:-600}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
logs=${LOGS:-$tmp/logs}
mkdir -p "$logs" "$tmp/bin"
logs=$(cd "$logs" && pwd)
export OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive NEPHELE_SLOW=60 LOGS="$logs"
check="valgrind --quiet --fair-sched=try --keep-debuginfo=yes --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite
 --suppressions=$source/tests/valgrind.supp"
check=$(echo "$check" | tr -d '\n')
for program in "$bin"/neph-*; do
    name=${program##*/}
    printf '#!/bin/sh\nexec %s --log-file="$LOGS/$TEST.%%p" "%s" "$@"\n' "$check" "$program" > "$tmp/bin/$name"
    chmod +x "$tmp/bin/$name"
done

# What cannot be looked at so, and why.
left_out() {
    case $1 in
    cli_limits) echo "limits the memory below what valgrind takes" ;;
    cli_memory) echo "preloads an allocator of its own" ;;
    cli_kill) echo "kills after times that were measured, and mounts full disks" ;;
    cli_late) echo "copies a program away from its module" ;;
    cli_install | cli_headers | cli_same_bytes | cli_contributing | cli_engine) echo "compiles, and runs what it built" ;;
    cli_docs) echo "runs programs by PATH, most of them in other tests" ;;
    cli_window*) echo "waits for a window by the clock" ;;
    test_stop | test_tree) echo "measures times" ;;
    test_random) echo "compares with long double, of which valgrind has 64 bits only" ;;
    *) return 1 ;;
    esac
}

# The tests by name, cheapest first; what CTest has not measured comes last.
names() {
    {
        find "$build/tests" -maxdepth 1 -type f -perm -u+x \( -name 'test_*' -o -name 'gl_*' \)
        find "$build/tests/stability" -maxdepth 1 -type f -perm -u+x \( -name 'test_*' -o -name sweep \)
        find "$source/tests" -maxdepth 1 -name 'cli_*.sh'
    } | sed 's,.*/,,; s,[.]sh$,,' | sort > "$tmp/names"
    cat "$build/Testing/Temporary/CTestCostData.txt" 2> /dev/null | # CTest may not have run
        awk 'NR == FNR { cost[$1] = $3; next } { print($1 in cost ? cost[$1] : 1e9, $1) }' - "$tmp/names" | sort -g | cut -d' ' -f2
}

# look TEST: sets $code.
look() {
    export TEST="$1"
    mkdir -p "$tmp/place"
    case $1 in
    cli_*) set -- sh "$source/tests/$1.sh" "$tmp/bin" "$source" ;;
    *)
        program=$build/tests/$1
        [ -x "$program" ] || program=$build/tests/stability/$1
        [ "$1" != sweep ] || set -- "$1" 4 # pictures, of CTest's 200
        shift
        more=
        # Its own new stays; the leaks are OpenMesh's and OpenVDB's, whose new has failed.
        [ "$TEST" != test_mesh_vdb_memory ] || more="--soname-synonyms=somalloc=nouserintercepts --leak-check=no"
        # shellcheck disable=SC2086
        set -- $check $more --log-file="$logs/$TEST.%p" "$program" "$@"
        ;;
    esac
    code=0
    # The soft limit's signal is told in the log; the hard one ends what would not hear of it.
    (cd "$tmp/place" && ulimit -S -t "$seconds" && ulimit -H -t $((seconds + 30)) && "$@") > "$logs/$TEST.out" 2>&1 || code=$?
}

# shellcheck disable=SC2046
[ $# -gt 0 ] || set -- $(names)
looked=0
late=0
failed=
for name in "$@"; do
    if left_out "$name" > "$tmp/reason"; then
        echo "$name: left out, $(cat "$tmp/reason")"
        continue
    fi
    rm -f "$logs/$name".[0-9]* "$logs/$name.out"
    look "$name"
    looked=$((looked + 1))
    ended=ended
    if grep -lqs 'signal 24 (SIGXCPU)' "$logs/$name".[0-9]* || [ "$code" = 137 ]; then
        ended="not ended in $seconds s"
        late=$((late + 1))
    fi
    findings=0
    for log in "$logs/$name".[0-9]*; do
        # What leaks when a process is ended early says nothing; nor does a failing new, which valgrind cannot make throw.
        ! sed '/signal 24 (SIGXCPU)/,$d; /new.* failed and should throw/,$d' "$log" | grep -q '^==[0-9]*== .' || findings=$((findings + 1))
        [ -s "$log" ] || rm -f "$log"
    done
    echo "$name: $ended, $findings findings, exit code $code"
    [ "$findings" = 0 ] && { [ "$code" = 0 ] || [ "$ended" != ended ]; } || failed="$failed $name"
done
echo "valgrind.sh: $looked tests, $late not ended in their time, with findings or failed:${failed:- none}"
[ -z "$failed" ]
