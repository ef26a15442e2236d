"""Tests of check_includes.py on small trees, each with one broken rule."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import check_includes

PRAGMA = "#pragma once\n"


def quoted(included):
    return f'#include "{included}"\n'


GOOD = {
    "models/kernels/sad.h": "#pragma once\n\n#include <cstdint>\n",
    "models/kernels/sad.cpp": quoted("models/kernels/sad.h"),
    "models/memory/memory_config.h": PRAGMA + quoted("models/kernels/sad.h"),
    "models/memory/ssram_bank.h": PRAGMA + "#include <systemc>\n" + quoted("models/memory/memory_config.h"),
    "platform/board_config.h": PRAGMA + quoted("models/memory/memory_config.h"),
    "platform/board.h": PRAGMA + quoted("models/memory/ssram_bank.h"),
    "platform/board_yaml.cpp": "#include <fstream>\n#include <yaml-cpp/yaml.h>\n",
    "calib/grid.h": PRAGMA + "#include <opencv2/core.hpp>\n" + quoted("models/kernels/sad.h"),
    "sw/cli/run.cpp": quoted("calib/grid.h") + quoted("platform/board.h") + "#include <opencv2/core.hpp>\n",
    "sw/explore/plan.h": PRAGMA + quoted("platform/board_config.h"),
    "sw/driver/driver.cpp": quoted("platform/board_config.h"),
    "tests/support/fork.h": PRAGMA,
    "tests/unit/sad_test.cpp": quoted("tests/support/fork.h") + quoted("sw/explore/plan.h"),
    "tests/unit/bus_test.cpp": "#include <tlm>\n",
}
# What a source file may include or hold besides.
ALSO_GOOD = {
    "models/kernels/a.cpp": "#include <tlmx>\n#include <systemc_free>\nusing namespace std;\n",
    "models/kernels/b.cpp": '// #include <systemc>\n/*\n#include "sw/none.h"\n*/\n',
    "models/kernels/c.h": "// About sums.\n#pragma once\n",
    "models/kernels/d.h": '#pragma once\n// using namespace std;\nconst char* a = "using namespace";\n',
    "models/kernels/e.h": PRAGMA + quoted("models/kernels/f.h"),
    "models/kernels/f.h": PRAGMA + quoted("models/kernels/e.h"),
    "sw/files/a.h": PRAGMA,
    "sw/explore/store/b.h": PRAGMA + quoted("sw/files/a.h"),
    "sw/runs/sources/c.h": PRAGMA + quoted("sw/explore/store/b.h"),
    "sw/cli/d.h": PRAGMA + quoted("sw/runs/sources/c.h"),
}


class CheckIncludes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write(GOOD)

    def write(self, files):
        for path, text in files.items():
            (self.root / path).parent.mkdir(parents=True, exist_ok=True)
            (self.root / path).write_text(text, encoding="utf-8")

    def findings(self):
        return [f"{path}:{line}: {what}" for path, line, what in check_includes.check(self.root)]

    def finds(self, rows):
        """Rows of a file, of its text, behind #pragma once in headers, and of what is found in it alone."""
        for path, text, finding in rows:
            with self.subTest(path=path, text=text):
                self.write({path: PRAGMA + text if path.endswith(".h") else text})
                (found,) = self.findings()
                self.assertIn(finding, found)
                (self.root / path).unlink()

    def test_passes_trees_that_keep_the_rules(self):
        self.assertEqual(self.findings(), [])
        self.write(ALSO_GOOD)
        self.assertEqual(self.findings(), [])

    def test_finds_folders_and_rooms_that_include_one_above_them(self):
        folders = ("models", "platform", "calib", "sw")
        self.finds((path, quoted(included), f"{folder} may not include it") for folder, path, included in (
            ("models", "models/a.cpp", "platform/board_config.h"),
            ("models", "models/a.cpp", "sw/explore/plan.h"),
            ("platform", "platform/a.cpp", "sw/explore/plan.h"),
            ("calib", "calib/a.cpp", "platform/board_config.h"),
            ("calib", "calib/a.cpp", "models/memory/memory_config.h"),
            *((folder, f"{folder}/a.cpp", "tests/support/fork.h") for folder in folders),
            ("platform/config", "platform/config/a.h", "platform/board.h"),
            ("sw/explore/store", "sw/explore/store/a.h", "sw/explore/plan.h"),
            ("sw/driver", "sw/driver/a.h", "sw/explore/plan.h"),
        ))

    def test_finds_headers_from_outside_where_they_may_not_be(self):
        systemc = ("systemc", "systemc.h", "tlm", "tlm_utils/peq_with_get.h", "sysc/kernel/sc_time.h")
        files = ("yaml-cpp/yaml.h", "fstream", "filesystem", "nlohmann/json.hpp")
        self.finds((path, f"#include <{header}>\n", f"{path}:1: {header}: this file may not include {what}")
                   for what, path, headers in (
            ("SystemC", "models/kernels/a.cpp", systemc),
            ("SystemC", "calib/a.cpp", systemc),
            ("OpenCV", "models/a.cpp", ["opencv2/imgproc.hpp"]),
            ("OpenCV", "platform/a.cpp", ["opencv2/imgproc.hpp"]),
            ("Eigen", "models/a.cpp", ["Eigen/Core"]),
            ("Eigen", "platform/a.cpp", ["Eigen/Core"]),
            ("YAML or files", "models/a.cpp", files),
        ) for header in headers)

    def test_finds_systemc_behind_other_headers(self):
        self.write({"models/memory/deep.h": PRAGMA + quoted("models/memory/ssram_bank.h")})
        way = "models/memory/deep.h -> models/memory/ssram_bank.h -> systemc"
        finding = f"{way}: this file may not include SystemC"
        self.finds((path, "\n" + quoted("models/memory/deep.h"), finding) for path in (
            "platform/other_config.h", "models/area/a.h", "models/pci/pci_config.h",
            "models/fpga/register_map.h", "models/fpga/core_registers.h",
            "sw/explore/a.cpp", "sw/driver/a.cpp",
        ))

    def test_finds_paths_that_are_none_or_in_angle_brackets(self):
        none = "no such file below the repository root"
        self.finds([
            ("models/kernels/a.cpp", quoted("sad.h"), f'"sad.h": {none}'),
            ("models/memory/a.cpp", quoted("../kernels/sad.h"), none),
            ("sw/cli/a.cpp", quoted("models/kernels/none.h"), none),
            ("sw/cli/a.cpp", "#include <models/kernels/none.h>\n", none),
            ("sw/cli/a.cpp", "#include <models/kernels/sad.h>\n", "is included with quotes"),
        ])

    def test_finds_the_line_behind_comments_and_literals(self):
        literals = '/* one\n two */\nconst char* a = "/*";\nconst char* b = R"x(\n)" #)x";\n#include <tlm>\n'
        separator = "int a = 1'000; /* it's\n#include <tlm>\n*/\n#include <systemc>\n"
        self.finds([
            ("models/kernels/a.cpp", literals, "models/kernels/a.cpp:6: tlm"),
            ("models/kernels/a.cpp", separator, "a.cpp:4: systemc"),
        ])

    def test_finds_headers_without_pragma_once_and_with_using_namespace(self):
        for text in ("", "#include <cstdint>\n#pragma once\n"):
            self.write({"models/kernels/a.h": text})
            (found,) = self.findings()
            self.assertIn("begins with #pragma once", found)
        using = "  using  namespace std;\n"
        self.finds([("models/kernels/a.h", using, "models/kernels/a.h:2: using namespace")])

    def test_the_program_names_the_place_and_exits_with_its_status(self):
        self.write({"models/a.cpp": "#include <fstream>\n"})
        bad = "models/a.cpp:1: fstream: this file may not include YAML or files\n"
        program = pathlib.Path(check_includes.__file__)

        def ends(status, *arguments):
            command = [sys.executable, program, *arguments]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, status)
            return done.stdout + done.stderr

        self.assertEqual(ends(1, self.root), bad)
        (self.root / "models/a.cpp").unlink()
        self.assertEqual(ends(0, self.root), "")
        ends(2, self.root / "models/kernels")
        ends(2)


if __name__ == "__main__":
    unittest.main()
