"""What the rules read of a source: its text without comments and strings, its includes, its functions."""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]

COMMENT_OR_LITERAL = re.compile(r"""
    (?P<comment> //[^\n]* | /\*.*?\*/ )
  | (?P<string> R"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)" | "(?:\\.|[^"\\\n])*" )
  | (?<![\w]) '(?:\\.|[^'\\\n])+'    # a character; the quote in 1'000 follows a digit
""", re.DOTALL | re.VERBOSE)


def sources(*folders):
    found = {}
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.[ch]pp")):
            found[path.relative_to(ROOT).as_posix()] = path.read_text()
    return found


def without_comments(text, strings=True):
    """`text` with the same lines, each comment a blank; with `strings` false each literal is empty too."""

    def replaced(match):
        lines = "\n" * match[0].count("\n")
        if match["comment"]:
            return " " + lines
        return match[0] if strings else '""' + lines

    return COMMENT_OR_LITERAL.sub(replaced, text.replace("\\\n", " \n"))


def code_of(text):
    return without_comments(text, strings=False)


def comments_of(text):
    return [match["comment"] for match in COMMENT_OR_LITERAL.finditer(text) if match["comment"]]


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def includes(text):
    """What stands behind each #include, with its quotes or brackets: "engine/base/pose.hpp", <vector>, A_MACRO."""
    directive = r"^[ \t]*(?:#|%:)\s*(?:include(?:_next)?|import)\b\s*(\"[^\"\n]*\"|<[^>\n]*>|[^\s]*)"
    return re.findall(directive, without_comments(text), re.MULTILINE)


def header_in(include):
    return include.strip('"<>')


CONTAINER = re.compile(r"\b(namespace|class|struct|union|enum)\b[^()=]*$|^\s*extern\s*\"\"\s*$")
NAME_OF_FUNCTION = re.compile(r"([\w:~]+|operator\W+|\[[^\[\]]*\])\s*\(")  # a function, an operator, a lambda


def functions(text):
    """Name and number of lines of each function with a body, from its signature's first line to its last brace.

    Reads braces, not C++: what opens at the outermost level that is no namespace, type or initializer is a function.
    """
    code = re.sub(r"^[ \t]*#.*$", "", code_of(text), flags=re.MULTILINE)
    found, depth, inside, begin = [], 0, None, 0  # inside: the depth of the function that is open
    for brace in re.finditer(r"[{};]", code):
        after = brace.end()
        head = code[begin:brace.start()]
        if brace[0] == "{":
            depth += 1
            if inside is None and not CONTAINER.search(re.sub(r"alignas\s*\([^()]*\)", "", head)):
                inside, signature = depth, head.strip()
        elif brace[0] == "}":
            depth -= 1
            if inside is not None and depth < inside:
                inside = None
                if code[after:].lstrip()[:1] in (",", "{"):  # a member's initializer: the body is still to come
                    continue
                name = NAME_OF_FUNCTION.search(signature)
                if name and not signature.endswith("="):
                    first = begin + len(code[begin:]) - len(code[begin:].lstrip())
                    found.append((name[1], line_of(code, after) - line_of(code, first) + 1))
        if inside is None:
            begin = after
    return found
