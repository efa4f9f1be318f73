#!/usr/bin/env python3
"""Kills writing programs (signal 9) at random moments: python3 tests/kill_at_random.py PROGRAMS SOURCES KILLS [SEED [WRITER,...]]

For each program an old and a new file are made by whole runs. Then the old one is put in place, the program is started
to write the new one over it, and is killed. What stands there afterwards must be the old file or the new one, byte for
byte. Other files in the folder may only have the target's name and six characters more; a whole run afterwards must
succeed beside them. WRITERS: only these programs, such as gauss,meta. Called by cli_kill.sh."""
import os
import random
import re
import subprocess
import sys
import tempfile
import time

programs, sources, kills = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3])
seed = int(sys.argv[4]) if len(sys.argv) > 4 else 1
only = sys.argv[5].split(",") if len(sys.argv) > 5 else []
chance = random.Random(seed)


def command(name, *arguments):
    return [os.path.join(programs, "neph-" + name), "-q", *arguments]


def cases(folder):
    """Name of the target, the command of the old file, the command of the new one (without -o)."""
    cloud = os.path.join(folder, "cloud.neph")
    big = os.path.join(folder, "big.neph")
    mesh = os.path.join(sources, "examples/meshes/suzanne.ply")
    grammar = os.path.join(sources, "examples/castellanus.lsys")
    fog = os.path.join(sources, "tests/frozen/vdb/fog.vdb")
    many = ["--no-hollow", "--no-prune", "--count"]
    small = ["--size", "32x18", "--spp", "1"]
    coarse = ["--cells", "16", "--primitives"]
    subprocess.run(command("gauss", "--count", "12", "-o", cloud), check=True)
    subprocess.run(command("gauss", *many, "20000", "-o", big), check=True)
    listed = [
        ("a.neph", command("gauss", "--seed", "2"), command("gauss", *many, "60000")),
        ("b.neph", command("lsys", grammar), command("lsys", grammar, "--seed", "2")),
        ("c.neph", command("meta"), command("meta", "--count", "500")),
        ("d.neph", command("layer"), command("layer", "--seed", "2")),
        ("e.neph", command("edit", cloud), command("edit", big, "--scale", "2,2,2")),
        ("f.neph", command("mesh", mesh, "--faces", "20"), command("mesh", mesh)),
        ("h.csv", command("info", "--csv", cloud), command("info", "--csv", big)),
        ("i.png", command("render", cloud, *small), command("render", cloud, *small, "--sun", "10,50")),
        ("j.exr", command("render", cloud, *small), command("render", cloud, *small, "--sun", "10,50")),
        ("k.pfm", command("render", cloud, *small), command("render", cloud, *small, "--sun", "10,50")),
    ]
    if kills >= 200:
        listed.append(("g.neph", command("vdb", fog, *coarse, "2"), command("vdb", fog, *coarse, "4")))
    scene = ["gauss", "-o", os.path.join(folder, "scene.neph")]
    listed.append(("l.json", command(*scene), command(*scene, "--seed", "2")))
    # A volume out: only where neph-vdb is there to write it.
    text = subprocess.run(command("vdb", "--help"), capture_output=True, text=True).stdout
    if "--half" in text:
        listed.append(("m.vdb", command("vdb", cloud, "--resolution", "12"), command("vdb", cloud, "--resolution", "40")))
    shown = ["--headless", "--size", "32x18", "--samples", "1", "--light-grid", "4"]
    listed.append(("n.png", command("view", cloud, *shown), command("view", cloud, *shown, "--sun", "10,50")))
    return [case for case in listed if not only or os.path.basename(case[2][0])[len("neph-"):] in only]


def output_of(name):
    return "--save-scene" if name.endswith(".json") else "-o"


def read(path):
    with open(path, "rb") as file:
        return file.read()


def run_whole(arguments):
    start = time.monotonic()
    done = subprocess.run(arguments, capture_output=True, text=True)
    if done.returncode:
        sys.exit("cli_kill: %s ended with %d: %s" % (" ".join(arguments), done.returncode, done.stderr))
    return time.monotonic() - start


def whole_runs(folder, name, old, new):
    """The bytes of both files, and the time of making the second over the first [s]."""
    target = os.path.join(folder, name)
    run_whole(old + [output_of(name), target])
    before = read(target)
    duration = run_whole(new + [output_of(name), target])
    after = read(target)
    if before == after:
        sys.exit("cli_kill: old and new %s are equal, so that nothing can be told" % name)
    return before, after, duration


def check_folder(folder, name):
    """How many leftovers there are."""
    others = [other for other in os.listdir(folder) if other != name]
    for other in others:
        if not re.fullmatch(re.escape(name) + r"\.[A-Za-z0-9]{6}", other):
            sys.exit("cli_kill: %s left a file %s" % (name, other))
    return len(others)


def kill_once(folder, name, new, moment):
    """True where the program was still running."""
    child = subprocess.Popen(new + [output_of(name), os.path.join(folder, name)], stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
    time.sleep(moment)
    child.kill()
    return child.wait() != 0


def main():
    counts = {"kills": 0, "old": 0, "new": 0, "leftovers": 0}
    with tempfile.TemporaryDirectory() as folder:
        listed = cases(folder)
        if not listed:
            sys.exit("cli_kill: no writer is named %s" % ",".join(only))
        places, durations = [], []
        for name, old, new in listed:
            place = os.path.join(folder, name + "-folder")
            os.mkdir(place)
            before, after, duration = whole_runs(place, name, old, new)
            places.append((place, name, old, new, before, after))
            durations.append(duration)
        attempt = 0
        while counts["kills"] < kills:
            if attempt > 20 * kills + 100:
                sys.exit("cli_kill: the programs end before they can be killed")
            place, name, old, new, before, after = places[attempt % len(places)]
            duration = durations[attempt % len(places)]
            target = os.path.join(place, name)
            with open(target, "wb") as file:
                file.write(before)
            # Half of them anywhere, half towards the end, where files are written.
            start = 0 if chance.random() < 0.5 else 0.6
            killed = kill_once(place, name, new, duration * (start + (1.05 - start) * chance.random()))
            found = read(target)
            # A machine that does other work makes runs longer than measured: so that a fourth comes after the new file.
            durations[attempt % len(places)] *= 1.01 if killed and found == before else 0.97
            attempt += 1
            if not killed:
                continue
            counts["kills"] += 1
            if counts["kills"] % 100 == 0:
                print("cli_kill: %d kills" % counts["kills"], flush=True)
            if found not in (before, after):
                sys.exit("cli_kill: %s is neither the old file nor the new one (seed %d, attempt %d)" % (name, seed, attempt - 1))
            counts["new" if found == after else "old"] += 1
            counts["leftovers"] += check_folder(place, name)
            for other in os.listdir(place):
                if other != name:
                    os.unlink(os.path.join(place, other))
        for place, name, old, new, before, after in places:
            # What a kill at the worst moment leaves must not disturb.
            with open(os.path.join(place, name + ".000001"), "wb") as file:
                file.write(b"half")
            run_whole(new + [output_of(name), os.path.join(place, name)])
            if read(os.path.join(place, name)) != after or check_folder(place, name) != 1:
                sys.exit("cli_kill: a whole run of %s after a kill does not give the new file" % name)
    print("cli_kill: %(kills)d kills of %(programs)d writers: %(old)d times the old file, %(new)d times the new one, "
          "never a part; %(leftovers)d temporary files left" % dict(counts, programs=len(places)))


main()
