"""What is named where a file is wanted and is none, or none that can be read: every reader, every such thing.

Each ends at once, with one line that says what it is (INTERFACES section 1). To open a FIFO would wait for ever, to read
/dev/zero never ends, and a file of holes is terabytes of nothing.
"""
import os
import socket
import time
import unittest

import h5py
import numpy as np

from program import ProgramTest

AT_ONCE = 10  # s; a program under a sanitizer starts slowly


class Readers(ProgramTest):
    """`commands(name)`: every way to have the file `name` read, with the ending that each wants."""

    def scripts(self):
        box = 'addObject{ name = "it", fixed = true, voxelsize = 0.01, %s }\n'
        self.write("model.lua", box % 'Model "thing.stl"')
        self.write("dofile.lua", 'dofile("thing.lua")\n')
        self.write("require.lua", 'require "thing"\n')
        self.write("runfile.lua", 'runfile "thing"\n')
        self.write("trace.lua", 'addDevice(Devices.Replay{ name = "r", trace = "thing.csv" })\n')
        self.write("buffer.lua", 'runbuf:addFile("thing.lua")\n')
        self.write("bound.lua", 'addDevice(Devices.Sensable.PhantomOmni{ name = "omni" })\n')
        self.write("good.csv", "# verisim-trace 1\n# kind: wii\n# rate_hz: 100\n# source: x\n"
                   "t,battery,gx,gy,gz,x1,y1,s1,x2,y2,s2,x3,y3,s3,x4,y4,s4\n0,1,0,0,1" + ",-1" * 12 + "\n")

    READERS = [
        ("thing.lua", ["run", "thing.lua"]),
        ("thing.lua", ["run", "dofile.lua"]), ("thing.lua", ["run", "require.lua"]),
        ("thing.lua", ["run", "runfile.lua"]), ("thing.lua", ["run", "buffer.lua"]),
        ("thing.stl", ["run", "model.lua"]), ("thing.csv", ["run", "trace.lua"]),
        ("thing.csv", ["run", "bound.lua", "--bind", "omni=thing.csv"]),
        ("thing.h5", ["replay", "thing.h5"]), ("thing.h5", ["replay", "thing.h5", "--verify"]),
        ("thing.h5", ["recover", "thing.h5"]),
        ("thing.stl", ["inspect", "thing.stl"]), ("thing.step", ["inspect", "thing.step"]),
        ("thing.csv", ["trace", "info", "thing.csv"]), ("thing.csv", ["trace", "convert", "thing.csv", "-o", "o.csv"]),
        ("thing.csv", ["trace", "convert", "thing.csv", "-o", "o.csv", "--map", "px=1"]),
        ("thing.csv", ["wii", "track", "thing.csv", "-o", "o.csv"]),
        ("thing.csv", ["wii", "track", "good.csv", "--second", "thing.csv", "--tracker", "stereo", "-o", "o.csv"]),
        ("thing.csv", ["wii", "validate", "--motion", "thing.csv"]), ("thing.csv", ["wii", "place", "--heads", "thing.csv"]),
        ("thing.csv", ["wii", "serve", "--trace", "thing.csv", "--port", "0"]),
    ]

    def every_reader_refuses(self, make, words):
        self.scripts()
        for name, command in self.READERS:
            with self.subTest(command=command):
                make(self.path(name))
                begin = time.monotonic()
                error = self.refuse(3, words, *command, timeout=60)
                self.assertLess(time.monotonic() - begin, AT_ONCE)
                self.assertIn("thing", error)
                self.assertFalse(os.path.exists(self.path("o.csv")))
                if os.path.isdir(self.path(name)) and not os.path.islink(self.path(name)):
                    os.rmdir(self.path(name))
                else:
                    os.remove(self.path(name))

    def test_fifos(self):
        self.every_reader_refuses(os.mkfifo, "is a FIFO")

    def test_links_to_a_fifo(self):
        os.mkfifo(self.path("fifo"))
        self.every_reader_refuses(lambda path: os.symlink("fifo", path), "is a FIFO")

    def test_sockets(self):
        def make(path):
            with socket.socket(socket.AF_UNIX) as s:
                s.bind(path)
        self.every_reader_refuses(make, "is a socket")

    def test_terabytes_of_holes(self):
        def make(path):
            with open(path, "wb") as f:
                if path.endswith(".h5"):
                    f.write(b"\x89HDF\r\n\x1a\n\3\x08\x08\0" + bytes(100))
                f.truncate(1 << 40)
        self.every_reader_refuses(make, "1099511627776 bytes")

    def test_links_in_a_circle(self):
        self.every_reader_refuses(lambda path: os.symlink(os.path.basename(path), path), "")

    def test_files_that_may_not_be_read(self):
        """Of the system's: no permission gives root what they hold, and their size is not what they have."""
        self.refuse(3, "mem", "run", "/proc/self/mem")
        self.refuse(3, "kmsg", "run", "/proc/kmsg", timeout=20)

    def test_folders_and_devices_where_the_command_line_names_them(self):
        for place, kind in ((".", "is a folder"), ("/", "is a folder"), ("/dev/zero", "is a device"),
                            ("/dev/full", "is a device"), ("/dev/tty", "is a device")):
            for command in (["run"], ["replay"], ["recover"], ["trace", "info"], ["wii", "place", "--heads"]):
                with self.subTest(command=command, place=place):
                    self.refuse(3, kind, *command, place, timeout=60)

    def test_links_to_devices(self):
        """From a scenario they lead out of its folder; the command line may name them."""
        os.symlink("/dev/zero", self.path("thing.csv"))
        self.scripts()
        self.refuse(3, "is a device", "trace", "info", "thing.csv", timeout=60)
        self.refuse(3, "is a device", "run", "bound.lua", "--bind", "omni=thing.csv", timeout=60)
        self.refuse(3, "outside the scenario's folder", "run", "trace.lua", timeout=60)


class CraftedRunFiles(ProgramTest):
    """HDF5 as a stranger may have made it: groups in circles, that unfold without end, or that lead out of the file."""

    def setUp(self):
        super().setUp()
        self.run_file, _ = self.small_run()

    def refuse_crafted(self, words, craft):
        crafted = self.path("crafted.h5")
        with open(self.run_file, "rb") as f:
            self.write("crafted.h5", f.read())
        with h5py.File(crafted, "r+") as f:
            craft(f)
        for command in (["replay", crafted], ["recover", crafted]):
            begin = time.monotonic()
            self.refuse(3, ["crafted.h5", "damaged", words], *command, timeout=60)
            self.assertLess(time.monotonic() - begin, AT_ONCE)

    def test_a_group_that_is_its_own_child(self):
        for place in ("inputs/models/0/0", "inputs/models", "inputs", "state", "state/body", "summary", "/"):
            with self.subTest(place=place):
                def craft(f, place=place):
                    f[place]["round"] = f[place]
                self.refuse_crafted("same object", craft)

    def test_a_group_below_itself_further_down(self):
        def craft(f):
            f["inputs/models/0/0/a/b/c"] = f["inputs"]
        self.refuse_crafted("same object", craft)

    def test_groups_that_unfold(self):
        def craft(f):
            below = f.create_group("inputs/models/0/0/g0")
            for _ in range(40):
                group = below.create_group("g")
                below["h"] = group
                below = group
        self.refuse_crafted("same object", craft)

    def test_a_dataset_that_counts_many_times(self):
        def craft(f):
            table = f["inputs/files/0"]
            for i in range(1000):
                f[f"inputs/models/0/0/t{i}"] = table
        self.refuse_crafted("same object", craft)

    def test_groups_too_deep(self):
        def craft(f):
            f.create_group("inputs/models/0/0/" + "g/" * 5000)
        self.refuse_crafted("deep", craft)

    def test_links_of_other_kinds(self):
        def soft(f):
            f["inputs/models/0/0/soft"] = h5py.SoftLink("/inputs")

        def external(f):
            f["state/more"] = h5py.ExternalLink("/dev/zero", "/")
        self.refuse_crafted("link", soft)
        self.refuse_crafted("link", external)

    def test_values_in_other_files(self):
        self.write("secret", b"s" * 100)

        def external(f):
            f.create_dataset("inputs/models/0/0/out", (100,), "u1", external=[(self.path("secret"), 0, 100)])

        def virtual(f):
            layout = h5py.VirtualLayout((3,), "f8")
            layout[:] = h5py.VirtualSource(self.run_file, "state/time", (300,))[:3]
            f.create_virtual_dataset("inputs/models/0/0/out", layout)
        self.refuse_crafted("another file", external)
        self.refuse_crafted("another file", virtual)

    def test_traces_keep_their_values_to_themselves_too(self):
        def trace(craft):
            with h5py.File(self.path("t.h5"), "w") as f:
                f.attrs.update({"kind": "haptic", "rate_hz": 1000.0, "source": "x"})
                for name in ("t", "px", "py", "pz", "qx", "qy", "qz", "qw"):
                    f[name] = np.arange(2) * 1e-3 if name in ("t", "qw") else np.zeros(2)
                f["qw"][:] = 1
                craft(f)
            return self.path("t.h5")
        self.succeed("trace", "info", trace(lambda f: None))
        self.succeed("trace", "info", trace(lambda f: f.__setitem__("alias", h5py.SoftLink("/px"))))
        self.refuse(3, "link", "trace", "info", trace(lambda f: f.__setitem__("fx", h5py.ExternalLink("a.h5", "/"))))
        self.refuse(3, "another file", "trace", "info", trace(
            lambda f: f.create_dataset("fx", (2,), "f8", external=[("/etc/hostname", 0, 16)])))
        self.refuse(3, "same object", "trace", "info", trace(lambda f: f.__setitem__("round", f["/"])))


if __name__ == "__main__":
    unittest.main()
