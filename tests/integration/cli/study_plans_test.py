"""The plans of the studies, which are examples too: each is a plan, and its first point a board that runs."""

import pathlib

import program
from program import ProgramTest, run

RESULTS = pathlib.Path(__file__).resolve().parents[3] / "results"
# results/demo is where ./demo and the README write.
PLANS = sorted(plan for plan in RESULTS.glob("*/*.yaml") if plan.parent.name != "demo")


class StudyPlans(ProgramTest):
    def test_are_there(self):
        self.assertLessEqual({"arbitration", "bank_kinds", "banks", "buffers", "fetch"}, {plan.parent.name for plan in PLANS})

    def test_run(self):
        for plan in PLANS:
            with self.subTest(plan=plan.relative_to(RESULTS)):
                store = self.folder / f"{plan.parent.name}_{plan.stem}.db"
                said = self.succeeds(run("sweep", plan, "--out", store, "--shard", "0/1000000"))
                self.assertIn("1 ok, 0 impossible, 0 failed", said)


if __name__ == "__main__":
    program.main()
