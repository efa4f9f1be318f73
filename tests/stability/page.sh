# docs/stability.md has the rows of test_stability, each once, in their order, with the same bounds and claims: a row of the
# page without its pair of tests, or a test without its row, would be told here. Measured figures are left out: compilers
# round differently. $1: test_stability, $2: the page.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

# Tables of failures have seven columns, of which 5 and 6 are measured; that of energy has four, measured from 3 on.
rows()
{
    awk -F'|' '/^## /{ print } NF == 9 && !/^\|---/ { print $2 "|" $3 "|" $4 "|" $5 "|" $8 } NF == 6 && !/^\|---/ { print $2 "|" $3 }'
}
"$1" --markdown | rows >"$dir/tests"
rows <"$2" >"$dir/page"
[ "$(wc -l <"$dir/tests")" -ge 60 ] || { echo "only $(wc -l <"$dir/tests") rows were found" >&2; exit 1; }
diff "$dir/tests" "$dir/page" || { echo "docs/stability.md differs from test_stability --markdown" >&2; exit 1; }
