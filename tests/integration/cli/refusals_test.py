"""Help, and what is refused: wrong command lines, pictures, boards and folders that a run cannot use.

load_test.cpp has every reason against a picture, result_folder_test.cpp every one against a folder.
"""

import functools
import os
import pathlib
import resource
import shutil
import sys

import program
from pictures import pgm
from program import HEIGHT, PRELOADED, PROGRAM, SMALL, WIDTH, ProgramTest, of_plain_user, run, sets

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "sw/cli"))
import completion  # noqa: E402

COMMANDS = (
    "run check boards keys bounds explain calibrate sweep optimise merge allocate plot conflicts diff "
    "diagram report rtl serve worker"
).split()
SMALL_KEYS = "{image.width: 32, image.height: 24}"
NO_INTEGERS = ("-1", "1.5", "x", "18446744073709551616")


def parsed_options():
    """Command -> option -> whether it takes a value, as the parser of each command says."""
    commands = completion.entries(completion.said(PROGRAM, "--help"), "Commands")
    options = {name: completion.options_of(completion.said(PROGRAM, name, "--help")) for name, _ in commands}
    return {name: {option: takes for option, (takes, _) in of.items()} for name, of in options.items()}


class Help(ProgramTest):
    def test_the_program_names_every_command_and_the_exit_statuses(self):
        for option in ("--help", "-h"):
            text = self.succeeds(run(option))
            for part in [*COMMANDS, "Exit status: 0"]:
                self.assertIn(part, text)

    def test_each_command_says_how_to_use_it_in_104_columns(self):
        for command in ([], *([command] for command in COMMANDS)):
            text = self.succeeds(run(*command, "--help"))
            self.assertIn(" ".join(["Usage: stereotlm", *command]), text)
            for line in text.splitlines():
                self.assertLessEqual(len(line), 104, line)

    def test_the_version_is_named(self):
        self.assertRegex(self.succeeds(run("--version")), r"^stereotlm \d+\.\d+\.\d+\n$")


class CommandLine(ProgramTest):
    def test_wrong_commands_are_refused(self):
        self.all_refused([
            ([], "a command is missing", f"{', '.join(COMMANDS[:-1])} or {COMMANDS[-1]}"),
            ([""], "a command is missing"),
            (["bound", "fpl2003"], "'bound': unknown command; nearest: bounds"),
            (["--bogus"], "'--bogus': a command comes first"),
            (["--"], "'--': a command comes first"),
            (["--frames", "1", "run", "fpl2003"], "'--frames': a command comes first"),
        ])

    def test_unknown_options_are_refused_with_the_nearest(self):
        for command in COMMANDS:
            self.refused_in_one_line(run(command, "--bogus"), "--bogus", f"stereotlm {command} --help")
        nearest = {"--fames": "--frames", "--rigth": "--right", "--sett": "--set", "--verfy": "--verify"}
        for wrong, right in {**nearest, "--timing-onyl": "--timing-only"}.items():
            text = f"stereotlm: error: {wrong}: unknown option; nearest: {right} (see stereotlm run --help)"
            run_it = ["run", "fpl2003"]
            self.all_refused([([*run_it, wrong, "3"], text), ([*run_it, f"{wrong}=3"], text)])
        lines = self.refused(run("run", "fpl2003", "--fames", "3", "--out", "a", "--verfy"))
        self.assertEqual([line.split()[2] for line in lines], ["--fames:", "--verfy:"])

    def test_options_without_value_or_given_twice_are_refused(self):
        self.refused_in_one_line(run("check", "fpl2003", "fpl2003-qvga"), "fpl2003-qvga")
        self.refused_in_one_line(run("keys", "fpl2003"), "fpl2003")
        for option in ("--left", "--frames", "--out", "--source", "--set"):
            self.refused_in_one_line(run("run", "fpl2003", option), option)
            if option != "--set":
                self.refused_in_one_line(run("run", "fpl2003", option, "1", option, "1"),
                                         f"{option}: given twice: must be given once")

    def test_each_option_that_takes_a_value_needs_one(self):
        options = parsed_options()
        self.assertEqual(sorted(options), sorted(COMMANDS))
        self.assertGreater(sum(map(len, options.values())), 100)
        with self.unchanged(self.folder):
            for command, of in options.items():
                for option, takes_value in of.items():
                    words = [[option, "--quiet"], [option, "-x"], [option, ""], [option]] * takes_value
                    for each in [[f"{option}=", "--quiet"], *words]:
                        process = run(command, *each, cwd=self.folder)
                        self.refused(process, f"error: {each[0]}: a value is missing: must be {option}",
                                     f"(see stereotlm {command} --help)")

    def test_values_may_begin_with_a_dash(self):
        offset = ["calibrate", "--synthetic", "1", "--grid", "9x6", "--square-mm", "25", "--disparity-offset"]
        (problem, _) = self.refused(run(*offset, "-5", "--out", "x"))
        self.assertEqual(problem, "stereotlm: error: --out 'x': must end in .yaml")
        self.refused(run(*offset, "-.5", "--out", "x.yaml"), "--disparity-offset = -.5: must be auto or an")
        self.refused_in_one_line(run("check", "fpl2003", "--calibration=-x"), "--calibration '-x'")
        self.refused(run("run", "--out", "--json"), "be --out DIR, or --out=--json if --json is the value")
        self.succeeds(run(*self.run_arguments("--out=--json"), cwd=self.folder))
        self.is_in(self.folder, "--json", "left.pgm", "right.pgm")

    def test_values_are_as_they_are_typed(self):
        calibrate = ["calibrate", "--grid", "9x6", "--square-mm", "25", "--out", self.folder / "rig.yaml"]
        for name in ("[]", "{}", "[a,b]", "[9]"):
            lines = self.refused(run(*calibrate, "--left", name, "--right", self.right, cwd=self.folder))
            self.assertEqual([line.split(": ")[2] for line in lines], [f"--left '{name}'"])

    def test_a_board_is_needed(self):
        for command in ("run", "check", "bounds"):
            self.refused(run(command), "stereotlm: error: BOARD: missing")
        self.refused_in_one_line(run("check", "keys"), "keys: not a preset")  # nor a command

    def test_wrong_values_are_refused_with_the_rule(self):
        truth = [*self.pair, "--truth", self.left]
        for before, option, rule, *values in (
            (self.pair, "--source", "camera or preloaded", "foo", "Preloaded"),
            (self.pair, "--fidelity", "fast or cycle", "foo", "Preloaded"),
            (self.pair, "--frames", "an integer, 1 or more", "0", "+1", " 1", "1e3", "0x10", *NO_INTEGERS),
            (truth, "--truth-scale", "a number above 0", "0", "-1", "nan", "inf", "x", "1e400", "2x"),
            ([], "--synthetic", "an integer, 0..2^64-1", *NO_INTEGERS),
            (["--video", "a"], "--video-layout", "two, side_by_side or top_bottom", "three", "Two"),
        ):
            run_it = ["run", "fpl2003", *before, option]
            self.all_refused(([*run_it, value], f"{option} = {value}: must be {rule}") for value in values)

    def test_options_that_do_not_go_together_are_refused(self):
        one_source = "a run has one source of pictures: --left F"
        no_disparities = "does not go with --timing-only, which has no disparities"
        pair, timing, saved = self.pair, [*self.pair, "--timing-only"], ["--save-frames", "--out", self.out]
        sequence, synthetic = ["--sequence", self.folder], ["--synthetic", "1"]
        video = ["--video", self.left, "--video-layout", "side_by_side"]
        one, two = ["--video", "a", "--video-layout"], ["--video", "a", "b", "--video-layout"]
        self.all_refused([
            (pair + sequence, f"error: --left, --sequence: {one_source}"),
            (pair + synthetic, f"error: --left, --synthetic: {one_source}"),
            (sequence + video, f"error: --sequence, --video: {one_source}"),
            (pair + sequence + video + synthetic, f"--left, --sequence, --video, --synthetic: {one_source}"),
            (one[:2], "--video-layout: missing: goes with --video, one of two, side_"),
            ([*pair, "--video-layout", "two"], "--video-layout: goes with --video F [F2]"),
            ([*one, "two"], "--video 'a': must name two files with --video-layout two"),
            ([*two, "side_by_side"], "--video 'a' 'b': must name one file with --video-layout side_by_side"),
            ([*two, "top_bottom"], "--video 'a' 'b': must name one file with --video-layout top_bottom"),
            ([*pair, "--truth-scale", "2"], "--truth-scale: goes with --truth F"),
            ([*synthetic, "--truth", "t"], "does not go with --synthetic, whose scene is its own truth"),
            ([*timing, "--truth", self.left], f"--truth: {no_disparities}"),
            ([*timing, *saved], f"--save-frames: {no_disparities}"),
            ([*pair, "--save-frames"], "--save-frames: goes with --out DIR"),
        ], self.run_with)
        self.refused_in_one_line(run("run", "fpl2003", *pair, "--record"), "--record: goes with --out DIR")
        self.refused(self.run_with("--video", "a", "b", "c", "--video-layout", "two"))
        self.assertFalse(self.out.exists())


class Missing(ProgramTest):
    def missing(self, *arguments):
        """What is said to be missing; the last line shows a complete command."""
        *lines, example = self.refused(run("run", *arguments))
        command = r"stereotlm run fpl2003 .*--left \S+ --right \S+"
        self.assertRegex(example, rf"^stereotlm: note: a complete command: {command}$")
        return [line.split(": ")[2] for line in lines if ": missing: " in line]

    def test_parts_of_a_run_are_named_all_at_once(self):
        left, right = self.pair[:2], self.pair[2:]
        for arguments, missing in (
            ([], ["BOARD", "pictures"]),
            (["fpl2003", *PRELOADED], ["pictures"]),
            (["fpl2003", *PRELOADED, *left], ["--right"]),
            (["fpl2003", *PRELOADED, *right], ["--left"]),
            (["--timing-only"], ["BOARD"]),
            (["fpl2003", "--timing-only", *left], ["--right"]),
        ):
            self.assertEqual(self.missing(*arguments), missing)
        sources = "--left F --right F, --sequence DIR, --video F [F2] or --synthetic SEED"
        self.refused(self.run_with(), f"error: pictures: missing: a run needs {sources}")
        self.assertNotIn("complete command", run("run", "fpl2003", "--left", "a", "--right", "b").stderr)

    def test_the_complete_command_is_one(self):
        example = self.refused(run("run"))[-1].split(": ")[-1].split()
        self.assertEqual(example.pop(0), "stereotlm")
        for name in ("left.png", "right.png"):
            self.file(name, pgm(640, 480, bytes(640 * 480)))
        self.succeeds(run(*example, "--set", "matcher.window=3", cwd=self.folder))


class Pictures(ProgramTest):
    def picture(self, width, height):
        return self.file(f"{width}x{height}.pgm", pgm(width, height, bytes(width * height)))

    def test_wrong_pictures_are_refused_with_option_path_and_reason(self):
        comment = b"P5\n# \r30000 30000 255\n1 1 255\nx"  # which a decoder may take for the size
        size = f"pixels: must be as large as the board's images, {WIDTH}x{HEIGHT}"
        sizes = ((WIDTH + 1, HEIGHT), (WIDTH - 1, HEIGHT), (WIDTH, HEIGHT + 1), (WIDTH, HEIGHT - 1))
        for path, reason in (
            (self.folder / "none.png", "no such file"),
            (self.file("comment.pgm", comment), "30000x30000 pixels: a board's images are 8192x8192 at most"),
            *((self.picture(*wrong), f"{wrong[0]}x{wrong[1]} {size}") for wrong in sizes),
        ):
            with self.subTest(reason=reason):
                options = ["--left", path, "--right", path, "--truth", path]
                lines = self.refused(self.run_with(*options, "--out", self.out))
                for option, line in zip(options[::2], lines, strict=True):
                    self.assertTrue(line.startswith(f"stereotlm: error: {option} '{path}': {reason}"), line)
                self.assertFalse(self.out.exists())

    def test_files_without_permission_are_refused(self):
        self.left.chmod(0)
        process = run(*self.run_arguments(), preexec_fn=of_plain_user)
        self.refused_in_one_line(process, f"--left '{self.left}': Permission denied")

    def test_paths_that_run_json_cannot_hold_are_refused(self):
        strange = os.fsdecode(b"\xff")
        for side in ("left", "right"):
            shutil.copy(self.left, self.folder / f"{side}_{strange}.png")
        path = self.folder / f"left_{strange}.png"
        pair, folder = ["--left", path, "--right", self.right], ["--sequence", self.folder]
        for options, name in (pair, path), (folder, path.name):
            command = ["run", "fpl2003", *SMALL, *PRELOADED, *options]
            process = run(*command, "--out", self.out, errors="surrogateescape")
            self.refused_in_one_line(process, f"error: {options[0]} '{name}': a path that is not UTF-8")
            self.succeeds(run(*command))


class Environment(ProgramTest):
    def test_variables_of_opencv_have_no_effect(self):
        expected = self.succeeds(self.run_small())
        values = {"WIDTH": "1", "HEIGHT": "-1", "PIXELS": "many", "PARAMS": ""}
        variables = {f"OPENCV_IO_MAX_IMAGE_{name}": value for name, value in values.items()}
        process = run(*self.run_arguments(), env={**os.environ, **variables, "OPENCV_LOG_LEVEL": "VERBOSE"})
        self.assertEqual((process.stdout, process.stderr), (expected, ""))

    def test_too_few_open_files_name_the_limit(self):
        for most in (5, 6, 7):
            limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
            process = run(*self.run_arguments("--out", self.out), preexec_fn=limit)
            self.assertIn("Too many open files (the limit: ulimit -n)", process.stderr)


class Boards(ProgramTest):
    def test_a_wrong_board_is_refused_together_with_pictures_and_folder(self):
        none = self.folder / "none"
        board = sets("matcher.window=4")
        lines = self.refused(self.run_small(*board, "--out", self.left, left=none))
        for line, start in zip(lines, (
            "--set matcher.window: matcher.window = 4: 3..31",
            f"stereotlm: error: --left '{none}': no such file",
            f"stereotlm: error: result folder '{self.left}': not a folder",
        ), strict=True):
            self.assertTrue(line.startswith(start), line)
        lines = self.refused(self.run_with("--sequence", none, *board), "--set matcher.window", "--sequence")
        self.assertEqual(len(lines), 2)


class Paths(ProgramTest):
    @program.slow
    def test_paths_that_lead_nowhere_are_refused_with_their_option(self):
        self.succeeds(self.run_small("--out", self.out))
        plan = self.file("plan.yaml", "board: fpl2003\nvary: {matcher.window: [5, 7]}\n")
        sweep = ["sweep", plan, "--out"]
        grid = ["9x6", "--square-mm", "25"]
        calibrate = ["calibrate", "--grid", *grid]
        pictures = [*calibrate, "--out", self.folder / "rig.yaml"]
        for arguments, option, ending in (
            (["run", "fpl2003", "--right", self.right, "--left"], "--left", ""),
            (self.run_arguments("--truth"), "--truth", ""),
            (["run", "fpl2003", "--sequence"], "--sequence", ""),
            (["run", "fpl2003", "--video-layout", "side_by_side", "--video"], "--video", ""),
            (["check", "fpl2003", "--calibration"], "--calibration", ".yaml"),
            (self.run_arguments("--out"), "result folder", ""),
            ([*pictures, "--right", self.right, "--left"], "--left", ""),
            ([*pictures, "--left", self.left, "--right"], "--right", ""),
            ([*calibrate, "--synthetic", "1", "--out"], "--out", ".yaml"),
            (["calibrate", "--print-grid", *grid, "--out"], "--out", ".svg"),
            (["diff", self.out], "B must be a folder", ""),
            (["diff", self.out, self.out, "--csv"], "--csv", ".csv"),
            (sweep, "--out", ""),
            ([*sweep, self.folder / "a.db", "--known"], "--known", ""),
            ([*sweep, self.folder / "a.db", "--progress"], "--progress", ""),
            (["conflicts", "--synthetic", "1"], "", ""),
            (["report", self.out, "--quick", "--out"], "--out", ".html"),
            (["diagram", "fpl2003", "--out"], "--out", ".svg"),
            (["rtl", "fpl2003", "--synthetic", "1", "--out"], "--out", ""),
            (["allocate", "fpl2003", "--banks", "8", "--out", self.folder / "a.db", "--write"], "--write",
             ".yaml"),
        ):
            loop = self.folder / f"loop{ending}"
            if not loop.is_symlink():
                loop.symlink_to(loop.name)
            too_long = self.folder / f"{'long' * 64}{ending}"
            for path in (loop, too_long):
                process = run(*arguments, path)
                self.assertNotIn("filesystem error", process.stderr)
                self.refused(process, option)
            self.assertTrue(loop.is_symlink())


class OutputFolders(ProgramTest):
    def test_folders_with_files_of_others_are_refused(self):
        self.file("out/thesis.tex", "years of work")
        refusal = "stereotlm: error: result folder"
        with self.unchanged(self.folder):
            self.refused_in_one_line(self.run_small("--out", self.out), refusal, "holds 'thesis.tex'")

    def test_folders_with_pictures_of_the_run_are_refused(self):
        self.succeeds(self.run_small("--out", self.out))
        picture = self.out / "disparity.png"
        for option, pair in (("--left", {"left": picture}), ("--right", {"right": picture})):
            with self.unchanged(self.out):
                self.refused_in_one_line(self.run_small("--out", self.out, **pair),
                                         f"{option} '{picture}' lies in it and would be replaced")


class Outputs(ProgramTest):
    """Only files that the program has written are replaced, and none that the same command reads."""

    def setUp(self):
        super().setUp()
        run_it = ["run", "fpl2003", *SMALL, *PRELOADED, "--synthetic", "1", "--record", "--out"]
        self.a, self.b, self.store = self.folder / "a", self.folder / "b", self.folder / "sweep.db"
        for folder in (self.a, self.b):
            self.succeeds(run(*run_it, folder))
        self.sweep = ["sweep", self.file("plan.yaml", f"board: fpl2003\nset: {SMALL_KEYS}\n"), "--out"]
        self.succeeds(run(*self.sweep, self.store))
        traced = ["run", "fpl2003", *SMALL, *PRELOADED, "--timing-only", "--trace-window", "frame=0"]
        allocate = ["allocate", "fpl2003", *SMALL, *PRELOADED, "--banks", "8", "--out",
                    self.folder / "search.db"]
        grid = ["calibrate", "--print-grid", "9x6", "--square-mm", "25", "--out"]
        # By the ending of the file: the command, up to the file.
        self.writers = {
            ".perfetto": [*traced, "--trace", "perfetto:"],
            ".vcd": [*traced, "--trace", "vcd:"],
            ".fst": [*traced, "--trace", "vcd:"],
            ".trace.db": [*traced, "--trace", "sqlite:"],
            ".html": ["report", self.a, "--quick", "--out"],
            ".svg": ["diagram", self.a, "--out"],
            ".csv": ["diff", self.a, self.b, "--csv"],
            ".yaml": [*allocate, "--write"],
            ".grid.svg": [*grid],
            ".progress": [*self.sweep, self.store, "--progress"],
        }

    def command(self, ending, path):
        *words, last = self.writers[ending]
        return [*words, f"{last}{path}"] if str(last).endswith(":") else [*words, last, path]

    @program.slow
    def test_files_of_its_own_kind_alone_are_replaced(self):
        files = {ending: self.folder / f"own{ending}" for ending in self.writers}
        for ending, path in files.items():
            for _ in range(2):
                self.succeeds(run(*self.command(ending, path)))
        notes = {
            "text": b"\nNotes on stereotlm",
            "page": b"<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<title>stereotlm report</title>\n",
            "drawing": b"<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"memory-chart\"></svg>",
            "waveform": b"$version stereotlm 2 $end\n",
            "fst": b"\0\0\0\0\0\0\0\1\x49" + bytes(65) + b"another writer" + bytes(300),
            "table": b"frame,row,a_cycles,b_cycles,mine\n",
            "board": b"extends: fpl2003\n",
            "counts": b"ok 3\n",
            "sweep": self.store.read_bytes(),
            **{ending: path.read_bytes() for ending, path in files.items()},
        }
        for ending in self.writers:
            target = self.folder / f"target{ending}"
            link = self.folder / f"link{ending}"
            link.symlink_to(target)
            for kind, data in notes.items():
                if kind == ending:
                    continue
                target.write_bytes(data)
                with self.subTest(ending=ending, kind=kind), self.unchanged(self.folder):
                    path = link if kind == "sweep" else target
                    self.refused_in_one_line(run(*self.command(ending, path)),
                                             f"'{path}': exists, and is not known as a ",
                                             "which alone is replaced: move it away, or give another file")

    def test_files_of_a_result_folder_are_refused(self):
        (self.folder / "link").symlink_to(self.a)
        (self.a / "frames").mkdir()
        scene = ["fpl2003", *SMALL, *PRELOADED, "--timing-only"]
        calibrate = ["calibrate", "--synthetic", "1", "--grid", "9x6", "--square-mm", "25", "--out"]
        of_folders = (["conflicts", *scene, "--out"], ["plot", self.store, "--out"],
                      ["rtl", "fpl2003", *SMALL, "--synthetic", "1", "--out"])
        commands = [(ending, functools.partial(self.command, ending)) for ending in self.writers]
        for words in (self.sweep, ["sweep", "--launcher", "slurm", *self.sweep[1:]], ["run", *scene, "--out"],
                      ["optimise", *scene[:-1], "--minimise", "pins", "--out"],
                      ["allocate", *scene[:-1], "--banks", "1", "--out"], *of_folders):
            commands.append(("", lambda path, words=words: [*words, path]))
        commands += [("", lambda path: ["merge", path, self.store]),
                     ("", lambda path: [*calibrate, f"{path}.yaml"])]
        writers = {command("x")[0] for _, command in commands}
        self.assertEqual(writers, {"merge", "diff"} | {name for name, of in parsed_options().items()
                                                       if "--out" in of})
        folders = (self.a, self.folder / "link" / "frames", self.b / ".." / "a" / "none")
        rows = [command(folder / f"new{ending}") for ending, command in commands for folder in folders
                if folder.exists() or command("x")[0] != "calibrate"]
        for arguments in (*rows, *([*words, self.a] for words in of_folders),
                          [*calibrate, self.a / "rig.yaml"], self.command(".csv", self.a / "rows.csv"),
                          self.command(".yaml", self.a / "config.yaml")):
            with self.subTest(arguments=arguments), self.unchanged(self.folder):
                self.refused_in_one_line(run(*arguments), f"the result folder '{self.a}' of run holds noth")

    def test_the_known_database_is_another_one(self):
        soft, hard, to_new, new = (self.folder / f"{name}.db" for name in ("soft", "hard", "to_new", "new"))
        soft.symlink_to(self.store)
        hard.hardlink_to(self.store)
        to_new.symlink_to(new.name)
        for out, known in ((self.store, self.store), (self.store, soft), (hard, self.store), (new, to_new)):
            with self.subTest(out=out, known=known), self.unchanged(self.folder):
                self.refused_in_one_line(run(*self.sweep, out, "--known", known),
                                         f"--known '{known}': is the file of --out: must be another")

    def test_an_fst_needs_no_other_name_in_its_folder(self):
        (self.folder / "own.fst.vcd").mkdir()
        self.succeeds(run(*self.command(".fst", self.folder / "own.fst")))


if __name__ == "__main__":
    program.main()
