"""explain: its figures follow from the frames of a run, and its texts from its figures."""

import json

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

CLOCK_HZ = 5992 / 1600 * 1e6  # of CAMERA_RATES
ONE_BANK = sets("allocation.left_image=[bank0, bank0]")


class Figures(ProgramTest):
    def document(self, *options):
        return json.loads(self.succeeds(run("explain", "fpl2003", *SMALL, *options, "--json")))

    def ran(self, *options):
        return json.loads(self.succeeds(run("run", "fpl2003", *SMALL, *options, "--synthetic", 1, "--json")))

    def test_the_time_is_shared_among_the_frames_of_the_steady_rate(self):
        options = [*CAMERA_RATES, *ONE_BANK]
        shares = self.document(*options)["time_percent"]
        stats = self.ran(*options, "--frames", 42)
        frames = stats["frame_cycles"][2:]  # behind a turn of two
        mean = sum(frames) / len(frames)
        self.assertNotAlmostEqual(mean, sum(stats["frame_cycles"]) / 42, delta=0.5)
        waits = 1 - CLOCK_HZ / stats["waitless_frames_per_second"] / mean
        of_frames = 100 - sum(shares["core_waits"].values())
        self.assertAlmostEqual(shares["waits"], of_frames * waits, places=6)

    def test_the_matcher_is_busy_until_it_is_drained(self):
        resources = {each["resource"]: each for each in self.document(*PRELOADED)["resources"]}
        stats = self.ran(*PRELOADED)
        works = stats["cycles"] - 4 - 1  # not before the first slot is read, nor in the last write
        self.assertAlmostEqual(resources["matcher"]["busy_percent"], 100 * works / stats["cycles"])

    def test_of_the_frames_of_a_turn_a_resource_has_that_with_the_least_headroom(self):
        for table, frames in ("bank0", (0, 1)), ("bank1", (1, 0)):  # the picture of frame 0, of frame 1
            found = self.document(*PRELOADED, *sets(f"allocation.left_lut={table}"))["resources"]
            shown = {each["resource"]: each.get("frame") for each in found}
            self.assertEqual((shown[f"bank {table}"], shown["matcher"]), frames)

    def test_a_bank_at_which_the_host_alone_waits_is_not_that_of_the_longest_wait(self):
        last = sets("fpga.priority=[left_lut, right_lut, left_pixel, right_pixel, result, host]")
        advice = "bank0 holds 2 buffers: `stereotlm allocate`"
        for options, ports in (last, {"host"}), ([], {"left_pixel"}):
            options = [*CAMERA_RATES, *ONE_BANK, *options]
            blame = self.ran(*options, "--frames", 42)["blame"]
            self.assertEqual({row["port"] for row in blame}, ports)
            text = self.succeeds(run("explain", "fpl2003", *SMALL, *options))
            self.assertEqual(advice in text, "left_pixel" in ports)

    def test_a_rate_is_at_its_bound_if_it_is_less_than_half_a_percent_below(self):
        for window, is_at_bound in (9, False), (11, True):
            options = sets("allocation.left_lut=bank4", "matcher.disparities=254", f"matcher.window={window}")
            document = self.document(*PRELOADED, *options)
            below = 1 - document["frames_per_second"] / document["bound"]["frames_per_second"]
            self.assertAlmostEqual(below, 0.005, delta=0.0005)
            self.assertEqual(below < 0.005, is_at_bound)
            self.assertEqual("at the bound" in document["limited_by"], is_at_bound)

    def test_a_bus_with_less_than_a_tenth_of_headroom_is_named(self):
        bus = sets("bridge.local_clock_mhz=1", "cameras.frame_rate_hz=1000", "cameras.trigger=on_demand")
        for clock_mhz, is_named in (4.65, False), (4.7, True):
            document = self.document(*bus, *sets(f"fpga.clock_mhz={clock_mhz}"))
            (bridge,) = (each for each in document["resources"] if each["resource"] == "bridge")
            self.assertAlmostEqual(bridge["headroom_percent"], 10, delta=0.7)
            self.assertEqual(bridge["headroom_percent"] < 10, is_named)
            self.assertEqual("; the PCI bridge is busy in" in document["limited_by"], is_named)


if __name__ == "__main__":
    program.main()
