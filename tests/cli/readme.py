"""README's blocks that cli.readme compares: where they are, and written anew by what the program prints now.

cmake --build build --target update_readme, in the commit that changes what they show (three minutes).
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

BATCH, TRADE_OFF = "## I run batches", "## I trade speed for accuracy"
LEDGERS = re.compile(r"(^passivity ledgers, J\n)(.*?)(  …$)", re.M | re.S)


def shown(text, heading):
    """The first block below a heading: its command and what that prints, a line each."""
    return text.split(heading)[1].split("```")[1].strip().splitlines()


def command(text, heading, source, folder):
    """The words of a block's command, to be run anywhere, with its output in a folder."""
    words = shown(text, heading)[0].removeprefix("$ build/verisim ").split()
    words[words.index("-o") + 1] = folder
    return [os.path.join(source, w) if w.startswith("scenarios/") else w for w in words]


def with_block(text, heading, lines):
    """The text with other lines below a block's command."""
    old = shown(text, heading)
    return text.replace("\n".join(old), "\n".join(old[:1] + lines))


def with_ledgers(text, printed):
    """The text with the rows of the scenarios that it shows; a reason is cut where it begins to count."""
    rows = {line.split()[0]: line for line in printed if line.split()}
    head, *old = LEDGERS.search(text)[2].splitlines()
    lines = [re.sub(r" gave .*", " gave… ", rows[line.split()[0]]) for line in old]
    head = next(line for line in printed if line.split() == head.split())
    return LEDGERS.sub(lambda m: m[1] + "\n".join([head, *lines]) + "\n" + m[3], text)


def update(verisim, source):
    path = os.path.join(source, "README.md")
    with open(path, encoding="utf-8") as f:
        text = f.read()
    with tempfile.TemporaryDirectory() as folder:
        def printed(*words):
            return subprocess.run([verisim, *words], stdout=subprocess.PIPE, text=True, check=True).stdout.rstrip().splitlines()

        for heading, name in ((BATCH, "pins"), (TRADE_OFF, "trade")):
            out = os.path.join(folder, name)
            lines = printed(*command(text, heading, source, out))
            text = with_block(text, heading, [line.replace(out, "runs/" + name) for line in lines])
        shutil.copy(os.path.join(folder, "trade", "tradeoff.svg"), os.path.join(source, "engine", "tradeoff", "peg_in_hole.svg"))
        text = with_ledgers(text, printed("stability", "--only", "ledgers"))
    with open(path, "w", encoding="utf-8") as f:
        f.write(text)


if __name__ == "__main__":
    update(*sys.argv[1:])
