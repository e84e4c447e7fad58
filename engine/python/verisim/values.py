"""Python's values as --set and --vary take them, and its paths as a run file and messages hold them."""
import os as _os
import re as _re

from ._verisim import Failure

_ONE_VALUE = _re.compile(r"""(?:[^,"'(\[{]|"[^"]*"|'[^']*'|[(\[{].*[)\]}])*""", _re.DOTALL)


def path_of(what, path):
    """As text. ValueError, as of open(), for what would be cut at a NUL or cannot be written down as UTF-8."""
    return line_of(what, _os.fsdecode(path))


def line_of(what, text):
    """The text, if it is whole as a C string of UTF-8; else ValueError, in which `what` is what it is called."""
    if "\0" in text:
        raise ValueError(f"{what} has a NUL character: {text!r}; leave it out")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{what} is not UTF-8: {text!r}; write it as UTF-8") from None
    return text


def text_of(value):
    """True: "true"; 0.1: "0.1"; [1, 2]: "{1, 2}"; texts as they are: "1mm", "H7/g6"."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "{" + ", ".join(text_of(v) for v in value) + "}"
    if isinstance(value, str):
        return value
    return repr(value.item() if hasattr(value, "item") else value)  # NumPy's numbers are Python's


def settings(parameters, more):
    """Name and text of every parameter, of a dict and of keywords."""
    parameters = dict(parameters or {})
    for key in more:
        if key in parameters:
            raise Failure(f"{key}: is given twice, in the dict and by name")
    return [(line_of("a parameter's name", key), line_of(key, text_of(value)))
            for key, value in {**parameters, **more}.items()]


def list_of(key, values):
    """The texts of several values, with commas between them."""
    texts = [line_of(key, text_of(value)) for value in ([values] if isinstance(values, str) else values)]
    for text in texts:
        if not _ONE_VALUE.fullmatch(text):
            raise Failure(f"{key}: {text!r}: a comma parts values; quote the text: {chr(34) + text + chr(34)!r}")
    return ",".join(texts)
