"""Where the pictures of a run come from: sequences, videos, the synthetic scene."""

import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import time
import unittest

import program
from avi import avi
from program import HEIGHT, PRELOADED, SMALL, WIDTH, ProgramTest, noise, pgm, run


class SourceTest(ProgramTest):
    """Pairs of noise; what a run of each one alone gives."""

    def frames_of(self, *source, frames=None):
        """The disparities of each frame of a run, by number."""
        out = self.folder / "frames_of"
        shutil.rmtree(out, ignore_errors=True)
        count = [] if frames is None else ["--frames", frames]
        self.succeeds(self.run_with(*source, *count, "--save-frames", "--out", out))
        return [path.read_bytes() for path in sorted((out / "frames").iterdir())]

    def pair_alone(self, number):
        """The disparities of one pair."""
        left = self.file("alone_left.pgm", pgm(WIDTH, HEIGHT, self.side(number, "left")))
        right = self.file("alone_right.pgm", pgm(WIDTH, HEIGHT, self.side(number, "right")))
        out = self.folder / "alone"
        self.succeeds(self.run_small("--out", out, left=left, right=right))
        return (out / "disparity.png").read_bytes()

    def run_again(self):
        """What a run with the options in config.yaml and run.json gives."""
        told = json.loads((self.out / "run.json").read_text())
        options = ["--source", told["source"], "--fidelity", told["fidelity"], "--frames", told["frames"]]
        for name in ("left", "right", "truth", "sequence"):
            if name in told:
                options += [f"--{name}", told[name]["path"]]
        if "video" in told:
            options += ["--video", *(file["path"] for file in told["video"]), "--video-layout", told["video_layout"]]
        if "synthetic" in told:
            options += ["--synthetic", told["synthetic"]]
        if told.get("save_frames"):
            options += ["--save-frames"]
        again = self.folder / "again"
        self.succeeds(run("run", self.out / "config.yaml", *options, "--out", again))
        return self.result(again)


class Sequence(SourceTest):
    def refused_sequence(self, folder, *texts):
        process = self.run_with("--sequence", folder, "--out", self.out)
        self.refused_in_one_line(process, "stereotlm: error: --sequence '", *texts)
        self.assertFalse(self.out.exists())

    def test_shows_each_pair_once_unless_told_otherwise(self):
        alone = [self.pair_alone(number) for number in range(6)]
        folder = self.sequence(6)
        self.assertEqual(self.frames_of("--sequence", folder), alone)
        self.assertEqual(self.frames_of("--sequence", folder, frames=2), alone[:2])
        self.assertEqual(self.frames_of("--sequence", folder, frames=15), alone + alone + alone[:3])

    def test_the_result_is_of_the_last_frame(self):
        self.succeeds(self.run_with("--sequence", self.sequence(3), "--frames", "5", "--out", self.out))
        self.assertEqual((self.out / "disparity.png").read_bytes(), self.pair_alone(1))

    def test_is_in_the_order_of_names_byte_by_byte(self):
        folder = self.folder / "names"
        folder.mkdir()
        for number, name in enumerate(["", "0", "10", "9", "B", "a"]):
            for side in ("left", "right"):
                (folder / f"{side}_{name}.png").write_bytes(pgm(WIDTH, HEIGHT, self.side(number, side)))
        self.assertEqual(self.frames_of("--sequence", folder), [self.pair_alone(number) for number in range(6)])

    def test_other_files_in_the_folder_do_not_matter(self):
        folder = self.sequence(2)
        for name in ("notes.txt", "left_.jpg", "left_000.PNG", "xleft_000.png", "left.png", "right_000.png~"):
            (folder / name).write_text("x")
        (folder / "frames").mkdir()
        self.assertEqual(len(self.frames_of("--sequence", folder)), 2)

    def test_can_be_run_again(self):
        folder = self.sequence(3)
        arguments = ["--sequence", "sequence", "--frames", "5", "--save-frames", "--out", self.out]
        self.succeeds(run("run", "fpl2003", *SMALL, *PRELOADED, *arguments, cwd=self.folder))
        told = json.loads((self.out / "run.json").read_text())
        self.assertEqual(os.path.realpath(told["sequence"]["path"]), os.path.realpath(folder))
        self.assertTrue(os.path.isabs(told["sequence"]["path"]))
        names = [f"{side}_{number:03}.png" for number in range(3) for side in ("left", "right")]
        sums = [hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names]
        self.assertEqual(told["sequence"]["files"], [{"name": n, "sha256": s} for n, s in zip(names, sums)])
        self.assertEqual(told["frames"], 5)
        self.assertEqual(self.run_again(), self.result())

    def test_says_how_many_pictures_were_colour(self):
        folder = self.sequence(3)
        for name in ("left_001.png", "right_002.png"):
            (folder / name).write_bytes(b"P6\n%d %d\n255\n" % (WIDTH, HEIGHT) + noise(3 * WIDTH, HEIGHT, 1))
        process = self.run_with("--sequence", folder)
        self.succeeds(process)
        self.assertEqual(
            process.stderr,
            f"stereotlm: note: --sequence '{folder}': 2 of 6 pictures: colour, converted to grey\n",
        )

    def test_refuses_what_is_no_folder(self):
        rule = ": a sequence must be a readable folder"
        self.refused_sequence(self.folder / "none", f"none': No such file or directory{rule}")
        self.refused_sequence(self.left, f"left.pgm': Not a directory{rule}")
        self.refused_sequence("", f"'': No such file or directory{rule}")

    @unittest.skipIf(os.geteuid() == 0, "permissions do not bind root")
    def test_refuses_a_folder_that_cannot_be_read(self):
        folder = self.sequence(1)
        folder.chmod(0)
        self.addCleanup(folder.chmod, 0o700)
        self.refused_sequence(folder, "Permission denied: a sequence must be a readable folder")

    def test_refuses_a_folder_without_pictures(self):
        folder = self.sequence(0)
        text = f"--sequence '{folder}': no pictures: a sequence must have pairs left_*.png and right_*.png"
        self.refused_sequence(folder, text)
        (folder / "left.png").write_bytes(self.left.read_bytes())
        self.refused_sequence(folder, text)

    def test_refuses_a_picture_without_partner(self):
        folder = self.sequence(4)
        (folder / "right_002.png").unlink()
        self.refused_sequence(
            folder, f"--sequence '{folder}/left_002.png': without partner: there must be a 'right_002.png'"
        )
        (folder / "right_001.png").rename(folder / "right_01.png")
        self.refused_sequence(
            folder, f"--sequence '{folder}/left_001.png': without partner, and 1 more: there must be a 'right_001.png'"
        )
        for number in (1, 2):
            (folder / f"left_00{number}.png").unlink()
        self.refused_sequence(
            folder, f"--sequence '{folder}/right_01.png': without partner: there must be a 'left_01.png'"
        )

    def test_refuses_the_first_picture_that_cannot_be_used(self):
        folder = self.sequence(3)
        (folder / "left_002.png").write_bytes(b"")
        self.refused_sequence(folder, f"--sequence '{folder}/left_002.png': an empty file: a picture must be")
        (folder / "right_001.png").write_bytes(pgm(WIDTH, HEIGHT + 1, bytes(WIDTH * (HEIGHT + 1))))
        self.refused_sequence(
            folder,
            f"--sequence '{folder}/right_001.png': {WIDTH}x{HEIGHT + 1} pixels: "
            f"must be as large as the board's images, {WIDTH}x{HEIGHT}",
        )
        (folder / "left_000.png").unlink()
        (folder / "left_000.png").mkdir()
        self.refused_sequence(folder, f"--sequence '{folder}/left_000.png': a directory: ")

    def test_refuses_a_name_that_run_json_cannot_hold(self):
        folder = self.sequence(1)
        for side in (b"left_", b"right_"):
            strange = os.fsencode(folder) + b"/" + side + b"\xff.png"
            shutil.copy(self.left, strange)
        command = [program.PROGRAM, "run", "fpl2003", *SMALL, *PRELOADED, "--sequence", folder]
        process = subprocess.run(command, capture_output=True, timeout=60, check=False)
        self.assertEqual((process.returncode, process.stdout), (2, b""))
        self.assertRegex(process.stderr, rb"--sequence 'left_\xff.png': a path that is not UTF-8")

    def test_is_not_replaced_by_its_results(self):
        self.succeeds(self.run_with("--sequence", self.sequence(1), "--out", self.out))
        earlier = self.result()
        (self.out / "frames").mkdir()
        inside = self.sequence(2, "out/frames/sequence")
        lines = self.refused(self.run_with("--sequence", inside, "--out", self.out))
        self.assertEqual(len(lines), 1)
        self.assertIn(f"--sequence '{inside}/left_000.png': inside the result folder '{self.out}'", lines[0])
        shutil.rmtree(self.out / "frames")
        self.assertEqual(self.result(), earlier)

    def test_checking_it_can_be_interrupted_and_leaves_nothing(self):
        folder = self.folder / "long"
        folder.mkdir()
        picture = self.file("large.pgm", pgm(1024, 1024, bytes(1024 * 1024)))
        for number in range(2000):
            for side in ("left", "right"):
                (folder / f"{side}_{number:04}.png").symlink_to(picture)
        board = ["--set", "image.width=1024", "--set", "image.height=1024", "--set", "ssram.default.words=1048576"]
        command = ["run", "fpl2003", *PRELOADED, *board, "--sequence", folder, "--out", self.out]
        process = subprocess.Popen([program.PROGRAM] + [str(word) for word in command], stderr=subprocess.PIPE)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, errors), (-signal.SIGINT, b""))
        self.assertFalse(self.out.exists())

    def test_a_board_that_is_wrong_is_said_together_with_it(self):
        process = self.run_with("--sequence", self.folder / "none", "--set", "matcher.window=4")
        lines = self.refused(process, "--set matcher.window", "--sequence")
        self.assertEqual(len(lines), 2)


class Video(SourceTest):
    def video(self, name, length, *sides, below=False):
        """A video of the pictures of these sides, beside or below each other."""
        frames = []
        for number in range(length):
            pictures = [self.side(number, side) for side in sides]
            rows = [[p[y * WIDTH : (y + 1) * WIDTH] for y in range(HEIGHT)] for p in pictures]
            frames.append(b"".join(pictures) if below else b"".join(b"".join(row) for row in zip(*rows)))
        across, down = (1, len(sides)) if below else (len(sides), 1)
        return self.file(name, avi(across * WIDTH, down * HEIGHT, frames))

    def each_layout(self, length):
        yield ["--video", self.video("l.avi", length, "left"), self.video("r.avi", length, "right")], "two"
        yield ["--video", self.video("s.avi", length, "left", "right")], "side_by_side"
        yield ["--video", self.video("t.avi", length, "left", "right", below=True)], "top_bottom"

    def refused_video(self, arguments, *texts):
        process = self.run_with(*arguments, "--out", self.out)
        self.refused_in_one_line(process, "stereotlm: error: --video '", *texts)
        self.assertFalse(self.out.exists())

    def test_shows_each_pair_once_unless_told_otherwise(self):
        alone = [self.pair_alone(number) for number in range(6)]
        for video, layout in self.each_layout(6):
            video += ["--video-layout", layout]
            self.assertEqual(self.frames_of(*video), alone, layout)
            self.assertEqual(self.frames_of(*video, frames=2), alone[:2], layout)
            self.assertEqual(self.frames_of(*video, frames=15), alone + alone + alone[:3], layout)

    def test_keeps_quiet(self):
        process = self.run_with("--video", self.video("s.avi", 2, "left", "right"), "--video-layout", "side_by_side")
        self.succeeds(process)
        self.assertEqual(process.stderr, "")

    def test_can_be_run_again(self):
        for video, layout in self.each_layout(3):
            self.succeeds(self.run_with(*video, "--video-layout", layout, "--frames", "5", "--save-frames", "--out", self.out))
            told = json.loads((self.out / "run.json").read_text())
            self.assertEqual([file["path"] for file in told["video"]], [str(path) for path in video[1:]])
            for file, path in zip(told["video"], video[1:]):
                self.assertEqual(file["sha256"], hashlib.sha256(path.read_bytes()).hexdigest())
            self.assertEqual(told["video_layout"], layout)
            self.assertEqual(self.run_again(), self.result())

    def test_refuses_frames_of_another_size(self):
        one, both = self.video("l.avi", 1, "left"), self.video("s.avi", 1, "left", "right")
        wide, high = 2 * WIDTH, 2 * HEIGHT
        self.refused_video(
            ["--video", one, both, "--video-layout", "two"],
            f"s.avi': {wide}x{HEIGHT} pixels: must be as large as the board's images, {WIDTH}x{HEIGHT}",
        )
        rule = f"must be as large as two of the board's images, {WIDTH}x{HEIGHT}, with --video-layout"
        self.refused_video(
            ["--video", one, "--video-layout", "side_by_side"],
            f"l.avi': {WIDTH}x{HEIGHT} pixels: {rule} side_by_side: {wide}x{HEIGHT}",
        )
        self.refused_video(
            ["--video", both, "--video-layout", "top_bottom"],
            f"s.avi': {wide}x{HEIGHT} pixels: {rule} top_bottom: {WIDTH}x{high}",
        )

    def test_refuses_two_of_different_length(self):
        left, right = self.video("l.avi", 3, "left"), self.video("r.avi", 4, "right")
        self.refused_video(
            ["--video", left, right, "--video-layout", "two"],
            f"--video '{right}': 4 frames: must have as many as '{left}', 3",
        )

    def test_refuses_what_cannot_be_decoded(self):
        layout = ["--video-layout", "side_by_side"]
        self.refused_video(["--video", self.folder / "none.avi", *layout], "none.avi': no such file: ")
        self.refused_video(["--video", self.folder, *layout], "': a directory: a video must be a readable regular file")
        text = self.file("text.avi", b"text\n" * 1000)
        self.refused_video(["--video", text, *layout], "text.avi': no video: a video must be an AVI")
        none = self.file("empty.avi", avi(2 * WIDTH, HEIGHT, []))
        self.refused_video(["--video", none, *layout], "empty.avi': no frame can be decoded: ")

    def test_says_that_its_header_promises_more(self):
        video = self.video("s.avi", 4, "left", "right")
        video.write_bytes(video.read_bytes()[: -7 * WIDTH * HEIGHT])
        out = ["--save-frames", "--out", self.out]
        process = self.run_with("--video", video, "--video-layout", "side_by_side", *out)
        self.succeeds(process)
        self.assertEqual(
            process.stderr, f"stereotlm: note: --video '{video}': 2 frames can be decoded; its header says 4\n"
        )
        self.assertEqual(sorted(os.listdir(self.out / "frames")), ["000000.png", "000001.png"])

    def test_is_not_replaced_by_its_results(self):
        self.succeeds(self.run_small("--out", self.out))
        (self.out / "frames").mkdir()
        video = self.video("out/frames/000000.png", 1, "left", "right")
        process = self.run_with("--video", video, "--video-layout", "side_by_side", "--out", self.out)
        self.refused_in_one_line(process, f"--video '{video}': inside the result folder")
        self.assertTrue(video.exists())


class Synthetic(SourceTest):
    def test_moves_and_is_the_same_when_run_again(self):
        frames = self.frames_of("--synthetic", "1", frames=4)
        self.assertEqual(len(set(frames)), 4)
        self.assertEqual(self.frames_of("--synthetic", "1", frames=4), frames)
        self.assertNotEqual(self.frames_of("--synthetic", "2", frames=1), frames[:1])

    def test_one_frame_unless_told_otherwise(self):
        self.assertEqual(len(self.frames_of("--synthetic", "1")), 1)

    def test_takes_every_seed(self):
        self.succeeds(self.run_with("--synthetic", "0"))
        self.succeeds(self.run_with("--synthetic", "18446744073709551615"))

    def test_can_be_run_again(self):
        self.succeeds(self.run_with("--synthetic", "18446744073709551615", "--frames", "2", "--out", self.out))
        told = json.loads((self.out / "run.json").read_text())
        self.assertEqual(told["synthetic"], 18446744073709551615)
        self.assertEqual(self.run_again(), self.result())

    def test_prints_its_accuracy_and_keeps_it_out_of_the_figures(self):
        board = ["--set", "image.width=160", "--set", "image.height=120", "--set", "matcher.fetch=line_buffer"]
        source = ["--synthetic", "3", "--frames", "2", "--out", self.out]
        table = self.succeeds(run("run", "fpl2003", *PRELOADED, *board, *source))
        found = re.search(r"off by more than 1: (\S+) %, by more than 2: \S+ %, answered: (\S+) %", table)
        self.assertLess(float(found[1]), 5)
        self.assertGreater(float(found[2]), 75)
        self.assertNotIn("accuracy", self.stats())


class Truth(SourceTest):
    def test_is_of_the_pair_that_the_last_frame_shows(self):
        folder = self.sequence(3)
        for frames, last in ((["--frames", "2"], 1), ([], 2), (["--frames", "4"], 0)):
            self.succeeds(self.run_with("--sequence", folder, *frames, "--truth", self.left, "--out", self.out))
            of_sequence = self.stats()["accuracy"]
            left = self.file("l.pgm", pgm(WIDTH, HEIGHT, self.side(last, "left")))
            right = self.file("r.pgm", pgm(WIDTH, HEIGHT, self.side(last, "right")))
            alone = self.folder / "alone"
            self.succeeds(run(*self.run_arguments("--truth", self.left, "--out", alone, left=left, right=right)))
            self.assertEqual(json.loads((alone / "stats.json").read_text())["accuracy"], of_sequence)

    def test_goes_with_a_video(self):
        frame = self.side(0, "left") + self.side(0, "right")
        video = self.file("t.avi", avi(WIDTH, 2 * HEIGHT, [frame, frame]))
        process = self.run_with("--video", video, "--video-layout", "top_bottom", "--truth", self.left, "--out", self.out)
        self.succeeds(process)
        self.assertIn("accuracy", self.stats())


class Memory(SourceTest):
    WIDE, HIGH = 128, 96

    def peak(self, *source):
        """The largest resident set of a run, in kB."""
        board = ["--set", f"image.width={self.WIDE}", "--set", f"image.height={self.HIGH}"]
        board += ["--set", "matcher.fetch=line_buffer", "--set", "matcher.disparities=4", "--set", "matcher.filter=none"]
        command = [program.PROGRAM, "run", "fpl2003", *PRELOADED, *board, *source]
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return used.ru_maxrss

    def flat(self, short, long, kept=0):
        """A thousand frames need hardly more than thirty, but for `kept` kB: their pictures alone would take 24 MB."""
        if program.has_address_sanitizer():
            self.skipTest("the address sanitizer keeps what is freed for a while")
        before = self.peak(*short)
        after = self.peak(*long)
        print(f"peak memory: {before} kB, 1000 frames: {after} kB")
        self.assertLess(after - before, kept + 12000)

    def test_is_flat_over_a_thousand_pairs_of_a_sequence(self):
        folders = []
        for length in (30, 1000):
            folders.append(self.folder / f"{length}")
            folders[-1].mkdir()
            for number in range(length):
                for side in ("left", "right"):
                    path = folders[-1] / f"{side}_{number:04}.png"
                    path.write_bytes(pgm(self.WIDE, self.HIGH, os.urandom(self.WIDE * self.HIGH)))
        # All decoded pictures, since they are less than 128 MB.
        pictures = 2 * (1000 - 30) * self.WIDE * self.HIGH // 1000
        self.flat(["--sequence", folders[0]], ["--sequence", folders[1]], kept=pictures)
        self.flat(["--sequence", folders[0]], ["--sequence", folders[0], "--frames", "1000"])

    def test_is_flat_over_a_thousand_frames_of_a_video(self):
        frames = [noise(2 * self.WIDE, self.HIGH, seed) for seed in range(30)]
        video = self.file("v.avi", avi(2 * self.WIDE, self.HIGH, frames))
        source = ["--video", video, "--video-layout", "side_by_side"]
        self.flat(source, source + ["--frames", "1000"])

    def test_is_flat_over_a_thousand_frames_of_the_synthetic_scene(self):
        self.flat(["--synthetic", "1", "--frames", "30"], ["--synthetic", "1", "--frames", "1000"])


if __name__ == "__main__":
    program.main()
