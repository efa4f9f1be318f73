# --error of a picture: the march and neph-vdb choose for it, say so in one line, keep it, and refuse what makes no sense.
set -eu
bin=$(cd "$1" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail()
{
    echo "cli_error: $*" >&2
    exit 1
}
# wrong TEXT COMMAND...: exits 2 with one line that holds TEXT.
wrong()
{
    text=$1
    shift
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq 2 ] || fail "$* ended with $code, not 2: $(cat err)"
    [ "$(wc -l <err)" -eq 1 ] || fail "$* gave more than one line: $(cat err)"
    grep -q -F -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}

"$bin/neph-gauss" -q --count 8 --extinction 6 -o c.neph
view="--size 96x54"
# One word an option.
# shellcheck disable=SC2086
for error in 0.2 0.05; do
    "$bin/neph-render" c.neph --method march $view --error "$error" -o "e$error.pfm" 2>said || fail "$(cat said)"
    [ "$(grep -c 'steps, light grid of .* cells, .* octaves, 1 of 1 clouds: an error of .* is expected' said)" -eq 1 ] ||
        fail "the choice is not one line: $(cat said)"
    sed -n 's/.*: \([0-9]*\) steps.*/\1/p' said >"steps$error"
done
[ "$(cat steps0.2)" -lt "$(cat steps0.05)" ] || fail "an error of 0.05 takes no more steps than 0.2"
# shellcheck disable=SC2086
"$bin/neph-render" -q c.neph --method march $view --steps 600 -o fine.pfm 2>said
[ ! -s said ] || fail "-q says something: $(cat said)"
# The tolerance is of the relative MSE, the square of E.
"$bin/neph-render" --compare e0.2.pfm fine.pfm --tolerance 0.04 >out || fail "--error 0.2 is not kept: $(cat out)"
"$bin/neph-render" --compare e0.05.pfm fine.pfm --tolerance 0.0025 >out || fail "--error 0.05 is not kept: $(cat out)"

# Voxels: the further away, the larger.
for distance in 30 3000; do
    "$bin/neph-vdb" c.neph --error 0.01 --size 320x180 --eye "0,2,$distance" -o "d$distance.vdb" 2>said || fail "$(cat said)"
    grep -q "an error of .* is expected in the picture" said || fail "the voxels are not said: $(cat said)"
    sed -n 's/.*--resolution \([0-9]*\)).*/\1/p' said >"voxels$distance"
done
[ "$(cat voxels3000)" -lt "$(cat voxels30)" ] || fail "a view from afar has no larger voxels"

wrong "--error chooses steps and light grid itself" "$bin/neph-render" c.neph --method march --error 0.1 --steps 50 -o x.png
wrong "--error chooses steps and light grid itself" "$bin/neph-render" c.neph --method march --error 0.1 --light single -o x.png
wrong "0.0001 to 1" "$bin/neph-render" c.neph --method march --error 2 -o x.png
wrong "have one quality" "$bin/neph-render" c.neph --method paper --error 0.1 -o x.png
wrong "they are the same" "$bin/neph-render" c.neph --noise 0.1 --error 0.1 -o x.png
wrong "a view goes with --error" "$bin/neph-vdb" c.neph --eye 0,2,30 -o x.vdb
[ ! -e x.png ] && [ ! -e x.vdb ] || fail "a wrong command left a file"
code=0
"$bin/neph-vdb" c.neph --error 0.1 --eye 0,2,30 --target 0,2,60 -o x.vdb 2>err || code=$?
[ "$code" -eq 1 ] && grep -q "the view shows none" err || fail "a view of nothing ended with $code: $(cat err)"
