# Voxels on the processor, ours against what people use, on one .vdb: neph-render --method reference against Cycles (time to
# equal noise), and --method march against OpenVDB's vdb_render (time of a picture). The tables of docs/benchmarks.md.
# $1: programs, $2: source; $3: size [640x360]; $4: samples a pixel of Cycles [8]; $5: turns of vdb_render and ours [3].
# Needs Debian's blender, libopenvdb-tools and python3. Some five minutes on two idle cores.
set -eu
programs=$(cd "$1" && pwd)
script=$(cd "$2/examples/blender" && pwd)/import_vdb.py
size=${3:-640x360}
samples=${4:-8}
turns=${5:-3}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
for needed in blender vdb_render python3; do
    command -v "$needed" > /dev/null || {
        echo "cycles.sh: $needed is missing (install Debian's packages blender, libopenvdb-tools, python3)" >&2
        exit 1
    }
done
cat > "$tmp/bench.py" << 'END'
import json, math, os, resource, subprocess, sys, time

programs, script, size, samples, turns, folder = sys.argv[1:7]
samples, turns = int(samples), int(turns)
os.chdir(folder)
width, height = (int(n) for n in size.split("x"))
ours_samples = 8 * samples
eye, target, fov = (0, 2, 24), (-0.5, 0.8, 0), 38
sun = (60, 40)
words = lambda v: ",".join(str(x) for x in v)
# A number that begins by a minus is no option.
camera = [f"--eye={words(eye)}", f"--target={words(target)}", f"--fov={fov}", f"--size={size}"]


def run(command):
    """Seconds on the wall and of processor time."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit("cycles.sh: failed: " + " ".join(command) + "\n" + done.stdout[-2000:])
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def ours(name):
    return os.path.join(programs, name)


def compare(a, b):
    return json.loads(subprocess.check_output([ours("neph-render"), "--compare", a, b]))


def mean(c, which):
    return sum(c[which]) / 3


def make(g):
    subprocess.check_call([ours("neph-gauss"), "-q", "--g", str(g), "-o", "cloud.neph"])
    subprocess.check_call([ours("neph-vdb"), "-q", "cloud.neph", "--resolution", "256", "-o", "cloud.vdb"])


def blender(g, count, seed, name):
    return run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python", script, "--",
                "cloud.vdb", "--extinction", "2", "--albedo", "1", "--g", str(g), "--bounces", "12", "--filter",
                "box", "--samples", str(count), "--seed", str(seed), "--sun", words(sun), "--sky",
                "0.2,0.3,0.5", "--render", name] + camera)


def reference(g, count, seed, name):
    # Cycles' bounces do not count the first collision.
    return run([ours("neph-render"), "-q", "cloud.vdb", "--extinction", "2", "--albedo", "1", "--phase", "hg", "--g",
                str(g), "--max-bounces", "13", "--spp", str(count), "--seed", str(seed), "--sun", words(sun),
                "--sky", "0.2,0.3,0.5", "-o", name] + camera)


def noise(label, render, g, count, files):
    """Time and variance of a sample a pixel; start and loading are left out as the time of one sample is."""
    first = render(g, 1, 9, "one.exr")
    both = [render(g, count, seed, name) for seed, name in zip((1, 2), files)]
    found = compare(*files)
    wall, cpu = (min(b[k] for b in both) - first[k] for k in (0, 1))
    pixels = width * height * (count - 1)
    row = {"wall": wall / pixels * 1e6, "cpu": cpu / pixels * 1e6, "variance": found["rmse"] ** 2 / 2 * count,
           "relative": found["relmse"] / 2 * count, "rmse": found["rmse"]}
    print(f"| {label} | {count} | {row['wall']:.3f} | {row['cpu']:.3f} | {row['variance']:.4f} | "
          f"{row['relative']:.3f} |", flush=True)
    return row


def against_cycles(g):
    make(g)
    print(f"\ng {g}, {size}, 12 bounces, box filter\n\n"
          "| | samples | us a sample | of processor time | variance of a sample | relative |\n"
          "|---|---|---|---|---|---|", flush=True)
    a = noise("Cycles", blender, g, samples, ("cycles1.exr", "cycles2.exr"))
    b = noise("neph-render", reference, g, ours_samples, ("ours1.exr", "ours2.exr"))
    print("\ntime to equal noise, Cycles over ours: "
          + ", ".join(f"{a[t] * a[v] / (b[t] * b[v]):.1f} ({name})"
                      for t, v, name in (("wall", "variance", "wall"), ("cpu", "variance", "processor time"),
                                         ("cpu", "relative", "processor time, relative variance"))))
    found = compare("cycles1.exr", "ours1.exr")
    expected = math.sqrt((a["rmse"] ** 2 + b["rmse"] ** 2) / 2)
    print(f"pictures: means {mean(found, 'mean_a'):.5f} and {mean(found, 'mean_b'):.5f}; root mean square difference "
          f"{found['rmse']:.4f}, the noise of both explains {expected:.4f}", flush=True)


def upright(v):
    return (v[0], -v[2], v[1])


def vdb_render(scatter, absorb, name, size_wanted):
    a, h = (math.radians(x) for x in sun)
    to_sun = upright((math.cos(h) * math.sin(a), math.sin(h), math.cos(h) * math.cos(a)))
    across = 2 * math.degrees(math.atan(math.tan(math.radians(fov) / 2) * width / height))
    return run(["vdb_render", "cloud.vdb", name, "-res", size_wanted, "-translate", words(upright(eye)), "-lookat",
                words(upright(target)), "-up", "0,0,1", "-fov", f"{across:.6f}", "-light", words(to_sun) + ",1,1,1",
                "-gain", "0", "-scatter", words([scatter] * 3), "-absorb", words([absorb] * 3)])


def marched(scatter, absorb, voxel, cells, name, size_wanted, light):
    # A phase function of 1/(4 pi), which vdb_render leaves out: so much more sun. Its cutoff is of the square of a
    # vector of three.
    return run([ours("neph-render"), "-q", "cloud.vdb", "--method", "march", "--light", "single", "--phase", "isotropic",
                "--extinction", f"{(scatter + absorb) / voxel:.9g}", "--albedo", f"{scatter / (scatter + absorb):.9g}",
                "--sun", words(sun), "--sun-irradiance", words([f"{4 * math.pi:.9g}"] * 3), "--sky", "none", "--steps",
                str(cells), "--cutoff", f"{math.sqrt(0.005 / 3):.6g}", "-o", name] + light + camera[:-1]
               + [f"--size={size_wanted}"])


def least(function):
    """The least of several turns, each of a picture and of one of 8x8 pixels, which is start and loading."""
    best = None
    for _ in range(turns):
        whole, start = function(size), function("8x8")
        here = [whole[0], whole[1], whole[0] - start[0], whole[1] - start[1]]
        best = here if best is None else [min(x, y) for x, y in zip(best, here)]
    return best


def against_vdb_render():
    info = json.loads(subprocess.check_output([ours("neph-info"), "--json", "cloud.neph"]))
    low, high = info["clouds"][0]["bounds"]
    voxel, cells = max(y - x for x, y in zip(low, high)) / 256, 257
    print("\n| vdb_render against --method march, " + size + " | seconds | of processor time | the picture alone | of "
          "processor time |\n|---|---|---|---|---|", flush=True)
    for name, scatter, absorb in (("its own coefficients, 1.6 a voxel", 1.5, 0.1), ("the cloud's, 2 a metre", 2 * voxel, 0)):
        theirs = least(lambda s: vdb_render(scatter, absorb, "theirs.exr" if s == size else "small.exr", s))
        rows = [("vdb_render", theirs, None)]
        ways = [("march, steps of 3 voxels to the sun", ["--light-steps", str(cells // 3)], "march.exr")]
        if absorb == 0:
            ways.append(("march, --shadow grid", ["--shadow", "grid"], "grid.exr"))
        for label, light, file in ways:
            rows.append((label, least(lambda s: marched(scatter, absorb, voxel, cells, file if s == size else
                                                        "small.exr", s, light)), file))
        for label, row, file in rows:
            ratio = "" if file is None else " (" + ", ".join(f"{x / y:.1f}" for x, y in zip(theirs, row)) + " times)"
            print(f"| {label}: {name}{ratio} | " + " | ".join(f"{x:.3f}" for x in row) + " |", flush=True)
        for label, row, file in rows[1:]:
            found = compare("theirs.exr", file)
            print(f"\n{label}: means {mean(found, 'mean_a'):.4f} and {mean(found, 'mean_b'):.4f}, relative mean square "
                  f"difference {found['relmse']:.5f}\n", flush=True)


for g in (0.85, 0.3):
    against_cycles(g)
against_vdb_render()
END
python3 "$tmp/bench.py" "$programs" "$script" "$size" "$samples" "$turns" "$tmp"
