"""Python's values as --set and --vary take them."""
import re as _re

from ._verisim import Failure

_ONE_VALUE = _re.compile(r"""(?:[^,"'(\[{]|"[^"]*"|'[^']*'|[(\[{].*[)\]}])*""", _re.DOTALL)


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
    return [(key, text_of(value)) for key, value in {**parameters, **more}.items()]


def list_of(key, values):
    """The texts of several values, with commas between them."""
    texts = [text_of(value) for value in ([values] if isinstance(values, str) else values)]
    for text in texts:
        if not _ONE_VALUE.fullmatch(text):
            raise Failure(f"{key}: {text!r}: a comma parts values; quote the text: {chr(34) + text + chr(34)!r}")
    return ",".join(texts)
