"""Tests of check_includes.py on small trees, each with one broken rule."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import check_includes

GOOD = {
    "models/kernels/sad.h": "#pragma once\n\n#include <cstdint>\n",
    "models/kernels/sad.cpp": '#include "models/kernels/sad.h"\n',
    "models/memory/memory_config.h": '#pragma once\n#include "models/kernels/sad.h"\n',
    "models/memory/ssram_bank.h": "#pragma once\n#include <systemc>\n"
    '#include "models/memory/memory_config.h"\n',
    "platform/board_config.h": '#pragma once\n#include "models/memory/memory_config.h"\n',
    "platform/board.h": '#pragma once\n#include "models/memory/ssram_bank.h"\n',
    "platform/board_yaml.cpp": "#include <fstream>\n#include <yaml-cpp/yaml.h>\n"
    '#include "platform/board_config.h"\n',
    "calib/grid.h": '#pragma once\n#include <opencv2/core.hpp>\n#include "models/kernels/sad.h"\n',
    "sw/cli/run.cpp": '#include "calib/grid.h"\n#include "platform/board.h"\n#include <opencv2/core.hpp>\n',
    "sw/explore/plan.h": '#pragma once\n#include "platform/board_config.h"\n',
    "sw/driver/driver.cpp": '#include "platform/board_config.h"\n',
    "tests/support/fork.h": "#pragma once\n",
    "tests/unit/sad_test.cpp": '#include "tests/support/fork.h"\n#include "sw/explore/plan.h"\n'
    "#include <tlm>\n",
}


class CheckIncludes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for path, text in GOOD.items():
            self.write(path, text)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def findings(self):
        return [f"{path}:{line}: {what}" for path, line, what in check_includes.check(self.root)]

    def expect_only(self, path, text, finding):
        self.write(path, text)
        findings = self.findings()
        self.assertEqual(len(findings), 1, findings)
        self.assertIn(finding, findings[0])

    def test_passes_a_tree_that_keeps_the_rules(self):
        self.assertEqual(self.findings(), [])

    def test_finds_models_that_include_platform(self):
        self.expect_only(
            "models/a.cpp", '\n#include "platform/board_config.h"\n', "models/a.cpp:2: \"platform/board"
        )

    def test_finds_a_room_that_includes_one_above_it(self):
        for includer, included, finding in (
            ("platform/config/a.h", "platform/board.h", "platform/config may not include it"),
            ("sw/explore/store/a.h", "sw/explore/plan.h", "sw/explore/store may not include it"),
            ("sw/driver/a.h", "sw/explore/plan.h", "sw/driver may not include it"),
        ):
            with self.subTest(includer):
                self.expect_only(includer, f'#pragma once\n#include "{included}"\n', finding)
                (self.root / includer).unlink()

    def test_lets_a_room_include_those_below_it(self):
        self.write("sw/files/a.h", "#pragma once\n")
        self.write("sw/explore/store/b.h", '#pragma once\n#include "sw/files/a.h"\n')
        self.write("sw/runs/sources/c.h", '#pragma once\n#include "sw/explore/store/b.h"\n')
        self.write("sw/cli/d.h", '#pragma once\n#include "sw/runs/sources/c.h"\n')
        self.assertEqual(self.findings(), [])

    def test_finds_models_that_include_sw(self):
        self.expect_only("models/a.cpp", '#include "sw/explore/plan.h"\n', "models may not include it")

    def test_finds_platform_that_includes_sw(self):
        self.expect_only("platform/a.cpp", '#include "sw/explore/plan.h"\n', "platform may not include it")

    def test_finds_calib_that_includes_platform(self):
        self.expect_only("calib/a.cpp", '#include "platform/board_config.h"\n', "calib may not include it")

    def test_finds_calib_that_includes_a_model(self):
        self.expect_only(
            "calib/a.cpp", '#include "models/memory/memory_config.h"\n', "calib may not include it"
        )

    def test_finds_anything_that_includes_tests(self):
        for folder in ("models", "platform", "calib", "sw"):
            with self.subTest(folder):
                path = f"{folder}/a.cpp"
                self.expect_only(path, '#include "tests/support/fork.h"\n', f"{folder} may not include it")
                (self.root / path).unlink()

    def test_finds_systemc_in_a_kernel(self):
        for header in ("systemc", "systemc.h", "tlm", "tlm_utils/peq_with_get.h", "sysc/kernel/sc_time.h"):
            with self.subTest(header):
                self.expect_only("models/kernels/a.cpp", f"#include <{header}>\n", "may not include SystemC")

    def test_does_not_take_a_longer_name_for_systemc(self):
        self.write("models/kernels/a.cpp", "#include <tlmx>\n#include <systemc_free>\n")
        self.assertEqual(self.findings(), [])

    def test_finds_systemc_behind_other_headers(self):
        self.write("models/memory/deep.h", '#pragma once\n#include "models/memory/ssram_bank.h"\n')
        self.expect_only(
            "platform/other_config.h",
            '#pragma once\n\n#include "models/memory/deep.h"\n',
            "platform/other_config.h:3: models/memory/deep.h -> models/memory/ssram_bank.h -> systemc: "
            "this file may not include SystemC",
        )

    def test_finds_systemc_wherever_it_may_not_be(self):
        for path in (
            "models/area/a.h",
            "models/pci/pci_config.h",
            "models/fpga/register_map.h",
            "models/fpga/core_registers.h",
            "sw/explore/a.cpp",
            "sw/driver/a.cpp",
        ):
            with self.subTest(path):
                pragma = "#pragma once\n" if path.endswith(".h") else ""
                self.expect_only(
                    path, pragma + '#include "models/memory/ssram_bank.h"\n', "may not include SystemC"
                )
                (self.root / path).unlink()
        self.expect_only("calib/a.cpp", "#include <systemc>\n", "calib/a.cpp:1: systemc: this file may not")

    def test_finds_opencv_in_models_and_platform(self):
        for path in ("models/a.cpp", "platform/a.cpp"):
            with self.subTest(path):
                self.expect_only(path, "#include <opencv2/imgproc.hpp>\n", "may not include OpenCV")
                (self.root / path).unlink()

    def test_finds_eigen_in_models_and_platform(self):
        for path in ("models/a.cpp", "platform/a.cpp"):
            with self.subTest(path):
                self.expect_only(path, "#include <Eigen/Core>\n", "may not include Eigen")
                (self.root / path).unlink()

    def test_finds_yaml_and_files_in_models(self):
        for header in ("yaml-cpp/yaml.h", "fstream", "filesystem", "nlohmann/json.hpp"):
            with self.subTest(header):
                self.expect_only("models/a.cpp", f"#include <{header}>\n", "may not include YAML or files")

    def test_finds_a_path_that_does_not_start_at_the_root(self):
        self.expect_only("models/kernels/a.cpp", '#include "sad.h"\n', '"sad.h": no such file')

    def test_finds_a_path_through_the_parent_folder(self):
        self.expect_only(
            "models/memory/a.cpp", '#include "../kernels/sad.h"\n', "no such file below the repository"
        )

    def test_finds_a_header_that_does_not_exist(self):
        self.expect_only(
            "sw/cli/a.cpp", '#include "models/kernels/none.h"\n', "no such file below the repository"
        )
        self.expect_only(
            "sw/cli/a.cpp", "#include <models/kernels/none.h>\n", "no such file below the repository"
        )

    def test_finds_a_project_header_in_angle_brackets(self):
        self.expect_only("sw/cli/a.cpp", "#include <models/kernels/sad.h>\n", "is included with quotes")

    def test_ignores_an_include_in_a_comment(self):
        self.write("models/kernels/a.cpp", '// #include <systemc>\n/*\n#include "sw/none.h"\n*/\n')
        self.assertEqual(self.findings(), [])

    def test_counts_lines_across_comments_and_literals(self):
        self.expect_only(
            "models/kernels/a.cpp",
            '/* one\n two */\nconst char* a = "/*";\nconst char* b = R"x(\n)" #)x";\n#include <tlm>\n',
            "models/kernels/a.cpp:6: tlm",
        )

    def test_does_not_take_a_digit_separator_for_a_literal(self):
        self.expect_only(
            "models/kernels/a.cpp",
            "int a = 1'000; /* it's\n#include <tlm>\n*/\n#include <systemc>\n",
            "a.cpp:4: systemc",
        )

    def test_finds_a_header_without_pragma_once(self):
        self.expect_only(
            "models/kernels/a.h", "#include <cstdint>\n#pragma once\n", "begins with #pragma once"
        )
        self.expect_only("models/kernels/a.h", "", "begins with #pragma once")

    def test_passes_a_comment_before_pragma_once(self):
        self.write("models/kernels/a.h", "// About sums.\n#pragma once\n")
        self.assertEqual(self.findings(), [])

    def test_finds_using_namespace_in_a_header(self):
        self.expect_only(
            "models/kernels/a.h",
            "#pragma once\n  using  namespace std;\n",
            "models/kernels/a.h:2: using namespace",
        )

    def test_passes_using_namespace_in_a_source_file_a_comment_or_a_text(self):
        self.write("models/kernels/a.cpp", "using namespace std;\n")
        self.write(
            "models/kernels/a.h",
            '#pragma once\n// using namespace std;\nconst char* a = "using namespace";\n',
        )
        self.assertEqual(self.findings(), [])

    def test_ends_where_headers_include_each_other(self):
        self.write("models/kernels/a.h", '#pragma once\n#include "models/kernels/b.h"\n')
        self.write("models/kernels/b.h", '#pragma once\n#include "models/kernels/a.h"\n')
        self.assertEqual(self.findings(), [])

    def run_program(self, *arguments):
        program = pathlib.Path(check_includes.__file__)
        command = [sys.executable, program, *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    def test_the_program_exits_with_0_for_a_good_tree(self):
        done = self.run_program(str(self.root))
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))

    def test_the_program_exits_with_1_and_names_the_place_in_a_bad_tree(self):
        self.write("models/a.cpp", "#include <fstream>\n")
        done = self.run_program(str(self.root))
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout, "models/a.cpp:1: fstream: this file may not include YAML or files\n")

    def test_the_program_exits_with_2_outside_a_tree(self):
        self.assertEqual(self.run_program(str(self.root / "models/kernels")).returncode, 2)
        self.assertEqual(self.run_program().returncode, 2)


if __name__ == "__main__":
    unittest.main()
