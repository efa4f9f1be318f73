# What all programs promise alike: --help and --version on standard output, every documented option in --help, exit
# codes 0, 1 and 2, and one line on standard error a mistake.
set -eu
bin=$1
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

# All mistakes are shown, not only the first.
mistakes=0
fail()
{
    echo "cli_help: $*" >&2
    mistakes=$((mistakes + 1))
}

# Promised options that are still to be built. An entry that has come to be is a mistake: it belongs out of here.
not_yet=""

save="save-scene"
common="output seed quiet generate help version"
medium="model extinction albedo phase g kappa octaves noise-scale edge at"
picture="size eye target fov sun sun-irradiance sky exposure"

# The long options that are promised, program by program; 1 where no such program is known.
options_of()
{
    case $1 in
    neph-gauss)
        echo "$medium $save count mean sigma clamp clamp-mode radius-law max-radius no-hollow no-prune preset field area"
        ;;
    neph-lsys) echo "$medium $save iterations angle radius length max-primitives print count" ;;
    neph-meta) echo "$medium $save count sigma max-radius" ;;
    neph-mesh) echo "$medium $save faces scale no-rotate fit fill up center size" ;;
    neph-layer) echo "$medium $save bounds extent noise frequency coverage ramp preset" ;;
    neph-edit)
        echo "$medium $save translate rotate scale hollow prune thin grow clip simplify primitives cloud"
        ;;
    neph-info) echo "json csv allow-outside" ;;
    neph-render) echo "$picture $save allow-outside method spp noise rule steps light powder light-octaves ambient emission stats compare tolerance density-gain" ;;
    neph-vdb) echo "resolution voxel-size half up ramp grid primitives error max-memory values grids each" ;;
    neph-chart) echo "quick size runs reference-noise allow-outside" ;;
    neph-view) echo "$picture $save allow-outside headless method bench frames error light powder light-octaves ambient emission" ;;
    *) return 1 ;;
    esac
}

# What makes the program read a file that is not there; 1 where it reads none.
missing_file_of()
{
    case $1 in
    neph-lsys | neph-mesh | neph-edit | neph-info) echo "no/such.file" ;;
    neph-render) echo "no/such.neph -o x.png" ;;
    neph-view) echo "no/such.neph --headless -o x.png" ;;
    neph-vdb) echo "no/such.neph -o x.vdb" ;;
    neph-chart) echo "no/such.neph -o out" ;;
    *) return 1 ;;
    esac
}

# expect EXIT PROGRAM [ARGUMENT]...: runs it, with out and err as files.
expect()
{
    wanted=$1
    shift
    got=0
    # One word an argument.
    # shellcheck disable=SC2086
    "$bin/$1" $arguments >out 2>err </dev/null || got=$?
    [ "$got" -eq "$wanted" ] || fail "$1 $arguments: exit $got, not $wanted; standard error: $(head -n 3 err)"
}

# one_line PROGRAM: err is one line that begins by the program's name.
one_line()
{
    [ "$(wc -l <err)" -eq 1 ] || fail "$1 $arguments: standard error has $(wc -l <err) lines, not one: $(head -n 3 err)"
    grep -q "^$1: " err || fail "$1 $arguments: the error does not begin by \"$1: \": $(cat err)"
    [ ! -s out ] || fail "$1 $arguments: wrote to standard output besides failing"
}

count=0
for path in "$bin"/neph-*; do
    [ -x "$path" ] || continue
    program=$(basename "$path")
    if ! options=$(options_of "$program"); then
        fail "$program: no list of its options here (add one to options_of)"
        continue
    fi

    arguments=--help
    expect 0 "$program"
    [ ! -s err ] || fail "$program --help: wrote to standard error: $(head -n 3 err)"
    for option in $common $options; do
        named=1
        grep -Eq -e "(^|[ ,])--$option([ ,=]|\$)" out || named=0
        case " $not_yet " in
        *" $program:$option "*)
            [ "$named" = 0 ] || fail "$program --help: --$option is there now (take it out of not_yet)"
            ;;
        *) [ "$named" = 1 ] || fail "$program --help: --$option is not named" ;;
        esac
    done
    grep -q -e "-o, --output" out || fail "$program --help: -o is not named"

    arguments=--version
    expect 0 "$program"
    grep -Eqx "$program [0-9]+\\.[0-9]+\\.[0-9]+" out || fail "$program --version: printed $(head -n 3 out)"
    [ ! -s err ] || fail "$program --version: wrote to standard error: $(head -n 3 err)"

    # Wrong commands: an option that is not there, numbers that are none, a value outside its range.
    for arguments in "--no-such-option" "--seed 12x" "--seed nan" "--seed -1" "--seed"; do
        expect 2 "$program"
        one_line "$program"
    done
    if echo " $options " | grep -q " extinction "; then
        for arguments in "--albedo 1.5" "--albedo nan" "--albedo inf" "--albedo 0x1" "--octaves 0" "--at 1,2" \
            "--at 1,,2" "--at 1,2,3,4" "--model cube"; do
            expect 2 "$program"
            one_line "$program"
        done
    fi

    if arguments=$(missing_file_of "$program"); then
        expect 1 "$program"
        one_line "$program"
        grep -q "^$program: no/such\\.[a-z]*: " err || fail "$program: the error does not name the file: $(cat err)"
        if [ -e x.png ] || [ -e x.vdb ]; then
            fail "$program: wrote an output without an input"
        fi
    else
        arguments="one-too-many"
        expect 2 "$program"
        one_line "$program"
    fi
    count=$((count + 1))
done
for program in neph-lsys neph-info neph-view; do
    [ -x "$bin/$program" ] || fail "$program is not in $bin"
done
[ "$mistakes" -eq 0 ] || exit 1
echo "$count programs"
