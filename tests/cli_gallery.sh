# The gallery: its page is what make.sh writes, its figures are those of the clouds that its commands make today, every
# cloud has a picture of decent size, and each generator has its share.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
gallery=$source/examples/gallery
figures=$source/docs/gallery/figures.tsv

fail() {
    echo "cli_gallery: $1" >&2
    exit 1
}

code=0
sh "$gallery/make.sh" "$bin" 2>/dev/null || code=$?
[ "$code" -eq 2 ] || fail "make.sh without a folder ended with $code, not 2"
mkdir "$dir/gallery"
cp "$figures" "$dir/gallery/"
sh "$gallery/make.sh" "$bin" "$dir/gallery" - || fail "make.sh does not write the page"
cmp "$dir/gallery.md" "$source/docs/gallery.md" || fail "docs/gallery.md is not what make.sh writes (run make.sh ... -)"

# Counts and file sizes are whole numbers that must not differ. What meshes make may differ between systems, so of
# theirs only the count is held. The commands' paths are those from the source's root.
cd "$source"
PATH=$bin:$PATH
tab=$(printf '\t')
awk '/^## / { name = $2 } /^\$ / { print name "\t" substr($0, 3) }' "$gallery/clouds.txt" >"$dir/table"
while IFS=$tab read -r name make; do
    sh -ec "$make" >"$dir/cloud.neph" 2>"$dir/log" </dev/null || fail "$name: $(tail -n 1 "$dir/log")"
    primitives=$(neph-info "$dir/cloud.neph" --json | awk -F'"primitives": ' 'NF > 1 { sum += $2 } END { print sum }')
    bytes=$(($(wc -c <"$dir/cloud.neph")))
    row=$(awk -F '\t' -v name="$name" '$1 == name { print $2, $3 }' "$figures")
    case $make in
    neph-mesh*) [ "${row% *}" = "$primitives" ] || fail "$name has $primitives primitives, its figures say $row" ;;
    *) [ "$row" = "$primitives $bytes" ] || fail "$name has $primitives primitives and $bytes bytes, its figures say $row" ;;
    esac
    picture=$source/docs/gallery/$name.png
    [ "$(head -c 4 "$picture" | tail -c 3)" = PNG ] || fail "$name has no picture"
    [ $(($(wc -c <"$picture"))) -lt 250000 ] || fail "$name: the picture is larger than 250 kB"
done <"$dir/table"

[ $(($(wc -l <"$dir/table"))) -ge 24 ] || fail "fewer than 24 clouds"
for program in gauss lsys meta mesh layer edit; do
    [ "$(grep -c "neph-$program " "$dir/table")" -ge 3 ] || fail "fewer than three clouds of neph-$program"
done
for preset in humilis mediocris congestus stratus stratocumulus fog; do
    grep -q -e "--preset $preset" "$dir/table" || fail "no cloud of the preset $preset"
done
