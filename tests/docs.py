"""The commands of the documents, run; what they point at, looked for. By tests/cli_docs.sh.

    python3 tests/docs.py PROGRAMS SOURCE [--blender] [DOCUMENT]...

A code block (indented by four, or fenced) whose first line begins by a program of ours, by a shell word, or by a command
of EXCEPTIONS is one of commands. A document's commands are run as a reader types them: from the top, by one shell, in one
folder, which holds a copy of README.md, docs and examples, and what GIVEN says that the reader has. A fence marked
"```lsys NAME" is a file that the reader writes. Programs come through wrappers of tests/docs_run.sh, which make pictures
and grids small; a program that fails anywhere, in a pipe too, is a mistake.

What is not run has its reason in EXCEPTIONS, and is held as far as can be: options, presets and scripts that it names are
there. --blender runs Blender's lines too (not in CTest: Blender is large).
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

# Files that a page takes for granted, and how the reader may have come by them.
MAKE = {
    "cloud.neph": "neph-gauss -q -o cloud.neph",
    "old.neph": "neph-gauss -q --count 8 -o old.neph",
    "a.neph": "neph-gauss -q --count 8 -o a.neph",
    "b.neph": "neph-meta -q -o b.neph",
    "before.neph": "neph-gauss -q --count 8 -o before.neph",
    "after.neph": "neph-gauss -q --count 8 --seed 2 -o after.neph",
    "castellanus.lsys": "cp examples/castellanus.lsys .",
    "castellanus.neph": "neph-lsys -q examples/castellanus.lsys -o castellanus.neph",
    "smoke.vdb": "neph-gauss -q --count 8 | neph-vdb -q - -o smoke.vdb",
    "scan.raw": "neph-gauss -q --count 8 | neph-vdb -q - --up y --header -o scan.raw",
    "shape.glb": "cp examples/meshes/suzanne.glb shape.glb",
    "house.glb": "cp examples/meshes/suzanne.glb house.glb",
    "scene.json": "neph-gauss -q --count 8 -o scene.neph --save-scene scene.json",
    "house.obj": "cp examples/meshes/suzanne.obj house.obj",
    "cycles.exr": "neph-gauss -q | neph-render -q - -o cycles.exr",
}
GIVEN = {
    "docs/error.md": ["cloud.neph"],
    "docs/fields.md": ["old.neph"],
    "docs/from-blender.md": ["shape.glb"],  # of Blender, which is not run here
    "docs/generators.md": ["a.neph", "b.neph"],
    "docs/simplify.md": ["cloud.neph"],
    "docs/viewer.md": ["castellanus.lsys", "castellanus.neph", "house.obj", "before.neph", "after.neph", "cloud.neph",
                       "house.glb", "scene.json"],
    "docs/volumes.md": ["smoke.vdb", "scan.raw"],
    "docs/vdb.md": ["cycles.exr"],  # of Blender, which is not run here
}

# Commands that are not run: how they begin, and why.
EXCEPTIONS = {
    "sh examples/quickstart.sh": "installs packages and builds; the README's first step, as .ci/run is",
    "sh tests/": "tests call no tests",
    "cmake ": "builds; cli_install.sh and packages.sh do it",
    "ctest ": "tests call no tests",
    "build/": "benchmarks and tests of another build",
    "sudo ": "needs root; packages.sh installs the packages without",
    "cc ": "needs an installed tree; cli_install.sh builds tests/consumer so",
    "find_package": "CMake's language; tests/consumer",
    "target_link_libraries": "the same",
    "blender ": "large; run with --blender, and by blender_vdb.sh",
    "gnuplot ": "draws what a benchmark measured",
    "neph-render explosion.vdb ": "needs colour grids, which no program here writes; test_vdb_colour",
    "neph-render smoke.vdb --colour-grid": "the same",
    "sh examples/frames/parallel.sh": "draws 250 frames; cli_spread.sh runs it",
    "sbatch ": "needs Slurm; tests/slurm.sh",
    "neph-view castellanus-0001.png": "of a picture made in the window; cli_window_scene.sh",
    "neph-render castellanus-0001.png": "the same",
    "identify ": "of a picture made in the window; cli_window.sh",
    "neph-chart --size 320x180": "a quarter of an hour; cli_chart.sh runs neph-chart",
}
# Options that the text names and that are not of our programs: of these scripts, of CMake and Blender.
SCRIPTS = ["examples/quickstart.sh", "tests/run.sh", "examples/blender/import_vdb.py"]
FOREIGN = {"--install", "--preset", "--python-expr"}
SHELL = re.compile(r"(for|mkdir|cd|cp|cat|ls|[A-Za-z_]+=)( |\S)")
PROGRAM = re.compile(r"neph-[a-z]+")

mistakes = []


def mistake(where, what):
    mistakes.append(f"{where}: {what}")


def blocks(text):
    """(first line's number, words behind the fence, lines) of each code block."""
    lines, found, at = text.split("\n"), [], 0
    while at < len(lines):
        fence = re.match(r"```(.*)", lines[at])
        start = at
        if fence:
            at += 1
            while at < len(lines) and not lines[at].startswith("```"):
                at += 1
            found.append((start + 2, fence.group(1).split(), lines[start + 1:at]))
        elif lines[at].startswith("    ") and (at == 0 or not lines[at - 1].strip()):
            while at < len(lines) and (lines[at].startswith("    ") or not lines[at].strip()):
                at += 1
            found.append((start + 1, [], [line[4:] for line in lines[start:at]]))
        at += 1
    return found


def statements(first, lines):
    """(line's number, command): lines that go on joined, loops whole."""
    number, parts, whole = first, [], []
    for at, line in enumerate(lines):
        if not parts:
            number = first + at
        parts.append(line)
        command = "\n".join(parts)
        bare = re.sub(r"(?m)(^|\s)#.*", "", command)
        loops = len(re.findall(r"(?:^|;)\s*(?:for|while)\b", bare)) - len(re.findall(r"(?:^|;)\s*done\b", bare))
        if not line.endswith("\\") and loops <= 0 and bare.count("'") % 2 == 0:
            if command.strip() and not command.lstrip().startswith("#"):
                whole.append((number, command))
            parts = []
    if parts and "".join(parts).strip():
        whole.append((number, "\n".join(parts)))
    return whole


def exception_of(command):
    return next((start for start in EXCEPTIONS if command.startswith(start)), None)


def is_command(line):
    return bool(PROGRAM.match(line) or SHELL.match(line) or exception_of(line))


class Source:
    """What is in the source folder, and what the programs' help says."""

    def __init__(self, programs, folder):
        self.folder = folder
        self.help = {}
        for name in sorted(os.listdir(programs)):
            if name.startswith("neph-"):
                text = subprocess.run([os.path.join(programs, name), "--help"], capture_output=True, text=True,
                                      check=True).stdout
                self.help[name] = set(re.findall(r"--[a-z][a-z0-9-]*", text))
        self.presets = re.findall(r'"name": "([^"]+)"', self.text("CMakePresets.json"))
        self.tests = [name.rsplit(".", 1)[0] for name in os.listdir(os.path.join(folder, "tests"))]

    def text(self, name):
        with open(os.path.join(self.folder, name), encoding="utf-8") as file:
            return file.read()

    def has(self, name):
        return os.path.exists(os.path.join(self.folder, name))


def check_unrun(source, where, command):
    """A command that is not run: its options, presets, scripts and tests are there."""
    command = re.sub(r"(^|\s)#.*", "", command)
    for part in re.split(r"[|;&]+", command):
        name = PROGRAM.search(part)
        if name and name.group() in source.help:
            for option in set(re.findall(r"(?<=\s)--[a-z][a-z0-9-]*", part)) - source.help[name.group()]:
                mistake(where, f"{name.group()} has no {option}")
        script = re.search(r"(?:^\s*sh|--python) (\S+)", part)
        if script:
            own = script.group(1).replace("$nephele/", "")
            if not source.has(own):
                mistake(where, f"there is no {own}")
            else:
                for option in set(re.findall(r"(?<=\s)--[a-z][a-z0-9-]*", part.split(script.group(1))[1])):
                    if option not in source.text(own):
                        mistake(where, f"{own} has no {option}")
        for preset in re.findall(r"(?:cmake|ctest)\b.* --preset (\S+)", part):
            if preset not in source.presets:
                mistake(where, f"there is no preset {preset}")
        for wanted in re.findall(r"^\s*ctest\b.* -R '?([^' ]+)", part):
            if not any(re.search(wanted, name) for name in source.tests):
                mistake(where, f"no test has the name {wanted}")


def run_document(source, programs, page, with_blender, used):
    """Runs the commands of a page, top to bottom."""
    script, count, seen = ["set -e"], 0, set()
    for name in GIVEN.get(page, []):
        script.append(f"export DOCS_LINE={page}:{name}; {MAKE[name]}")
    for first, words, lines in blocks(source.text(page)):
        if words[:1] == ["lsys"] and len(words) == 2:
            script.append("cat >%s <<'END_OF_FILE'\n%s\nEND_OF_FILE" % (words[1], "\n".join(lines)))
            script.append(f"export DOCS_LINE={page}:{first}; neph-lsys -q {words[1]} -o /dev/null")
            count += 1
            continue
        if words and words[0] != "sh" or not lines or not (words or is_command(lines[0])):
            for at, line in enumerate(lines):
                if PROGRAM.match(line):
                    mistake(f"{page}:{first + at}", "a command that is never run: its block begins by something else")
            continue
        for number, command in statements(first, lines):
            where, start = f"{page}:{number}", exception_of(command)
            if "[--" in command:  # a synopsis
                check_unrun(source, where, command.replace("[", " ").replace("]", " "))
            elif start and not (with_blender and start == "blender "):
                used.add(start)
                check_unrun(source, where, command)
            elif not is_command(command.lstrip()):
                mistake(where, f"neither run nor an exception: {command}")
            else:
                script.append(f"export DOCS_LINE={where}\n{command}")
                seen.update(re.findall(r"[\w.-]+\.\w+", command))
                count += 1
    for name in GIVEN.get(page, []):
        if name not in seen:
            mistake(page, f"{name} is given to it, and not used")
    if count:
        run_script(source, programs, page, script)
    return count


def run_script(source, programs, page, script):
    with tempfile.TemporaryDirectory() as folder:
        tree, wrappers, failed = (os.path.join(folder, name) for name in ("tree", "bin", "failed"))
        for name in ("docs", "examples"):
            shutil.copytree(os.path.join(source.folder, name), os.path.join(tree, name))
        os.mkdir(wrappers)
        for name in [*source.help, "blender"]:
            os.symlink(os.path.join(source.folder, "tests", "docs_run.sh"), os.path.join(wrappers, name))
        with open(os.path.join(folder, "script"), "w", encoding="utf-8") as file:
            file.write("\n".join(script) + "\n")
        shell = {**os.environ, "PATH": wrappers + ":" + os.environ["PATH"], "HOME": folder, "DOCS_PROGRAMS": programs,
                 "DOCS_FAILED": failed,
                 "OMP_NUM_THREADS": "1"}  # other work on the same cores then costs its share only
        for name in ("DISPLAY", "WAYLAND_DISPLAY"):
            shell.pop(name, None)
        done = subprocess.run(["sh", os.path.join(folder, "script")], cwd=tree, env=shell, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, errors="replace")
        if os.path.exists(failed):
            with open(failed, encoding="utf-8") as file:
                mistakes.extend(file.read().strip().split("\n"))
        elif done.returncode:
            mistake(page, f"its commands end with {done.returncode}: {done.stderr.strip()[-300:]}")


def check_text(source, page):
    """Options, links and pictures that the text names are there. Returns its pictures."""
    text = source.text(page)
    known = set().union(FOREIGN, *source.help.values(), *(re.findall(r"--[a-z][a-z-]*", source.text(name)) for name in SCRIPTS))
    prose = re.sub(r"(?ms)^```.*?^```", "", re.sub(r"(?m)^    .*", "", text))
    for span in re.findall(r"`([^`]+)`", prose):
        script = next((word for word in span.split() if word.endswith((".sh", ".py")) and source.has(word)), None)
        for option in re.findall(r"(?:^|\s)(--[a-z][a-z0-9-]*)", span):
            if option not in known and not (script and option in source.text(script)):
                mistake(page, f"no program has {option}")
    pictures = set()
    for bang, target in re.findall(r"(!?)\[[^\]]*\]\(([^)#\s]+)[^)]*\)", prose):
        if "://" in target:
            continue
        path = os.path.normpath(os.path.join(os.path.dirname(page), target))
        if not source.has(path):
            mistake(page, f"links to {target}, which is not there")
        if bang:
            pictures.add(path)
    for target in re.findall(r'<img [^>]*src="([^"]+)"', prose):
        path = os.path.normpath(os.path.join(os.path.dirname(page), target))
        if not source.has(path):
            mistake(page, f"shows {target}, which is not there")
        pictures.add(path)
    return pictures


def check_pictures(source, shown, pages):
    """Every picture under docs is shown by a page, and docs/pictures.sh, or a page's own command, makes it."""
    listed = subprocess.run(["sh", os.path.join(source.folder, "docs/pictures.sh"), "--list"], capture_output=True, text=True,
                            check=True).stdout
    made = {line.split("\t")[0] for line in listed.strip().split("\n")}
    for page in pages:
        for _, _, lines in blocks(source.text(page)):
            made.update(re.findall(r"docs/[\w/-]+\.png", "\n".join(lines)))
    there = {os.path.relpath(os.path.join(folder, name), source.folder)
             for folder, _, names in os.walk(os.path.join(source.folder, "docs")) for name in names if name.endswith(".png")}
    for name in sorted(there - made):
        mistake(name, "no command makes it (add it to docs/pictures.sh)")
    for name in sorted(there - shown):
        mistake(name, "no page shows it")


def main():
    words = [word for word in sys.argv[1:] if word != "--blender"]
    programs, folder = (os.path.abspath(word) for word in words[:2])
    source, used, shown, count = Source(programs, folder), set(), set(), 0
    pages = ["README.md", "CONTRIBUTING.md", "shaders/README.md"]
    pages += sorted("docs/" + name for name in os.listdir(os.path.join(folder, "docs")) if name.endswith(".md"))
    chosen = words[2:] or pages
    for page in chosen:
        count += run_document(source, programs, page, "--blender" in sys.argv, used)
        shown |= check_text(source, page)
    if chosen == pages:
        check_pictures(source, shown, pages)
        for start in sorted(set(EXCEPTIONS) - used):
            if not (start == "blender " and "--blender" in sys.argv):
                mistake("tests/docs.py", f'no page has the exception "{start}"')
    for line in mistakes:
        print(f"cli_docs: {line}", file=sys.stderr)
    print(f"{count} commands of {len(chosen)} pages")
    return 1 if mistakes else 0


sys.exit(main())
