"""Tests of check_includes.py on a small tree, with one broken rule each."""

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
    "models/kernels/sad.h": '// Sums.\n#pragma once\n// using namespace std;\nauto a = "using namespace";\n',
    "models/kernels/sad.cpp": '#include <tlmx>\n/*\n#include "sw/none.h"\n*/\nusing namespace std;\n',
    "models/kernels/e.h": PRAGMA + quoted("models/kernels/f.h"),
    "models/kernels/f.h": PRAGMA + quoted("models/kernels/e.h"),
    "models/memory/memory_config.h": PRAGMA + quoted("models/kernels/sad.h"),
    "models/memory/bank.h": PRAGMA + "#include <systemc>\n" + quoted("models/memory/memory_config.h"),
    "platform/board_config.h": PRAGMA + quoted("models/memory/memory_config.h"),
    "platform/assembly/board.h": PRAGMA + quoted("models/memory/bank.h"),
    "platform/loop/a.h": PRAGMA + quoted("platform/assembly/board.h"),
    "platform/board_yaml.cpp": "#include <fstream>\n#include <yaml-cpp/yaml.h>\n",
    "calib/grid.h": PRAGMA + "#include <opencv2/core.hpp>\n" + quoted("models/kernels/sad.h"),
    "sw/cli/run.cpp": quoted("calib/grid.h") + quoted("platform/loop/a.h") + "#include <opencv2/core.hpp>\n",
    "sw/files/a.h": PRAGMA,
    "sw/explore/plan.h": PRAGMA + quoted("platform/board_config.h") + quoted("sw/files/a.h"),
    "sw/runs/c.h": PRAGMA + quoted("sw/explore/plan.h"),
    "tests/support/fork.h": PRAGMA,
    "tests/unit/sad_test.cpp": quoted("tests/support/fork.h") + "#include <tlm>\n",
}
ABOVE = "may not include it"
NONE = "no such file below the repository root"
DEEP = "models/memory/bank.h -> systemc: this file may not include SystemC"
# A file, its text (behind #pragma once in headers), and what alone is found.
BROKEN = (
    ("models/a.cpp", quoted("platform/board_config.h"), "models " + ABOVE),
    ("platform/a.cpp", quoted("sw/explore/plan.h"), "platform " + ABOVE),
    ("calib/a.cpp", quoted("models/memory/memory_config.h"), "calib " + ABOVE),
    ("sw/a.cpp", quoted("tests/support/fork.h"), "sw " + ABOVE),
    ("platform/assembly/a.h", quoted("platform/loop/a.h"), "platform/assembly " + ABOVE),
    ("sw/explore/store/a.h", quoted("sw/explore/plan.h"), "sw/explore/store " + ABOVE),
    ("sw/driver/a.h", quoted("sw/explore/plan.h"), "sw/driver " + ABOVE),
    *((path, f"#include <{header}>\n", f"{path}:1: {header}: this file may not include {what}")
      for what, path, headers in (
          ("SystemC", "models/kernels/a.cpp", ["systemc", "systemc.h", "tlm", "tlm_utils/peq_with_get.h",
                                               "sysc/kernel/sc_time.h"]),
          ("SystemC", "calib/a.cpp", ["systemc"]),
          ("OpenCV", "models/a.cpp", ["opencv2/imgproc.hpp"]),
          ("OpenCV", "platform/a.cpp", ["opencv2/imgproc.hpp"]),
          ("Eigen", "models/a.cpp", ["Eigen/Core"]),
          ("YAML or files", "models/a.cpp", ["yaml-cpp/yaml.h", "fstream", "nlohmann/json.hpp"]),
      ) for header in headers),
    *((path, "\n" + quoted("models/memory/bank.h"), DEEP) for path in (
        "platform/other_config.h", "models/area/a.h", "models/pci/pci_config.h", "models/fpga/register_map.h",
        "models/fpga/core_registers.h", "sw/explore/a.cpp", "sw/driver/a.cpp")),
    ("models/kernels/a.cpp", quoted("sad.h"), f'"sad.h": {NONE}'),
    ("models/memory/a.cpp", quoted("../kernels/sad.h"), NONE),
    ("sw/cli/a.cpp", "#include <models/kernels/sad.h>\n", "is included with quotes"),
    ("models/kernels/a.cpp", '/* one\n */\nconst char* b = R"x(\n)" #)x";\n#include <tlm>\n', "a.cpp:5: tlm"),
    ("models/kernels/a.cpp", "int a = 1'000; /* it's\n#include <tlm>\n*/\n#include <systemc>\n",
     "a.cpp:4: systemc"),
    ("models/kernels/a.h", "  using  namespace std;\n", "models/kernels/a.h:2: using namespace"),
)


class CheckIncludes(unittest.TestCase):
    def test_finds_each_broken_rule_with_its_place(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)

            def write(path, text):
                (root / path).parent.mkdir(parents=True, exist_ok=True)
                (root / path).write_text(text, encoding="utf-8")
                git("add", path)

            def git(*arguments):
                subprocess.run(["git", "-C", root, *arguments], check=True)

            def program():
                command = [sys.executable, check_includes.__file__, root]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                return done.returncode, done.stdout

            git("init", "-q")
            for path, text in GOOD.items():
                write(path, text)
            (root / "models/scratch.h").write_text("no pragma, and not tracked")
            self.assertEqual(program(), (0, ""))
            for path, text, finding in BROKEN:
                with self.subTest(path=path, text=text):
                    write(path, PRAGMA + text if path.endswith(".h") else text)
                    (found,) = [f"{path}:{line}: {what}" for path, line, what in check_includes.check(root)]
                    self.assertIn(finding, found)
                    git("rm", "-q", "-f", path)
            write("models/kernels/a.h", "#include <cstdint>\n#pragma once\n")
            status, out = program()
            self.assertEqual((status, out.count("\n")), (1, 1))
            self.assertIn("begins with #pragma once", out)


if __name__ == "__main__":
    unittest.main()
