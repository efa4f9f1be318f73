# neph-chart: all files appear, the numbers hold together, nothing is measured twice, mistakes are one line and leave no
# folder behind. The cloud is long and thin, so that its light grids have few cells. $1: programs, $2: source folder.
set -eu
bin=$(cd "$1" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
export OMP_NUM_THREADS=1 # other work on the same cores then costs its share only

fail()
{
    echo "cli_chart: $*" >&2
    exit 1
}
# refused EXIT TEXT COMMAND...: ends so, with one line that holds TEXT.
refused()
{
    wanted=$1
    text=$2
    shift 2
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq "$wanted" ] || fail "$* ended with $code, not $wanted: $(cat err)"
    [ "$(wc -l <err)" -eq 1 ] || fail "$* gave more than one line: $(cat err)"
    grep -q -F -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}

"$bin/neph-gauss" -q --count 12 --sigma 6,0.1,0.1 --max-radius 0.5 --no-hollow --no-prune -o thin.neph
tiny="--quick --size 16x9 --runs 1 --reference-noise 2"
# One word an option.
# shellcheck disable=SC2086
"$bin/neph-chart" $tiny thin.neph -o chart 2>err || fail "$(cat err)"
grep -q "reference traced" err || fail "the reference is not traced: $(cat err)"
for file in results.csv chart.svg chart.png report.md; do
    [ -s "chart/$file" ] || fail "$file is missing"
done
[ "$(head -c 4 chart/chart.png | tail -c 3)" = PNG ] || fail "chart.png is no PNG"
grep -q "</svg>" chart/chart.svg || fail "chart.svg is no whole SVG"
for method in march paper paper-ndt; do
    grep -q "^thin,$method," chart/results.csv || fail "$method is not measured"
    grep -q ">$method<" chart/chart.svg || fail "chart.svg does not name $method"
done
for error in 1 3 10; do
    grep -q "^| $error % | .* | .* |\$" chart/report.md || fail "report.md has no row for $error %"
done
grep -q "^## What never pays" chart/report.md || fail "report.md does not say what never pays"
if ls chart | grep -v -x -e results.csv -e chart.svg -e chart.png -e report.md -e 'reference-[0-9a-f]*.exr'; then
    fail "the folder holds more than it should"
fi

# Positive numbers. The front of pictures, from the fastest on: every step is more accurate; no row beats any of it.
head -n 1 chart/results.csv | grep -q '^scene,method,settings,milliseconds,relmse,' || fail "other columns"
awk -F, 'NR > 1 && !(NF == 12 && $4 > 0 && $5 > 0 && $7 >= $5 * 0.999 && $8 > 0) { print; bad = 1 } END { exit bad || NR < 10 }' \
    chart/results.csv || fail "rows of results.csv are not what they should be"
tail -n +2 chart/results.csv | awk -F, '$9 == "picture" || $9 == "both"' | sort -t , -k 4,4g >front
[ -s front ] || fail "no row is on the front"
awk -F, 'NR > 1 && $5 >= last { print; bad = 1 } { last = $5 } END { exit bad }' front || fail "the front is not monotone"
awk -F, 'NR == FNR { t[NR] = $4; e[NR] = $5; n = NR; next }
    FNR > 1 { for (i = 1; i <= n; i++) if ($4 < t[i] && $5 < e[i]) { print; bad = 1 } } END { exit bad }' \
    front chart/results.csv || fail "a row beats the front"

# Again: nothing is measured anew, the reference is the same file.
cp chart/results.csv before.csv
ls -l --time-style=full-iso chart/reference-*.exr >before
# shellcheck disable=SC2086
"$bin/neph-chart" $tiny thin.neph -o chart 2>err || fail "$(cat err)"
grep -q "reference kept from before" err || fail "the reference was traced twice"
grep -q "everything is measured" err || fail "something was measured twice: $(cat err)"
cmp -s before.csv chart/results.csv || fail "results.csv changed although nothing was to do"
ls -l --time-style=full-iso chart/reference-*.exr | cmp -s - before || fail "the reference was written twice"

# Broken off: what is there stays to the last digit, what is missing is measured.
{ head -n 3 before.csv; tail -n +5 before.csv; } >chart/results.csv
lost=$(sed -n 4p before.csv | cut -d , -f 12)
# shellcheck disable=SC2086
"$bin/neph-chart" -q $tiny thin.neph -o chart
[ "$(wc -l <chart/results.csv)" -eq "$(wc -l <before.csv)" ] || fail "the row that was lost is not measured again"
cut -d , -f 1-8,10-12 before.csv | grep -v "$lost" >a
cut -d , -f 1-8,10-12 chart/results.csv | grep -v "$lost" >b
cmp -s a b || fail "rows that were there are measured again"

# Mistakes.
refused 1 "no.neph" "$bin/neph-chart" no.neph -o new
refused 2 "-o" "$bin/neph-chart" thin.neph
printf '{"scene": 1, "clouds": [{"file": "gone.neph"}]}' >broken.json
refused 1 "gone.neph" "$bin/neph-chart" thin.neph broken.json -o new
mkdir twice
cp thin.neph twice/
refused 1 "two scenes are called \"thin\"" "$bin/neph-chart" thin.neph twice/thin.neph -o new
refused 1 "is not a folder" "$bin/neph-chart" --quick thin.neph -o thin.neph
[ ! -e new ] || fail "a mistake left a folder behind"
mkdir other
echo "a,b" >other/results.csv
refused 1 "not written by this version" "$bin/neph-chart" --quick thin.neph -o other
[ "$(ls other)" = results.csv ] || fail "a mistake left files behind"
mkdir empty
if PATH=$dir/empty "$bin/neph-chart" --quick thin.neph -o new 2>err; then
    fail "went on without gnuplot"
fi
grep -q "gnuplot-nox" err || fail "does not say that gnuplot is missing: $(cat err)"
[ ! -e new ] || fail "without gnuplot, a folder is left behind"

# One setting at a time: 38 frames in seven series, positive, once each; started again, none is measured again.
"$bin/neph-chart" --appendix --size 16x9 --runs 1 thin.neph -o sheet 2>err || fail "$(cat err)"
grep -q "38 frames measured" err || fail "--appendix measured something else: $(cat err)"
[ "$(head -c 4 sheet/series.png | tail -c 3)" = PNG ] || fail "series.png is no PNG"
grep -q "</svg>" sheet/series.svg || fail "series.svg is no whole SVG"
awk -F, 'NR > 1 && !(NF == 6 && $4 > 0) { print; bad = 1 } END { exit bad || NR != 39 }' sheet/series.csv ||
    fail "rows of series.csv are not what they should be"
[ "$(tail -n +2 sheet/series.csv | cut -d , -f 1 | uniq | paste -sd ' ')" = \
    "lattice rule powder steps resolution coverage distance" ] || fail "series.csv lacks a series"
# 32 times the steps take longer, however busy the machine is.
awk -F, '$1 == "steps" && $2 == 16 { few = $4 } $1 == "steps" && $2 == 512 { many = $4 } END { exit !(many > 2 * few) }' \
    sheet/series.csv || fail "512 steps take no longer than 16: $(grep ^steps sheet/series.csv)"
cp sheet/series.csv before.csv
"$bin/neph-chart" --appendix --size 16x9 --runs 1 thin.neph -o sheet 2>err || fail "$(cat err)"
grep -q ": 0 frames measured" err || fail "--appendix measured something twice: $(cat err)"
cmp -s before.csv sheet/series.csv || fail "series.csv changed although nothing was to do"
refused 2 "--appendix takes one scene" "$bin/neph-chart" --appendix --quick thin.neph -o new
echo "a,b" >sheet/series.csv
refused 1 "is not what this program wrote" "$bin/neph-chart" --appendix --size 16x9 thin.neph -o sheet
