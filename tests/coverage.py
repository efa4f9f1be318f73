"""Sums gcov's counts of libshape (coverage.sh). $1: the build folder. A line counts where gcc made code of it; a branch
where gcc made one that is no exception's."""
import gzip
import json
import pathlib
import subprocess
import sys
import tempfile

build = pathlib.Path(sys.argv[1]).resolve()
root = pathlib.Path(__file__).resolve().parent.parent
lines, branches = {}, {}

for notes in sorted((build / "libshape").rglob("*.gcno")):
    data = notes.with_suffix(".gcda")
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run(
            ["gcov", "--json-format", "--branch-probabilities", str(data if data.exists() else notes)],
            cwd=folder, capture_output=True, check=False)
        if made.returncode:
            sys.exit("coverage.py: gcov failed on %s: %s" % (notes, made.stderr.decode()[:300]))
        for result in pathlib.Path(folder).glob("*.gcov.json.gz"):
            report = json.loads(gzip.decompress(result.read_bytes()))
            for file in report["files"]:
                path = pathlib.Path(report["current_working_directory"], file["file"]).resolve()
                if not path.is_relative_to(root / "libshape"):
                    continue
                name = str(path.relative_to(root))
                for line in file["lines"]:
                    key = (name, line["line_number"])
                    lines[key] = lines.get(key, 0) + line["count"]
                    for i, branch in enumerate(line["branches"]):
                        if not branch["throw"]:
                            way = key + (i, line.get("function_name", ""))
                            branches[way] = branches.get(way, 0) + branch["count"]

if not lines:
    sys.exit("coverage.py: no counts in %s" % build)


def share(counts):
    counts = list(counts)
    return 100 * sum(c > 0 for c in counts) / len(counts) if counts else 100


table = []
for name in sorted({key[0] for key in lines}):
    own = [c for key, c in lines.items() if key[0] == name]
    ways = [c for key, c in branches.items() if key[0] == name]
    table.append((share(own), name, len(own), share(ways), len(ways)))
for covered, name, count, ways, way_count in sorted(table):
    print("%6.1f %% of %5d lines  %6.1f %% of %5d branches  %s" % (covered, count, ways, way_count, name))
core = {k: c for k, c in lines.items() if "/bridge/" not in k[0]}
core_ways = {k: c for k, c in branches.items() if "/bridge/" not in k[0]}
for title, own, ways in (("libshape", lines, branches), ("without bridges", core, core_ways)):
    print("%s: lines %.1f %% of %d, branches %.1f %% of %d"
          % (title, share(own.values()), len(own), share(ways.values()), len(ways)))

with open(build / "uncovered.txt", "w") as out:
    for name, number in sorted(k for k, c in lines.items() if c == 0):
        text = (root / name).read_text().splitlines()[number - 1]
        out.write("%s:%d: %s\n" % (name, number, text.strip()))
