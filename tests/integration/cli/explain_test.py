"""explain: its figures follow from the frames of a run, and its texts from its figures."""

import json

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

CLOCK_HZ = 5992 / 1600 * 1e6  # of CAMERA_RATES
# Frames take so long beside all else that 2 in 3 camera frames are proven.
PROVEN = sets("image.width=128", "image.height=96", "cameras.frame_rate_hz=30", "fpga.clock_mhz=1.8")
ONE_BANK = sets("allocation.left_image=[bank0, bank0]")


def changed(options, values):
    """Options --set with these values in place of others of the same keys."""
    keys = ["--set", *(value.partition("=")[0] for value in values)]
    return sets(*(each for each in options if each.partition("=")[0] not in keys), *values)


class Figures(ProgramTest):
    def document(self, *options):
        return json.loads(self.succeeds(run("explain", "fpl2003", *SMALL, *options, "--json")))

    def ran(self, *options, image=SMALL):
        return json.loads(self.succeeds(run("run", "fpl2003", *image, *options, "--synthetic", 1, "--json")))

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

    def rates(self, *options, image=SMALL):
        return self.ran(*options, "--timing-only", image=image)["frames_per_second"]

    def test_rates_are_those_of_the_long_run(self):
        document = json.loads(self.succeeds(run("explain", "fpl2003", *PROVEN, "--page-data")))
        long, short = (self.ran("--timing-only", "--frames", frames, image=PROVEN) for frames in (202, 102))
        energy = [stats["frames"] * stats["energy"]["memory_mj_per_frame"] for stats in (long, short)]
        self.assertAlmostEqual((energy[0] - energy[1]) / 100 / document["memory_mj_per_frame"], 1, delta=1e-3)
        exact = 0
        for change in [document, *document["changes"][::3]]:  # each run takes some 0.3 s
            options = changed(PROVEN, change.get("sets", []))
            rate, uncertainty = change["frames_per_second"], change["uncertainty_frames_per_second"]
            found = self.rates("--frames", 42, image=options)
            for open_rate in found["steady"] - rate, uncertainty:
                self.assertLessEqual(abs(open_rate), found["steady_uncertainty"] + 1e-9)
            if "exact" in found:
                exact += 1
                found = self.rates("--frames", 202, image=options)
                self.assertEqual((rate, uncertainty), (found["exact"], 0))
                self.assertAlmostEqual(found["steady"], rate, delta=found["steady_uncertainty"] + 1e-9)
        self.assertGreater(exact, 8)

    def test_no_step_that_is_left_out_is_better(self):
        """All ways to move what one bank holds into another one."""
        held = {"bank0": "left_image[0]", "bank1": "left_image[1]", "bank2": "right_image[0]",
                "bank3": "right_image[1]", "bank4": "disparity[0]", "bank5": "disparity[1]",
                "bank6": "left_lut[0]", "bank7": "right_lut[0]"}
        changes = json.loads(self.succeeds(run("explain", "fpl2003", *SMALL, *CAMERA_RATES, "--page-data")))
        (best,) = (each for each in changes["changes"] if each["key"] == "a bank less")
        for bank, buffer in held.items():
            name, entry = buffer[:-3], int(buffer[-2])
            for other in held:
                places = sorted(own for own, its in held.items() if its[:-3] == name)
                places[entry] = other
                value = f"[{', '.join(places)}]" if len(places) > 1 else places[0]
                found = self.rates(*CAMERA_RATES, *sets(f"allocation.{name}={value}"), "--frames", 42)
                self.assertLessEqual(found["steady"] - found["steady_uncertainty"],
                                     best["frames_per_second"] + best["uncertainty_frames_per_second"])

    def test_a_proven_rate_does_not_hide_a_loss_of_pixels(self):
        few = ["capture.fifo_words=2", "capture.fifo_trigger_words=1", "pci.bridge_wait_clocks=16"]
        changes = self.document(*CAMERA_RATES, *sets(*few))["changes"]
        for lossy in "capture.fifo_words=1", "capture.fifo_trigger_words=2":
            (change,) = (each for each in changes if each["sets"] == [lossy])
            self.assertTrue(change["loses_pixels"])
            found = self.rates(*CAMERA_RATES, *changed(sets(*few), [lossy]), "--frames", 42)
            self.assertEqual(change["frames_per_second"], found["steady"])
            self.assertAlmostEqual(change["memory_mj_changed_percent"], 0, delta=0.5)


if __name__ == "__main__":
    program.main()
