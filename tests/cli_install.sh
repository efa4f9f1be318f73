# The installed tree: moved to another folder, it has all programs with manual page and completion, and other projects
# build against it with CMake and with pkg-config, in C and in C++. libshape.so exports what the public headers declare,
# all of it and nothing else. $1: programs of a build, $2: source folder.
set -eu
programs=$(cd "$1" && pwd)
build=$(dirname "$programs")
source=$(cd "$2" && pwd)
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_install: $*" >&2
    exit 1
}

# quiet COMMAND...: its output only where it fails.
quiet()
{
    "$@" >log 2>&1 || {
        cat log >&2
        fail "$1 failed (its output stands above)"
    }
}

cached()
{
    sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"
}

quiet cmake --install "$build" --prefix "$temporary/first"
mv first moved
root=$temporary/moved
bin=$root/$(cached CMAKE_INSTALL_BINDIR)
lib=$root/$(cached CMAKE_INSTALL_LIBDIR)
man=$root/share/man/man1

# --- nothing knows where it was built or installed. The programs' own debugging information may (a Debug build).
grep -rlF -e "$temporary/first" -e "$(cd "$build" && pwd)" -e "$source" \
    "$lib/cmake" "$lib/pkgconfig" "$root/share" >paths || true
[ ! -s paths ] || fail "these files hold a path of this machine: $(cat paths)"

# --- every program is there, starts, and has its pages
count=0
for path in "$programs"/neph-*; do
    program=$(basename "$path")
    [ "$("$bin/$program" --version)" = "$("$path" --version)" ] || fail "$program does not start where it was moved to"
    for page in "$man/$program.1.gz" "$root/share/bash-completion/completions/$program" \
        "$root/share/zsh/$(cached NEPHELE_ZSH_FOLDER)/_$program"; do
        [ -s "$page" ] || fail "$program: ${page#"$root"/} is missing"
    done
    count=$((count + 1))
done
[ "$count" -eq 11 ] || fail "$count programs in $programs, not 11"
"$bin/neph-lsys" -q "$root/share/nephele/examples/spiral.lsys" | "$bin/neph-info" - >/dev/null ||
    fail "the installed example does not go through the installed programs"

# --- and what neph-view loads late is found from there
if [ -x "$bin/neph-view" ]; then
    "$bin/neph-gauss" -q --count 3 | "$bin/neph-vdb" -q - --resolution 24 -o three.vdb
    "$bin/neph-view" -q three.vdb --headless --size 16x9 --samples 1 --light-grid 8 -o three.pfm ||
        fail "the installed neph-view does not read a .vdb"
fi

[ -s "$root/share/nephele/examples/blender/nephele_addon.py" ] || fail "the Blender add-on is not installed"

# --- what libshape.so exports
declared()
{
    cat "$root"/include/shape/*.h | tr '\n' ' ' | sed 's,/\*[^*]*\*\+\([^/*][^*]*\*\+\)*/, ,g' |
        grep -oE 'shape_[a-z0-9_]+ *\(' | tr -d ' (' | sort -u
}
declared >declared
nm -D --defined-only "$lib/libshape.so.1" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort >exported
nm -g --defined-only "$lib/libshape.a" 2>/dev/null | awk 'NF == 3 { print $3 }' | sort -u >defined
comm -12 declared defined >wanted
[ "$(wc -l <wanted)" -gt 100 ] || fail "found only $(wc -l <wanted) functions in the headers"
diff wanted exported >difference ||
    fail "libshape.so does not export what the public headers declare (<: missing, >: too much): $(cat difference)"

# --- another project
CC=$(cached CMAKE_C_COMPILER)
CXX=$(cached CMAKE_CXX_COMPILER)
flags=-O1
if [ "$(cached NEPHELE_SANITIZE)" = ON ]; then
    flags="-O1 -fsanitize=address,undefined"
fi
export CC CXX CFLAGS="$flags -Wall -Wextra -Werror" CXXFLAGS="$flags -Wall -Wextra -Werror"
cp -r "$source/tests/consumer" consumer
quiet cmake -G Ninja -S consumer -B built -DCMAKE_PREFIX_PATH="$root" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
quiet cmake --build built
grep -q "^Nephele_DIR:PATH=$root/" built/CMakeCache.txt || fail "the consumer found another Nephele"
built/make_cloud heap.neph
"$bin/neph-gauss" -q -o gauss.neph
primitives=$("$bin/neph-info" heap.neph --csv | tail -n +2 | wc -l)
"$bin/neph-info" heap.neph --csv | cut -d, -f2- >a
"$bin/neph-info" gauss.neph --csv | cut -d, -f2- >b
cmp a b || fail "the library called by a consumer makes other spheres than neph-gauss"
# Uniform density is 1 inside a sphere.
[ "$(built/ask_cloud heap.neph)" = "$primitives 1" ] ||
    fail "ask_cloud says \"$(built/ask_cloud heap.neph)\", not \"$primitives 1\""
built/make_picture ramp.png
[ "$(head -c 4 ramp.png | od -An -tx1 | tr -d ' ')" = 89504e47 ] || fail "make_picture wrote no PNG"

# --- by pkg-config, whose paths move along
export PKG_CONFIG_PATH="$lib/pkgconfig"
# One word a flag.
# shellcheck disable=SC2046,SC2086
quiet $CC $CFLAGS consumer/make_cloud.c -o by_pc $(pkg-config --cflags --libs libshape) -Wl,-rpath,"$lib"
./by_pc pc.neph
cmp pc.neph heap.neph || fail "built by pkg-config, the consumer wrote other bytes"
[ "$(pkg-config --modversion libshape)" = "$("$bin/neph-info" --version | cut -d' ' -f2)" ] ||
    fail "libshape.pc has another version than the programs"
[ -f "$(pkg-config --variable=shaders libshape)/field/density.glsl" ] || fail "libshape.pc does not say where the shaders are"
echo "$count programs, $(wc -l <exported) functions exported"
