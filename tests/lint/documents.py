"""What the documents say of the project that can be checked: each path, test and name in backticks exists."""

import functools
import pathlib
import re

from source_text import ROOT, comments_of, without_comments

FOLDERS = ("engine", "tests", "bench", "cmake", "scenarios", "traces", "firmware_sim", "reports")
COMMANDS_OF_OTHERS = {"ctest"}
WRITTEN = (".hpp", ".cpp", ".py", ".cmake", ".lua", ".sh", "CMakeLists.txt", "run", "test")


def documents():
    """All but the history, which may name what has gone."""
    found = [*ROOT.glob("*.md"), *(p for folder in FOLDERS for p in (ROOT / folder).rglob("*.md"))]
    return {p.relative_to(ROOT).as_posix(): p.read_text() for p in sorted(found) if p.name != "CHANGELOG.md"}


@functools.cache
def files():
    found = [p for folder in FOLDERS for p in (ROOT / folder).rglob("*") if p.is_file()]
    return sorted(p.relative_to(ROOT).as_posix() for p in found)


@functools.cache
def words_of(path):
    """The words of a file's code: comments do not count, for what only a comment names may have gone."""
    text = (ROOT / path).read_text()
    is_cpp = path.endswith((".hpp", ".cpp"))
    return set(re.findall(r"\w+", without_comments(text) if is_cpp else re.sub(r"^\s*(#|--).*", "", text, flags=re.M)))


@functools.cache
def words_of_the_project():
    """But for what rules_test.py plants."""
    return set().union(*(words_of(p) for p in [*files(), "CMakeLists.txt", "CMakePresets.json"]
                         if p.endswith((*WRITTEN, ".json")) and p != "tests/lint/rules_test.py"))


def in_backticks(text):
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    return [word.rstrip(",.;:") for span in re.findall(r"`([^`]+)`", text) for word in span.split()]


def matching(pattern, folders):
    """The project's files that a path in a document means: from the root, or below one of the folders."""
    star = "".join("[^/]*" if c == "*" else re.escape(c) for c in pattern.replace("**/", "*").rstrip("/"))
    below = "|".join(re.escape(folder) + "/" for folder in folders)
    return [f for f in files() if re.match(rf"({below})?{star}(/|$)", f)]


def beside(path, text):
    """Folders from which a document's short paths may start: its own, its tests', those that it names."""
    here = str(pathlib.PurePath(path).parent)
    named = [name.rstrip("/") for name in in_backticks(text) if (ROOT / name).is_dir()]
    return ["engine", *named, *([here, here.replace("engine", "tests", 1)] if here != "." else [])]


def names_of_nothing(texts):
    """Paths, files and tests that a document names and that do not exist."""
    tests = {pathlib.Path(f).stem for f in files() if re.search(r"_test\.\w+$", f)}
    findings = []
    for path, text in texts.items():
        for name in in_backticks(text):
            if re.match(rf"({'|'.join(FOLDERS)})/", name):
                is_there = (ROOT / name).exists() or matching(name, [])
            elif re.fullmatch(r"[\w*/…]+\.(hpp|cpp|py|cmake|sh)", name):
                is_there = matching(name, beside(path, text)) or name.startswith("NAME.")
            elif re.fullmatch(r"\w+_test", name):
                is_there = name in tests
            else:
                continue
            if not is_there:
                findings.append(f"{path} names {name}")
    return findings


def rows_that_lead_astray(texts):
    """Rows of a table `what | where | look for` whose names do not stand in the code of the files of their row."""
    findings = []
    for path, text in texts.items():
        table = re.search(r"^\| what \| where \| look for \|\n(.*?)(?:\n\n|\Z)", text, re.MULTILINE | re.DOTALL)
        for row in table[1].splitlines() if table else []:
            names = in_backticks(row)
            places = [name for name in names if "/" in name]
            found = {f for name in names if "/" in name or "." in name for f in matching(name, places)}
            words = set().union(*(words_of(f) for f in found if f.endswith(WRITTEN)))
            for name in names:
                is_name = re.fullmatch(r"\w+(::\w+)*", name) and name not in places and not (ROOT / name).exists()
                if is_name and not set(name.split("::")) <= words:
                    findings.append(f"{path} looks for {name} in {' '.join(places)}")
    return findings


def words_of_nothing(texts):
    """Names in backticks of which a word stands nowhere in the project's code."""
    findings = []
    for path, text in texts.items():
        for name in in_backticks(text):
            if re.fullmatch(r"[\w:./~]+", name) and name not in COMMANDS_OF_OTHERS and not (ROOT / name).exists():
                gone = [w for w in re.findall(r"[A-Za-z]\w{2,}", name) if w not in words_of_the_project()]
                if gone and not matching(name, beside(path, text)) and not re.fullmatch(r"\w+_test", name):
                    findings.append(f"{path} names {name}, which no source does")
    return findings


def comments_that_name_nothing(sources):
    """Paths in the comments of sources that do not exist."""
    findings = []
    for path, text in sources.items():
        for comment in comments_of(text):
            for name in re.findall(rf"(?<![\w/.-])((?:{'|'.join(FOLDERS)})/[\w/*-]*[\w*-]{{2}}(?:\.\w+)?)", comment):
                if not (ROOT / name).exists() and not matching(name, []):
                    findings.append(f"{path} names {name}")
    return findings
