"""What the rules read of a source: its text without comments and strings, its includes, its functions."""

import functools
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


@functools.cache  # thirty rules read the same files
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


def bodies(code):
    """Where functions with a body stand: begin of the signature, of the body, and the end.

    Reads braces, not C++: what opens at the outermost level that is no namespace, type or initializer is a function.
    """
    depth, inside, begin = 0, None, 0  # inside: the depth of the function that is open, and where its body begins
    for brace in re.finditer(r"[{};]", code):
        after = brace.end()
        head = code[begin:brace.start()]
        if brace[0] == "{":
            depth += 1
            if inside is None and not CONTAINER.search(re.sub(r"alignas\s*\([^()]*\)", "", head)):
                inside, body = depth, brace.start()
        elif brace[0] == "}":
            depth -= 1
            if inside is not None and depth < inside:
                inside = None
                if code[after:].lstrip()[:1] in (",", "{"):  # a member's initializer: the body is still to come
                    continue
                if NAME_OF_FUNCTION.search(code[begin:body]) and not code[begin:body].rstrip().endswith("="):
                    yield begin + len(code[begin:]) - len(code[begin:].lstrip()), body, after
        if inside is None:
            begin = after


def without_directives(text):
    """The code of `text` with the same lines, each of the preprocessor's blank."""
    directive = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", re.MULTILINE)
    return code_of(directive.sub(lambda match: "\n" * match[0].count("\n"), text))


def functions(text):
    """Name and number of lines of each function with a body, from its signature's first line to its last brace."""
    code = without_directives(text)
    return [(NAME_OF_FUNCTION.search(code[first:body])[1], line_of(code, end) - line_of(code, first) + 1)
            for first, body, end in bodies(code)]


def declarations(text):
    """The names of the functions that a text declares or defines, as often as it does."""
    code = without_directives(text)
    for _, body, end in reversed(list(bodies(code))):
        code = code[:body] + ";" + code[end:]
    return re.findall(r"(?:[\w>\]]\s+|[&*]\s*|(?<!std)::)(?<!return )(\w+)\s*\(", code)
