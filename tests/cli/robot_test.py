"""verisim robot: the serial protocol of the mobile robot as bytes on stdout and stdin."""
import json
import os
import subprocess
import unittest

from program import SHARED, VERISIM

GOLDEN = os.path.join(SHARED, "..", "reference", "robot_protocol", "golden.json")
HAS_GOLDEN = os.path.exists(GOLDEN)


def robot(*words, data=b""):
    return subprocess.run([VERISIM, "robot", *words], input=data, capture_output=True, timeout=60)


def messages_of(collection, data):
    done = robot("decode", collection, data=data)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()], done.stderr.decode()


class RobotTest(unittest.TestCase):
    @unittest.skipUnless(HAS_GOLDEN, f"{GOLDEN} is absent")
    def test_each_golden_message_is_written_and_read(self):
        with open(GOLDEN) as f:
            golden = json.load(f)["encode"]
        self.assertEqual(len(golden), 118)
        for entry in golden:
            with self.subTest(entry["name"]):
                words = [f"0x{bits}" for bits in entry["bits"]] if "bits" in entry else map(str, entry["args"])
                done = robot("encode", entry["collection"], entry["message"], "--", *words)
                self.assertEqual(done.stdout.hex(), entry["bytes"], done.stderr)
        for collection in {entry["collection"] for entry in golden}:
            own = [entry for entry in golden if entry["collection"] == collection]
            read, _ = messages_of(collection, bytes.fromhex("".join(entry["bytes"] for entry in own)))
            keys = ("message", "id", "args", "bits")
            self.assertEqual(read, [{key: entry[key] for key in keys if key in entry} for entry in own])

    def test_each_command_explains_itself_with_an_example(self):
        for command in ("decode", "encode"):
            self.assertIn(b"Example:", robot(command, "--help").stdout)

    def test_numbers_are_written_as_people_write_them(self):
        self.assertEqual(robot("encode", "ComputerToRobot", "XYFloatError", "1", "-1").stdout.hex(),
                         "010002" "0000803f" "000080bf" "030404")
        self.assertEqual(robot("encode", "ComputerToRobot", "StartControl").stdout.hex(), "010402030a04")
        data = robot("encode", "ComputerToRobot", "XYFloatError", "--", "nan", "-inf").stdout
        read, _ = messages_of("ComputerToRobot", data)
        self.assertEqual(read[0]["args"], [None, None])
        self.assertEqual(read[0]["bits"], ["7fc00000", "ff800000"])

    def test_what_is_skipped_is_said(self):
        frame = bytes.fromhex("010402030a04")
        read, said = messages_of("ComputerToRobot", b"rubbish" + frame + b"\x01\x01" + frame + b"\x01\x00\x02\x07")
        self.assertEqual([message["message"] for message in read], ["StartControl", "StartControl"])
        self.assertEqual(said, "note: 2 messages; bytes discarded: 9, of which 2 began no valid frame; "
                               "left at the end: 4\n")

    def test_wrong_usage_is_exit_2_and_says_what_to_write(self):
        for words, hint in ((("encode", "ComputerToRobot", "Fly"), "XYIntVelocities"),
                            (("encode", "ComputerToRobot", "XYIntVelocities", "1"), "one for each"),
                            (("encode", "ComputerToRobot", "XYIntVelocities", "1", "2", "3"), "leave out"),
                            (("encode", "ComputerToRobot", "XYIntVelocities", "1", "32768"), "-32768 to 32767"),
                            (("encode", "ComputerToRobot", "XYIntVelocities", "1", "2.5"), "whole number"),
                            (("encode", "ComputerToRobot", "XYFloatError", "1", "1e39"), "3.4e38"),
                            (("encode", "ComputerToRobot", "XYFloatError", "1", ""), "number"),
                            (("encode", "Nobody", "XYFloatError"), "ComputerToRobot"),
                            (("decode", "Nobody"), "ComputerToRobot"), (("decode",), "COLLECTION"), ((), "")):
            done = robot(*words)
            self.assertEqual((done.returncode, done.stdout), (2, b""), words)
            self.assertIn(hint, done.stderr.decode(), words)
            self.assertEqual(done.stderr.count(b"\n"), 1, done.stderr)

    def test_a_stdin_that_cannot_be_read_is_an_error(self):
        folder = os.open("/", os.O_RDONLY)
        done = subprocess.run([VERISIM, "robot", "decode", "BlueToGreen"], stdin=folder, capture_output=True, timeout=60)
        os.close(folder)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn(b"stdin", done.stderr)


if __name__ == "__main__":
    unittest.main()
