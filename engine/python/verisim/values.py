"""Python's values as --set and --vary take them, its paths as a run file and messages hold them, and what is said of those
that are of another kind: Failure with what is wrong and what is wanted, never a text of the machinery between."""
import math as _math
import numbers as _numbers
import operator as _operator
import os as _os
import re as _re

from ._verisim import Failure

_ONE_VALUE = _re.compile(r"""(?:[^,"'(\[{]|"[^"]*"|'[^']*'|[(\[{].*[)\]}])*""", _re.DOTALL)


def shown(value):
    """A value in a message."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def whole_of(what, value, least, most):
    """An int from least to most."""
    try:
        number = None if isinstance(value, bool) else _operator.index(value)
    except TypeError:
        number = None
    if number is None or not least <= number <= most:
        raise Failure(f"{what}: {shown(value)} is no whole number from {least} to {most}; give one")
    return number


def seed_of(value):
    return whole_of("seed", value, 0, 2**64 - 1)


def seconds_of(what, value):
    """A float: finite and above 0."""
    if not isinstance(value, _numbers.Real) or isinstance(value, bool) or not 0 < value < _math.inf:
        raise Failure(f"{what}: {shown(value)} is no time above 0; give seconds as a number")
    return float(value)


def flag_of(what, value):
    """True or False."""
    if type(value).__name__ != "bool_" and not (isinstance(value, int) and value in (0, 1)):
        raise Failure(f"{what}: {shown(value)} is neither True nor False; give one of them")
    return bool(value)


def items_of(what, value):
    """Names and values of a dict; none for None."""
    if value is None:
        return []
    if not hasattr(value, "items"):
        raise Failure(f"{what}: {shown(value)} is no dict; give names and their values")
    return list(value.items())


def path_of(what, path):
    """As text. ValueError, as of open(), for what would be cut at a NUL or cannot be written down as UTF-8."""
    try:
        return line_of(what, _os.fsdecode(path))
    except TypeError:
        raise Failure(f"{what}: {shown(path)} is no path; give a text") from None


def line_of(what, text):
    """The text, if it is whole as a C string of UTF-8; else ValueError, in which `what` is what it is called."""
    if not isinstance(text, str):
        raise Failure(f"{what}: {shown(text)} is no text; give one")
    if "\0" in text:
        raise ValueError(f"{what} has a NUL character: {text!r}; leave it out")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{what} is not UTF-8: {text!r}; write it as UTF-8") from None
    return text


def text_of(value):
    """True: "true"; 0.1: "0.1"; [1, 2]: "{1, 2}"; texts as they are: "1mm", "H7/g6". None: it has no such text."""
    if hasattr(value, "tolist"):  # NumPy's numbers and arrays are Python's
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        texts = [text_of(v) for v in value]
        return None if None in texts else "{" + ", ".join(texts) + "}"
    if isinstance(value, (int, float)):
        return repr(value)
    return value if isinstance(value, str) else None


def value_of(key, value):
    text = text_of(value)
    if text is None:
        raise Failure(f"{key}: {shown(value)} is no value of a parameter; give a number, a text, True, False or a list of them")
    return line_of(key, text)


def settings(parameters, more):
    """Name and text of every parameter, of a dict and of keywords."""
    parameters = dict(items_of("parameters", parameters))
    for key in more:
        if key in parameters:
            raise Failure(f"{key}: is given twice, in the dict and by name")
    return [(line_of("a parameter's name", key), value_of(key, value)) for key, value in {**parameters, **more}.items()]


def list_of(key, values):
    """The texts of several values, with commas between them; of one value, its own."""
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        values = [values]
    texts = [value_of(key, value) for value in values]
    for text in texts:
        if not _ONE_VALUE.fullmatch(text):
            raise Failure(f"{key}: {text!r}: a comma parts values; quote the text: {chr(34) + text + chr(34)!r}")
    return ",".join(texts)
