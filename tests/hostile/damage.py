"""Seeded damage: the same file for the same seed, on every machine."""
import re

NUMBERS = ["0", "-0", "-1", "1e308", "-1e308", "1e-320", "1e999", "nan", "inf", "-inf", "99999999999999999999",
           "2147483648", "-9223372036854775808", "0x10", "1,5", "1e", "--1", "", "1.0.0", "$", "*", "1" * 400]
WORDS = [0, 1, 2, 7, 8, 0x7F, 0x80, 0xFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 1 << 40, (1 << 63) - 1, 1 << 63,
         (1 << 64) - 1]


def place(draw, content):
    return draw.randrange(len(content)) if content else 0


def stretch(draw, content, longest=4096):
    begin = place(draw, content)
    return begin, min(len(content), begin + 1 + int(longest ** draw.random()))


def flip_a_bit(draw, content):
    at = place(draw, content)
    return content[:at] + bytes([content[at] ^ 1 << draw.randrange(8)]) + content[at + 1:] if content else content


def other_byte(draw, content):
    at = place(draw, content)
    return content[:at] + bytes([draw.choice([0, 1, 0x7F, 0x80, 0xFF, draw.randrange(256)])]) + content[at + 1:]


def other_word(draw, content):
    """A count, a length or an address, in either order of bytes."""
    size = draw.choice([2, 4, 8])
    at = place(draw, content) // draw.choice([1, size]) * draw.choice([1, size])
    value = draw.choice(WORDS + [len(content), at]) & ((1 << 8 * size) - 1)
    return content[:at] + value.to_bytes(size, draw.choice(["little", "little", "big"])) + content[at + size:]


def cut_the_end(draw, content):
    return content[:place(draw, content)]


def take_out(draw, content):
    begin, end = stretch(draw, content)
    return content[:begin] + content[end:]


def blank(draw, content):
    begin, end = stretch(draw, content)
    return content[:begin] + bytes([draw.choice([0, 0xFF, 0x20])]) * (end - begin) + content[end:]


def copy_over(draw, content):
    """What stands at one place stands at another one too: tables that refer to each other in a circle."""
    begin, end = stretch(draw, content)
    at = place(draw, content)
    piece = content[begin:end]
    return content[:at] + piece + content[at + (len(piece) if draw.random() < 0.7 else 0):]


def put_in(draw, content):
    at = place(draw, content)
    return content[:at] + draw.randbytes(1 + int(300 ** draw.random())) + content[at:]


BYTES = [flip_a_bit, flip_a_bit, other_byte, other_byte, other_word, other_word, cut_the_end, take_out, blank, copy_over,
         put_in]


def other_number(draw, content):
    """Of a text, as of a mesh file or a trace."""
    found = list(re.finditer(rb"-?\d[\d.eE+-]*", content[:200_000]))
    if not found:
        return content
    number = draw.choice(found)
    return content[:number.start()] + draw.choice(NUMBERS).encode() + content[number.end():]


def other_reference(draw, content):
    """#12 becomes #34, as in STEP: another entity, itself, or one that is not there."""
    found = list(re.finditer(rb"#\d+", content))
    if len(found) < 2:
        return content
    old, new = draw.choice(found), draw.choice(found)
    text = new.group() if draw.random() < 0.9 else b"#999999"
    return content[:old.start()] + text + content[old.end():]


def lines_moved(draw, content):
    lines = content.split(b"\n")
    a, b = draw.randrange(len(lines)), draw.randrange(len(lines))
    what = draw.randrange(3)
    if what == 0:
        lines[a], lines[b] = lines[b], lines[a]
    elif what == 1:
        del lines[a:a + 1 + int(50 ** draw.random())]
    else:
        lines[a:a] = [lines[b]] * (1 + int(2000 ** draw.random()))
    return b"\n".join(lines)


def words_moved(draw, content):
    """Two words of the text change places: names of entities, columns, keys."""
    found = list(re.finditer(rb"[A-Za-z_]{2,}", content[:200_000]))
    if len(found) < 2:
        return content
    a, b = sorted(draw.sample(found, 2), key=lambda word: word.start())
    return content[:a.start()] + b.group() + content[a.end():b.start()] + a.group() + content[b.end():]


TEXT = [other_number, other_number, other_number, other_reference, other_reference, lines_moved, words_moved]


def damaged(draw, content):
    """One to eight changes, most often one."""
    is_text = b"\0" not in content[:1000]
    for _ in range(1 + int(8 * draw.random() ** 3)):
        content = draw.choice(TEXT + BYTES if is_text else BYTES)(draw, content)
    return content
