#!/usr/bin/env python3
"""Breaks the code under each test file in small ways, and says which test files do not notice.

Usage: scripts/mutants.py [--tests PATTERN] [--count N] [--seed N] [--list]

A mutant is one change in one source: another operator, another constant, another return value. It counts if it changes
the machine code. The code under a test file is the sources of the private headers that it includes, the one that shares
its name first; SOURCES has those of other test files. All work happens in a git worktree of HEAD, build/mutants/tree, so
your files stay as they are. A mutant is killed if a case of that test file fails, crashes, or takes ten times as long as
before. A survivor is tried on the other files of the program, too, but not in the baker, where that takes minutes. The
last lines list the test files with the most survivors.
"""
import argparse
import fnmatch
import hashlib
import pathlib
import random
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TREE = ROOT / "build/mutants/tree"
BUILD = ROOT / "build/mutants/build"
PROGRAMS = {  # folder of tests -> program that runs them
    "tests/unit/runtime": "test_runtime",
    "tests/unit/contacts": "test_contacts",
    "tests/unit/baker/filter": "test_filter",
    "tests/unit/baker/truth": "test_truth",
    "tests/unit/baker": "test_baker",
}
# Sources in runtime/src of tests whose headers do not name them, by the start of the test's name. The first match counts;
# a test of all code has none.
SOURCES = {"allocation": "", "threads": "", "fields": "crowd/checks", "status": "base/status",
           "refit_bones": "refit/moments_kernel", "refit_vertices": "refit/refit", "filter": "pairs/filter",
           "detect_table": "pairs/detect_table pairs/pair_lists", "detect": "pairs/detect pairs/tile pairs/pair_lists",
           "crowd_bones": "crowd/moments crowd/lanes", "crowd": "crowd/crowd crowd/lanes", "step": "step/*",
           "skin_contacts": "contacts/*", "body_contacts": "contacts/*", "sphere_contacts": "contacts/*",
           "skin_corruption": "asset/skin_checks", "cluster_bounds": "clusters/*",
           "corruption": "asset/asset_checks asset/moment_checks asset/range_checks",
           "open": "asset/open asset/accessors", "bind": "pose/bind pose/transform", "source": "pose/source",
           "scene": "bodies/scene", "body": "bodies/body bodies/model bodies/questions", "skin": "skin/*"}
CHANGES = [
    (r"(?<![<>=!\-+*/&|])<(?![<=a-zA-Z])", "<="), (r"<=", "<"), (r"(?<![->])>(?![>=])(?= )", ">="), (r">=", ">"),
    (r"==", "!="), (r"!=", "=="), (r"&&", "||"), (r"\|\|", "&&"), (r" \+ ", " - "), (r" - ", " + "),
    (r" \* ", " / "), (r" / ", " * "), (r"std::min\b", "std::max"), (r"std::max\b", "std::min"),
    (r"\btrue\b", "false"), (r"\bfalse\b", "true"), (r"(?<=[(\s])!(?=[a-z(])", ""),
    (r"(?<![\w.\[])([1-9]\d*)(?![\w.\]])", lambda m: str(int(m.group(1)) + 1)),
    (r"(?<![\w.])(\d+\.\d+)(?![\w])", lambda m: f"{2 * float(m.group(1)):g}"),
    (r"\breturn [^;{}]+;", "return {};"), (r"\bcontinue;", "break;"),
]
SKIPPED = re.compile(r"^\s*(//|#|template|using|namespace|static_assert|inline constexpr std::size_t k\w+ = \d)|\"|"
                     r"\bmemory\.take\(")  # more memory than is needed shows in no answer


def run(command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)


def prepare():
    if not TREE.exists():
        run(["git", "worktree", "add", "--detach", TREE, "HEAD"], cwd=ROOT, check=True)
    run(["git", "checkout", "--force", "--detach", run(["git", "rev-parse", "HEAD"], cwd=ROOT).stdout.strip()], cwd=TREE, check=True)
    off = ["CUDA", "STUDIES", "PYTHON", "JAVASCRIPT", "VIEWER"]
    options = [f"-DSPHERECHAIN_{name}=OFF" for name in off]
    run(["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG",
         "-DCMAKE_UNITY_BUILD=OFF", *options], check=True)


def program_of(test):
    return next(program for folder, program in PROGRAMS.items() if test.startswith(folder + "/"))


def build(program):
    """True if it compiles. Tests of the baker run the tool, too."""
    tool = [] if program in ("test_runtime", "test_contacts") else ["spherechain"]
    return run(["ninja", "-C", BUILD, program, *tool]).returncode == 0


def machine_code(program):
    return hashlib.sha256((BUILD / "bin" / program).read_bytes()).digest()


def sources_of(test):
    """The code under a test file, as paths: what shares its name, or else all that it includes."""
    text = (TREE / test).read_text()
    stem = pathlib.Path(test).stem.removesuffix("_test")
    included = re.findall(r'#include "((?:baker|runtime/src)/[\w/]+)\.h"', text)
    found = [f"{name}.cpp" for name in included if (TREE / f"{name}.cpp").exists()]
    if same := [source for source in found if pathlib.Path(source).stem == stem]:
        return same
    if test.startswith("tests/unit/baker/") and not found:
        return sorted(str(p.relative_to(TREE)) for p in (TREE / "baker" / pathlib.Path(test).parent.name).glob("*.cpp"))
    named = next((names for start, names in SOURCES.items() if stem.startswith(start)), None)
    if named is not None and not test.startswith("tests/unit/baker/"):
        return sorted(str(p.relative_to(TREE)) for name in named.split() for p in (TREE / "runtime/src").glob(name + ".cpp"))
    return found


def mutants_of(sources, random_numbers):
    """All mutants in random order, as (source, line number, line after)."""
    places = []
    for source in sources:
        for number, line in enumerate((TREE / source).read_text().splitlines()):
            if SKIPPED.search(line):
                continue
            code = line.split("//")[0]
            for pattern, change in CHANGES:
                places += [(source, number, code[:m.start()] + m.expand(change) + code[m.end():] if isinstance(change, str)
                            else code[:m.start()] + change(m) + code[m.end():]) for m in re.finditer(pattern, code)]
    random_numbers.shuffle(places)
    return places


def is_killed(program, test, seconds):
    try:
        return run([BUILD / "bin" / program, f"-sf=*{test}", "-tse=many bakes,long runs"], timeout=seconds, cwd=TREE).returncode != 0
    except subprocess.TimeoutExpired:
        return True


def try_mutants(test, count, random_numbers):
    """Returns how many mutants were tried, and the survivors."""
    program = program_of(test)
    if not build(program):
        sys.exit(f"mutants: {program} does not build")
    start = time.monotonic()
    if is_killed(program, test, 600):
        print(f"{test}: fails without a mutant", flush=True)
        return 0, []
    seconds = 10 * (time.monotonic() - start) + 5
    unchanged = machine_code(program)
    tried, survivors = 0, []
    for source, number, line in mutants_of(sources_of(test), random_numbers):
        if tried == count:
            break
        path = TREE / source
        before = path.read_text()
        lines = before.splitlines(keepends=True)
        old = lines[number].strip()
        lines[number] = line.rstrip() + "\n"
        path.write_text("".join(lines))
        if build(program) and machine_code(program) != unchanged:
            tried += 1
            if not is_killed(program, test, seconds):
                noticed = program != "test_baker" and is_killed(program, "", 600)
                survivors.append(f"{source}:{number + 1}: {old}  ->  {line.strip()}" + "  (other files notice)" * noticed)
        path.write_text(before)
    return tried, survivors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tests", default="*", help="pattern of test files: '*/runtime/*'")
    parser.add_argument("--count", type=int, default=6, help="mutants of each test file")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--list", action="store_true", help="say which sources each test file covers, and stop")
    options = parser.parse_args()
    prepare()
    tests = sorted(str(p.relative_to(TREE)) for folder in PROGRAMS for p in (TREE / folder).rglob("*_test.cpp"))
    tests = [t for t in dict.fromkeys(tests) if fnmatch.fnmatch(t, options.tests)]
    results = []
    for test in tests:
        if options.list or not sources_of(test):
            print(f"{test}: {' '.join(sources_of(test)) or 'no source of its own'}", flush=True)
            continue
        tried, survivors = try_mutants(test, options.count, random.Random(f"{options.seed} {test}"))
        results.append((len(survivors), tried, test))
        print(f"{test}: {len(survivors)} of {tried} survive", *survivors, sep="\n  ", flush=True)
    print("\nThe worst:")
    for survived, tried, test in sorted(results, reverse=True)[:20]:
        if survived:
            print(f"{survived} of {tried}  {test}")


if __name__ == "__main__":
    main()
