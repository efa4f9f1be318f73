#!/usr/bin/env python3
"""Kills neph-chart (signal 9) at random moments and lets it go on: python3 tests/kill_chart.py PROGRAMS KILLS [SEED]

After each kill every file of the folder is whole or not there: the reference is that of a run that was never killed, byte for
byte; results.csv holds whole rows, among them all that stood there before; both charts and the report have their ends. Other
files only have such a name and six characters more. The next run goes on in the same folder. Called by cli_kill.sh."""
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

programs, kills = os.path.abspath(sys.argv[1]), int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
chance = random.Random(seed)
NAMES = r"(results\.csv|chart\.svg|chart\.png|report\.md|reference-[0-9a-f]+\.exr)"


def fail(text):
    sys.exit("cli_kill: neph-chart: %s (seed %d)" % (text, seed))


def read(path):
    with open(path, "rb") as file:
        return file.read()


def rows(folder):
    """What stands in results.csv, without the column that says which rows are best of those there are."""
    path = os.path.join(folder, "results.csv")
    if not os.path.exists(path):
        return []
    text = read(path).decode()
    lines = text.split("\n")
    if lines.pop() != "" or not lines[0].startswith("scene,method,"):
        fail("results.csv is a part")
    cells = [line.split(",") for line in lines]
    if any(len(row) != len(cells[0]) for row in cells):
        fail("results.csv has a part of a row")
    front = cells[0].index("front")
    return [tuple(row[:front] + row[front + 1:]) for row in cells[1:]]


def check_whole(folder, name, whole):
    data = read(os.path.join(folder, name))
    if name.endswith(".exr") and data != read(os.path.join(whole, name)):
        fail("%s is not the reference" % name)
    ends = {"chart.svg": b"</svg>", "chart.png": b"IEND\xaeB`\x82"}
    if name in ends and not data.rstrip(b"\n").endswith(ends[name]):
        fail("%s is a part" % name)
    if name == "report.md" and (b"## What never pays" not in data or not data.endswith(b"\n")):
        fail("report.md is a part")


def check(folder, whole, before):
    """The rows that are there now, and how many files are left over."""
    left = 0
    for name in os.listdir(folder):
        if re.fullmatch(NAMES, name):
            check_whole(folder, name, whole)
        elif re.fullmatch(NAMES + r"\.[A-Za-z0-9]{6}", name):
            left += 1
            os.unlink(os.path.join(folder, name))
        else:
            fail("left a file %s" % name)
    now = rows(folder)
    if not set(before) <= set(now):
        fail("rows that had been measured are gone")
    return now, left


def main():
    with tempfile.TemporaryDirectory() as place:
        cloud, whole, folder = (os.path.join(place, name) for name in ("thin.neph", "whole", "killed"))
        subprocess.run([os.path.join(programs, "neph-gauss"), "-q", "--count", "12", "--sigma", "6,0.1,0.1", "--max-radius",
                        "0.5", "--no-hollow", "--no-prune", "-o", cloud], check=True)
        command = [os.path.join(programs, "neph-chart"), "-q", "--quick", "--size", "16x9", "--runs", "1",
                   "--reference-noise", "2", cloud, "-o"]
        start = time.monotonic()
        subprocess.run(command + [whole], check=True)
        duration = time.monotonic() - start
        done, left, attempts, finished, before = 0, 0, 0, 0, []
        while done < kills:
            attempts += 1
            if attempts > 20 * kills + 100:
                fail("ends before it can be killed")
            child = subprocess.Popen(command + [folder], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(duration * 0.7 * chance.random())
            child.kill()
            if child.wait() == 0:
                finished += 1
                shutil.rmtree(folder)
                before = []
                continue
            done += 1
            if os.path.isdir(folder):
                before, more = check(folder, whole, before)
                left += more
        subprocess.run(command + [folder], check=True)
        now, more = check(folder, whole, before)
        if len(now) != len(rows(whole)) or len(os.listdir(folder)) != len(os.listdir(whole)):
            fail("a run that was killed and goes on does not end with all rows and files")
    print("cli_kill: %d kills of neph-chart, which went on each time; %d charts became whole; %d temporary files left"
          % (done, finished + 1, left))


main()
