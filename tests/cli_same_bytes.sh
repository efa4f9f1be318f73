# The same command gives the same bytes: twice, with gcc and clang, at -O0 and -O3, with OpenMP and without. Each
# compiler builds the generators anew from their sources; everything is compared with the programs in $1.
# $1: programs, $2: source folder.
set -eu
bin=$1
source=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
# A name without blanks for the source folder: the flags below are taken word by word.
ln -s "$(cd "$source" && pwd)" "$tmp/source"
source=$tmp/source

fail() {
    echo "cli_same_bytes: $1" >&2
    exit 1
}

programs=
for name in lsys gauss meta layer edit; do
    if [ -e "$source/tools/neph-$name.c" ]; then
        programs="$programs $name"
    else
        echo "cli_same_bytes: there is no neph-$name to compare"
    fi
done
version=$("$bin/neph-lsys" --version | sed 's/.* //')

folder_of() {
    case $1 in
    tools) echo "$source/tools" ;;
    *) echo "$source/libshape/$1" ;;
    esac
}

# build FOLDER COMPILER OPTIMISATION: the rooms of libshape that generators use become an archive, without OpenMP.
build() {
    mkdir -p "$1"
    flags="-std=c17 $3 -w -ffp-contract=off -D_XOPEN_SOURCE=700 -DNEPHELE_VERSION=\"$version\""
    flags="$flags -I$source/libshape/include -I$source/libshape -I$source/tools"
    for room in base primitive generate field budget file tools; do
        mkdir -p "$1/$room"
        case $room in
        file) files="neph_*.c scene*.c atomic.c" ;;
        tools) files="cli*.c" ;;
        *) files="*.c" ;;
        esac
        # Meshes are equal on one platform only, so nobody promises anything about them here; but every program has
        # the options of neph-mesh.
        # shellcheck disable=SC2086
        (cd "$(folder_of $room)" && ls $files | grep -v -e '^mesh' -e '^cli_mesh.c$') > "$1/$room/list"
        # shellcheck disable=SC2046,SC2086
        (cd "$1/$room" && $2 $flags -c $(sed "s|^|$(folder_of $room)/|" list)) || return 1
    done
    ar qcs "$1/shape.a" "$1"/*/*.o
    for name in $programs; do
        # shellcheck disable=SC2086
        $2 $flags "$source/tools/neph-$name.c" "$1/shape.a" -lpopt -lmd -ljansson -lm -o "$1/neph-$name" || return 1
    done
}

for compiler in gcc clang; do
    command -v $compiler > /dev/null || fail "$compiler is missing (install it: this test compares compilers)"
done
# Two compilers at a time.
for level in -O0 -O3; do
    build "$tmp/gcc$level" gcc $level > "$tmp/gcc.log" 2>&1 &
    first=$!
    build "$tmp/clang$level" clang $level > "$tmp/clang.log" 2>&1 || {
        cat "$tmp/clang.log" >&2
        fail "clang $level does not build the generators"
    }
    wait $first || {
        cat "$tmp/gcc.log" >&2
        fail "gcc $level does not build the generators"
    }
done

# Every function and operator that a grammar has.
cat > "$tmp/all.lsys" <<'END'
axiom A(1, 6) @(1, 1.5, 0.7) A(0.9, 4)
iterations 9
radius 0.5..1.5  length 0.3..1  angle 20..60  shrink 0.8..1.1
puffs F X
A(r,n) : n > 0 -> F X(r) + & ^ \(30) / - !(0.9..1) | [ +(20..40) A(r*(0.7..0.9), n-1) ] &(137.5) A(r^0.9, n-1) : 0.8
A(r,n) : n > 0 -> X(sqrt(r) + abs(sin(n*20)) + exp(cos(r)) + log(2+r)) A(max(r, 0.2)^1.3, n - 1 - rand(0,1)) : r
X(r) -> F(min(r, 3) + mod(7.3*r, 1)/10, round(r) + floor(r)*ceil(r)/9)
END

# make FOLDER OUTPUT: every command's result in OUTPUT.
make() {
    mkdir -p "$2"
    [ -x "$1/neph-lsys" ] || fail "$1/neph-lsys is missing"
    for name in $programs; do
        case $name in
        lsys)
            for grammar in "$source"/examples/*.lsys "$tmp/all.lsys"; do
                result=$(basename "$grammar" .lsys)
                "$1/neph-lsys" -q "$grammar" --seed 7 -o "$2/$result.neph"
            done
            ;;
        gauss)
            "$1/neph-gauss" -q -o "$2/gauss.neph"
            "$1/neph-gauss" -q --preset congestus --seed 5 -o "$2/congestus.neph"
            "$1/neph-gauss" -q --radius-law inverse --clamp-mode reject --no-prune -o "$2/inverse.neph"
            ;;
        meta)
            "$1/neph-meta" -q --count 20 --seed 9 -o "$2/meta.neph"
            ;;
        layer)
            "$1/neph-layer" -q --preset stratocumulus --seed 3 -o "$2/layer.neph"
            ;;
        edit)
            "$1/neph-edit" -q "$2/castellanus.neph" "$2/anvil.neph" --scale 2,1,1.5 --rotate 10,20,30 \
                --translate 1,2,3 -o "$2/moved.neph"
            "$1/neph-edit" -q "$2/castellanus.neph" --grow --clip --hollow --thin 150 --prune --seed 4 \
                -o "$2/reworked.neph"
            "$1/neph-edit" -q "$2/castellanus.neph" --thin 400 --simplify 0.1 -o "$2/simplified.neph"
            ;;
        esac
    done
}

make "$bin" "$tmp/a"
make "$bin" "$tmp/b"
count=0
compare() {
    for file in "$tmp"/a/*.neph; do
        cmp -s "$file" "$1/$(basename "$file")" || fail "$(basename "$file") differs $2"
        count=$((count + 1))
    done
}
compare "$tmp/b" "from run to run"
for build in gcc-O0 gcc-O3 clang-O0 clang-O3; do
    make "$tmp/$build" "$tmp/of-$build"
    compare "$tmp/of-$build" "between $bin and $build"
done
[ $count -ge 50 ] || fail "only $count files were compared"
# And chance is at work: another seed gives another file.
"$bin/neph-lsys" -q "$source/examples/castellanus.lsys" --seed 8 -o "$tmp/other.neph"
! cmp -s "$tmp/other.neph" "$tmp/a/castellanus.neph" || fail "seeds 7 and 8 give the same cloud"
echo "cli_same_bytes: $count files equal"
