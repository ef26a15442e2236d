"""Where the pictures of a run come from: sequences, videos, the synthetic scene."""

import math
import os
import shutil
import struct
import subprocess

import program
from pictures import avi, noise, pgm, ppm
from program import HEIGHT, PRELOADED, SMALL, WIDTH, ProgramTest, of_plain_user, run, sets

ALONE = {}  # the disparities of pairs of a sequence, each run alone, by number


class SourceTest(ProgramTest):
    def frames_of(self, *source):
        """The disparities of each frame of a run that says nothing on standard error, by number."""
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.run_with(*source, "--save-frames", "--out", self.out)
        self.succeeds(process)
        self.assertEqual(process.stderr, "")
        return [path.read_bytes() for path in sorted((self.out / "frames").iterdir())]

    def alone(self, number):
        if number not in ALONE:
            pair = {side: self.file(f"{side}.pgm", self.picture(number, side)) for side in ("left", "right")}
            self.succeeds(self.run_small("--out", self.out, **pair))
            ALONE[number] = (self.out / "disparity.png").read_bytes()
        return ALONE[number]

    def picture(self, number, side):
        return pgm(WIDTH, HEIGHT, self.side(number, side))

    def shows_pairs(self, length, *source):
        """Each pair once, unless told otherwise."""
        expected = [self.alone(number) for number in range(length)]
        self.assertTrue(self.frames_of(*source) == expected)
        self.assertTrue(self.frames_of(*source, "--frames", "2") == expected[:2])
        self.assertTrue(self.frames_of(*source, "--frames", "15") == (15 * expected)[:15])
        self.assertEqual((self.out / "disparity.png").read_bytes(), expected[14 % length])

    def refused_source(self, source, *texts, **options):
        command = ["run", "fpl2003", *SMALL, *PRELOADED, *source, "--out", self.out]
        process = run(*command, **options)
        self.refused_in_one_line(process, f"stereotlm: error: {source[0]} '", *texts)
        self.assertFalse(self.out.exists())


class Sequence(SourceTest):
    def refused_sequence(self, folder, *texts, **options):
        self.refused_source(["--sequence", folder], *texts, **options)

    def test_pairs_are_shown_in_the_order_of_names_byte_by_byte(self):
        for number, name in enumerate(["", "0", "10", "9", "B", "a"]):
            for side in ("left", "right"):
                self.file(f"names/{side}_{name}.png", self.picture(number, side))
        for other in "notes.txt left_.jpg left_000.PNG xleft_000.png left.png right_000.png~".split():
            self.file(f"names/{other}", "x")
        (self.folder / "names" / "frames").mkdir()
        self.shows_pairs(6, "--sequence", self.folder / "names")

    def test_pictures_in_colour_are_counted(self):
        folder = self.sequence(3)
        for name in ("left_001.png", "right_002.png"):
            self.file(f"sequence/{name}", ppm(WIDTH, HEIGHT, noise(3 * WIDTH, HEIGHT, 1)))
        process = self.run_with("--sequence", folder)
        self.succeeds(process)
        note = f"--sequence '{folder}': 2 of 6 pictures: colour, converted to grey"
        self.assertEqual(process.stderr, f"stereotlm: note: {note}\n")

    def test_what_is_no_folder_of_pairs_is_refused(self):
        rule = ": a sequence must be a readable folder"
        self.refused_sequence(self.folder / "none", f"none': No such file or directory{rule}")
        self.refused_sequence(self.left, f"left.pgm': Not a directory{rule}")
        folder = self.sequence(0)
        shutil.copy(self.left, folder / "left.png")
        pairs = "no pictures: a sequence must have pairs left_*.png and right_*.png"
        self.refused_sequence(folder, f"--sequence '{folder}': {pairs}")
        folder.chmod(0)
        self.addCleanup(folder.chmod, 0o700)
        self.refused_sequence(folder, f"Permission denied{rule}", preexec_fn=of_plain_user)

    def test_a_picture_without_partner_is_refused(self):
        folder = self.sequence(4)

        def refused(picture, partner, more=""):
            text = f"'{folder}/{picture}': without partner{more}: there must be a '{partner}'"
            self.refused_sequence(folder, text)

        (folder / "right_002.png").unlink()
        refused("left_002.png", "right_002.png")
        (folder / "right_001.png").rename(folder / "right_01.png")
        refused("left_001.png", "right_001.png", ", and 1 more")
        for number in (1, 2):
            (folder / f"left_00{number}.png").unlink()
        refused("right_01.png", "left_01.png")


class Patterns(SourceTest):
    def sides(self, *names):
        """Patterns of pairs with these names."""
        for number, name in enumerate(names):
            for side in ("left", "right"):
                self.file(f"{side}/{name}", self.picture(number, side))
        return ["--left", self.folder / "left" / "*.png", "--right", self.folder / "right" / "*.png"]

    def test_pairs_are_shown_in_natural_order_and_recorded(self):
        self.shows_pairs(4, *self.sides("a8_1.png", "a09_1.png", "a10_1.png", "a11_1.png"))
        recorded = self.run_json()["right"]
        self.assertEqual([entry["path"] for entry in recorded],
                         [f"{self.folder}/right/a{number}_1.png" for number in ("8", "09", "10", "11")])
        self.succeeds(run("diff", self.out, self.out))  # repeats the run
        shutil.copy(self.left, self.folder / "right" / "a10_1.png")
        self.refused(run("diff", self.out, self.out), "right/a10_1.png': SHA-256")

    def test_what_is_left_out_is_said(self):
        sources = self.sides("x0.png", "x5.png", "x10.png", "x20.png")
        self.file("left/x15.PNG")
        left, right = self.folder / "left", self.folder / "right"
        gap = "{0}: '{1}/x20.png' follows '{1}/x10.png': numbers between them are missing"
        ending = f"--left '{left}/*.png': '{left}/x15.PNG' is left out: the case of the ending differs"
        gaps = [gap.format("--left", left), gap.format("--right", right)]

        def said():
            process = self.run_with(*sources)
            self.succeeds(process)
            return process.stderr.replace("stereotlm: note: ", "").splitlines()

        self.assertEqual(said(), [ending, *gaps])
        (right / "x20.png").rename(right / "x15.png")
        pairing = f"'{left}/x20.png' with '{right}/x15.png': do they belong together?"
        paired = f"pictures are paired in the order of their names, {pairing}"
        self.assertEqual(said(), [ending, gaps[0], paired])
        for pattern, *texts in (("*.jpg", "*.jpg': no such file"),
                                ("*.Png", "x0.png' and 3 more are left out"),
                                ("x1*.png", "4 left pictures", "2 right ones", "must be as many")):
            self.refused_in_one_line(self.run_with(*sources[:3], right / pattern), *texts)


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

    def refused_video(self, layout, *videos_and_text):
        *videos, text = videos_and_text
        self.refused_source(["--video", *videos, "--video-layout", layout], text)

    def test_each_layout_shows_its_pairs(self):
        for layout, videos in (
            ("two", [self.video("l.avi", 6, "left"), self.video("r.avi", 6, "right")]),
            ("side_by_side", [self.video("s.avi", 6, "left", "right")]),
            ("top_bottom", [self.video("t.avi", 6, "left", "right", below=True)]),
        ):
            with self.subTest(layout):
                self.shows_pairs(6, "--video", *videos, "--video-layout", layout)

    def test_frames_of_another_size_or_number_are_refused(self):
        one, both = self.video("l.avi", 1, "left"), self.video("s.avi", 1, "left", "right")
        wide, high = 2 * WIDTH, 2 * HEIGHT
        rule = "must be as large as"
        one_image = f"{rule} the board's images, {WIDTH}x{HEIGHT}"
        two = f"{rule} two of the board's images, {WIDTH}x{HEIGHT}, with --video-layout"
        self.refused_video("two", one, both, f"s.avi': {wide}x{HEIGHT} pixels: {one_image}")
        beside = f"l.avi': {WIDTH}x{HEIGHT} pixels: {two} side_by_side: {wide}x{HEIGHT}"
        self.refused_video("side_by_side", one, beside)
        below = f"s.avi': {wide}x{HEIGHT} pixels: {two} top_bottom: {WIDTH}x{high}"
        self.refused_video("top_bottom", both, below)
        more = self.video("r.avi", 2, "right")
        self.refused_video("two", one, more, f"--video '{more}': 2 frames: must have as many as '{one}', 1")

    def test_a_header_that_promises_more_frames_is_noted(self):
        video = self.video("s.avi", 4, "left", "right")
        video.write_bytes(video.read_bytes()[: -7 * WIDTH * HEIGHT])
        source = ["--video", video, "--video-layout", "side_by_side"]
        process = self.run_with(*source, "--out", self.out)
        self.succeeds(process)
        note = f"--video '{video}': 2 frames can be decoded; its header says 4"
        self.assertEqual(process.stderr, f"stereotlm: note: {note}\n")
        self.assertEqual(self.stats()["frames"], 2)


class Fit(SourceTest):
    def pair_of(self, name, width, height, change):
        """Files of a pair of this size and of its truth. `change`: of the rows of each."""
        words = []
        for seed, side in enumerate(("left", "right", "truth")):
            pixels = noise(width, height, seed)
            rows = change([pixels[y * width : (y + 1) * width] for y in range(height)], side)
            path = self.file(f"{name}_{side}.pgm", pgm(len(rows[0]), len(rows), b"".join(rows)))
            words += [f"--{side}", path]
        return words

    def equal(self, fit, width, height, change):
        """What a board makes of pictures that it fits, and of those that are fitted before."""
        self.succeeds(self.run_with(*self.pair_of("fitted", width, height, change), "--out", self.out))
        expected = [self.stats(), (self.out / "disparity.png").read_bytes()]
        raw = self.pair_of("raw", width, height, lambda rows, side: rows)
        self.refused(self.run_with(*raw), "raw_left.pgm'", f"add --fit {fit}, or --set")
        self.succeeds(self.run_with(*raw, "--fit", fit, "--out", self.out, "--verify"))
        self.assertEqual([self.stats(), (self.out / "disparity.png").read_bytes()], expected)
        self.assertEqual(self.run_json()["fit"], fit)
        self.succeeds(run("diff", self.out, self.out))  # repeats the run, with its truth
        return raw

    def test_crop_takes_the_middle(self):
        raw = self.equal("crop", 35, 26, lambda rows, side: [row[1:33] for row in rows[1:25]])
        small = self.pair_of("small", 34, 26, lambda rows, side: rows)
        crop = ["--fit", "crop"]
        rule = "34x26 pixels: must be as large as"
        self.refused(self.run_with(*raw[:2], *small[2:4], *crop), f"{rule} '{raw[1]}', 35x26")
        self.refused(self.run_with(*raw[:4], *small[4:], *crop), f"{rule} the left picture, 35x26")

    def test_pad_repeats_the_last_column_and_row(self):
        def padded(rows, side):
            if side == "truth":
                return [row + bytes(2) for row in rows] + 4 * [bytes(WIDTH)]
            rows = [row + 2 * row[-1:] for row in rows]
            return rows + 4 * rows[-1:]

        self.equal("pad", 30, 20, padded)

    def test_fit_is_refused_where_it_means_nothing(self):
        rig, _ = program.made_rig()
        rule = "--fit: does not go with"
        self.refused(self.run_small("--fit", "pad", "--calibration", rig), f"{rule} --calibration")
        self.refused(self.run_with("--fit", "pad", "--synthetic", 1), f"{rule} --synthetic")


class Exchanged(SourceTest):
    def test_is_said_only_of_exchanged_pictures(self):
        width, height, size = 160, 96, sets("image={width: 160, height: 96}", "matcher.disparities=24")
        texture = noise(width + 8, height, 1)  # a disparity of 8
        paths = [self.file(f"{first}.pgm", pgm(width, height, b"".join(
            texture[y * (width + 8) + first :][:width] for y in range(height)))) for first in (0, 8)]
        for left, right, is_said in ((*paths, False), (*reversed(paths), True)):
            process = run("run", "fpl2003", *PRELOADED, *size, "--left", left, "--right", right)
            self.assertEqual("are left and right exchanged?" in process.stderr, is_said, process.stderr)


class Offset(SourceTest):
    def test_is_that_of_a_calibration_with_identity_tables(self):
        calib = self.file("calib.txt", f"""cam0=[9 0 5; 0 9 5; 0 0 1]\ncam1=[9 0 5; 0 9 5; 0 0 1]
            baseline=50\nwidth={WIDTH}\nheight={HEIGHT}\n""")
        truth = ["--truth", self.left, "--truth-scale", 16]
        for offset in (-4, 3):
            rig = self.folder / "rig.yaml"
            self.succeeds(run("calibrate", "--import", calib, f"--disparity-offset={offset}", "--out", rig))
            self.succeeds(self.run_small(*truth, "--calibration", rig, "--out", self.out))
            expected = self.result()
            self.succeeds(self.run_small(*truth, "--disparity-offset", offset, "--out", self.out))
            self.succeeds(run("diff", self.out, self.out))  # repeats the run, with its truth
            for name, found in self.result().items():
                if name != "run.json":
                    self.assertTrue(found == expected[name], name)
            self.assertEqual(self.run_json()["disparity_offset"], offset)
            self.assertFalse((self.out / "depth.png").exists())
        joint = sets("fpga.tables=joint", "allocation.left_lut=bank6", "allocation.right_lut=bank6")
        self.succeeds(self.run_small(*joint, "--disparity-offset", 3, "--out", self.out))
        self.assertTrue(self.result()["disparity.png"] == expected["disparity.png"])
        both = self.run_small("--disparity-offset", 3, "--calibration", rig)
        self.refused(both, "--disparity-offset: does not go with --calibration")

    def test_finds_the_disparities_from_the_offset_on(self):
        found = []
        for offset in (-9, 0, 9):
            pixels = self.left.read_bytes()[-WIDTH * HEIGHT :]
            rows = [pixels[y * WIDTH : (y + 1) * WIDTH] for y in range(HEIGHT)]
            shifted = b"".join((4 * row)[WIDTH + offset + 1 :][:WIDTH] for row in rows)
            right = self.file("shifted.pgm", pgm(WIDTH, HEIGHT, shifted))
            head = f"Pf\n{WIDTH} {HEIGHT}\n-1\n".encode()
            level = struct.pack("<f", max(offset, 0) + 1)
            truth = ["--truth", self.file("truth.pfm", head + level * WIDTH * HEIGHT)]
            words = ["--disparity-offset", offset, "--set", "matcher.disparities=4", "--out", self.out]
            self.succeeds(self.run_small(*words, *truth, right=right))
            found.append(self.stats()["accuracy"]["bad_1_percent"])
            pixels = (self.out / "disparity.pfm").read_bytes()[-4 * WIDTH * HEIGHT :]
            answers = [d for d in struct.unpack(f"<{WIDTH * HEIGHT}f", pixels) if d != math.inf]
            self.assertGreater(len(answers), 100)
            self.assertGreater(answers.count(1), 0.9 * len(answers))
        self.assertEqual(found[0], 100, "a truth of 1 is 10 of the board")
        self.assertLess(max(found[1:]), 10)

    def test_needs_a_left_table_and_columns(self):
        source = [*PRELOADED, *SMALL, *self.pair, "--disparity-offset"]
        none = run("run", "fpl2003-no-calibration", *source, 5)
        self.refused_in_one_line(none, "such as the preset fpl2003")
        self.refused_in_one_line(run("run", "fpl2003", *source, -WIDTH), f", and above -{WIDTH}")


class Truth(SourceTest):
    def accuracy(self, *source):
        self.succeeds(self.run_with(*source, "--truth", self.left, "--out", self.out))
        return self.stats()["accuracy"]

    def test_the_truth_is_of_the_pair_that_the_last_frame_shows(self):
        folder = self.sequence(3)
        for frames, last in ((["--frames", "2"], 1), ([], 2), (["--frames", "4"], 0)):
            pair = ["--left", folder / f"left_00{last}.png", "--right", folder / f"right_00{last}.png"]
            self.assertEqual(self.accuracy("--sequence", folder, *frames), self.accuracy(*pair))


    def test_a_truth_that_most_answers_miss_by_more_than_1_is_doubted(self):
        note = ("stereotlm: note: --truth: 100.00 % of the answers are off by more than 1: is it of this "
                "picture, "
                "and is --truth-scale 1 right?\n")
        for grey, errors in ((b"\1", ""), (b"\2", note)):  # every answer is 0
            truth = self.file("truth.pgm", pgm(WIDTH, HEIGHT, grey * WIDTH * HEIGHT))
            process = self.run_small("--truth", truth, right=self.left)
            self.assertRegex(self.succeeds(process), r"\naccuracy .* answered: [1-9]")
            same = ("stereotlm: warning: the left and the right picture are the same: a pair has one of each "
                    "camera\n")
            self.assertEqual(process.stderr, same + errors)


class Memory(SourceTest):
    """A thousand frames take hardly more memory than thirty: their pictures alone would take 24 MB."""

    WIDE, HIGH = 128, 96

    def setUp(self):
        super().setUp()
        if program.HAS_ADDRESS_SANITIZER:
            self.skipTest("the address sanitizer keeps what is freed for a while")

    def peak(self, source):
        """The largest resident set of a run, in kB."""
        board = sets(f"image.width={self.WIDE}", f"image.height={self.HIGH}", "matcher.fetch=line_buffer",
                     "matcher.disparities=4", "matcher.filter=none")
        command = program.words(["run", "fpl2003", *PRELOADED, *board, *source])
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return used.ru_maxrss

    def test_a_thousand_pairs_of_a_sequence_take_no_more(self):
        folders = []
        for length in (30, 1000):
            folders.append(self.folder / f"{length}")
            for number in range(length):
                for side in ("left", "right"):
                    pixels = os.urandom(self.WIDE * self.HIGH)
                    self.file(f"{length}/{side}_{number:04}.png", pgm(self.WIDE, self.HIGH, pixels))
        # All decoded pictures, since they are less than 128 MB.
        pictures = 2 * (1000 - 30) * self.WIDE * self.HIGH // 1000
        short, long = (["--sequence", folder] for folder in folders)
        self.assertLess(self.peak(long) - self.peak(short), pictures + 12000)
        self.assertLess(self.peak([*short, "--frames", "1000"]) - self.peak(short), 12000)


if __name__ == "__main__":
    program.main()
