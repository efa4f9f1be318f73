# examples/engine, built by itself against an installed tree, draws a cloud where neph-view draws it. In a window that is
# not shown, on a screen of its own (Xvfb). $1: programs of a build, $2: source folder.
set -eu
programs=$(cd "$1" && pwd)
build=$(dirname "$programs")
source=$(cd "$2" && pwd)
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_engine: $*" >&2
    exit 1
}

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

for tool in xvfb-run convert compare; do
    command -v $tool >/dev/null || fail "$tool is missing (tests/run.sh installs what the tests need)"
done
[ "$(wc -l <"$source/examples/engine/engine.c")" -lt 200 ] || fail "engine.c is no longer the short example that it promises to be"

CC=$(cached CMAKE_C_COMPILER)
flags="-O1 -Wall -Wextra -Werror -DWIDTH=96 -DHEIGHT=54"
if [ "$(cached NEPHELE_SANITIZE)" = ON ]; then
    flags="$flags -fsanitize=address,undefined"
fi
export CC CFLAGS="$flags"
quiet cmake --install "$build" --prefix "$temporary/root" --component development
quiet cmake --install "$build" --prefix "$temporary/root" --component library
quiet cmake -G Ninja -S root/share/nephele/examples/engine -B built -DCMAKE_PREFIX_PATH="$temporary/root"
quiet cmake --build built

"$programs/neph-meta" -q --seed 2 -o cloud.neph
quiet xvfb-run -a -s "-screen 0 320x240x24" built/engine cloud.neph engine.ppm
"$programs/neph-view" -q cloud.neph --headless --method exact --samples 4 --size 96x54 --sky none -o view.png

# What is not the engine's background, and what is not black in the viewer without a sky. Thin edges may fall on either
# side of the thresholds; a rim of one pixel is about a quarter of so small a cloud.
background=$(convert engine.ppm -format '%[pixel:p{0,0}]' info:)
convert engine.ppm -fuzz 6% -fill black -opaque "$background" -fill white +opaque black engine.png
convert view.png -colorspace gray -threshold 8% view_mask.png
covered=$(convert view_mask.png -format '%[fx:round(mean*w*h)]' info:)
[ "$covered" -gt 200 ] || fail "neph-view's cloud covers $covered pixels only"
differing=$(compare -metric AE engine.png view_mask.png null: 2>&1) || true
[ "$differing" -lt $((covered / 4)) ] || fail "the engine's cloud differs from neph-view's in $differing of $covered pixels"

# A file that is none is told, and no picture appears.
echo nothing >bad.neph
if xvfb-run -a built/engine bad.neph bad.ppm 2>err; then
    fail "the engine drew a file that is no cloud"
fi
[ ! -e bad.ppm ] || fail "the engine wrote a picture of a file that is no cloud"
grep -q "^engine: " err || fail "the engine does not say what is wrong with a bad file: $(cat err)"
echo "$differing pixels differ of $covered"
