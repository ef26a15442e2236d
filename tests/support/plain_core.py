"""The timing of the core (sections 1, 2, 7 and 8 of models/contract.md) as a plain loop over clock cycles,
with the identity as tables. It shares nothing with the program."""

LATENCY = {"zbt_pipelined": 2, "zbt_flow_through": 1, "sync_burst": 2, "qdr": 2}
BUFFERS = ("left_image", "right_image", "disparity", "left_lut", "right_lut")


def up(dividend, divisor):
    return -(-dividend // divisor)


def read_latency(bank):
    return bank.get("cas_latency") if bank["kind"] == "sdram" else LATENCY[bank["kind"]]


def bank_of(board, name):
    """The keys of a bank: what its entry does not give is that of the default."""
    return {**board["ssram"].get("default", {}), **board["ssram"]["banks"][name]}


def buffers(board):
    """By name of the list: of each of its buffers the banks of its parts."""
    found = {}
    for name in BUFFERS:
        given = board["allocation"][name]
        each = given if isinstance(given, list) else [given]
        found[name] = [one["rows"] if isinstance(one, dict) else [one] for one in each if one != "none"]
    return found


class Arbiter:
    """Of a bank, or of one direction of a qdr bank. Ports are their places in the list of priorities."""

    def __init__(self, bank, policy, ports):
        self.policy, self.ports, self.last = policy, ports, -1
        self.waits = {}  # port: its age, and the cycle in which it had it
        self.last_access = {False: -10**9, True: -10**9}  # by whether it was a write
        self.turnaround = int(bank["turnaround_cycles"]) if bank["kind"] == "sync_burst" else 0
        self.sdram = bank if bank["kind"] == "sdram" else None
        self.refreshes, self.busy_until, self.open = 0, 0, {}

    def age(self, port, now):
        age, last = self.waits.get(port, (0, None))
        return age + 1 if last == now - 1 else 1

    def decide(self, asked, now):
        """The port that is granted, or None. asked: for each port whether it writes, and the word."""
        winner = self.outcome(asked, now)
        if self.policy == "age":
            self.waits = {port: (self.age(port, now), now) for port in asked if port != winner}
        return winner

    def outcome(self, asked, now):
        if self.sdram:
            self.refresh(now)
        if now < self.busy_until or not asked:
            return None
        order = {"fixed_priority": lambda port: port, "age": lambda port: (-self.age(port, now), port),
                 "round_robin": lambda port: (port - self.last - 1) % self.ports}[self.policy]
        winner = min(asked, key=order)
        writes, word = asked[winner]
        if self.sdram:
            row = word // self.sdram["row_words"]
            inner = row % self.sdram["internal_banks"]
            if self.open.get(inner) != row:
                closing = self.sdram["precharge_cycles"] if inner in self.open else 0
                self.busy_until = now + self.sdram["activate_cycles"] + closing
                self.open[inner] = row
                if now < self.busy_until:
                    return None
            if writes and now - self.last_access[False] < self.sdram["cas_latency"] + 1:
                return None
        elif now < self.last_access[not writes] + self.turnaround + 1 and self.turnaround:
            return None
        self.last = winner
        self.last_access[writes] = now
        return winner

    def refresh(self, now):
        interval = self.sdram["refresh_interval_cycles"]
        while interval != "off":
            begin = max((self.refreshes + 1) * interval, self.busy_until)
            if begin > now:
                return
            self.refreshes += 1
            self.busy_until = begin + self.sdram["refresh_cycles"]
            self.busy_until += self.sdram["precharge_cycles"] if self.open else 0
            self.open = {}


class Core:
    def __init__(self, board):
        fpga, matcher, image = board["fpga"], board["matcher"], board["image"]
        self.W, self.H = image["width"], image["height"]
        self.is_column = matcher["fetch"] == "column"
        n, D, self.R = matcher["window"], matcher["disparities"], matcher.get("rows", 1)
        kind, cost = matcher["filter"], matcher.get("cost", "sad")
        h = {"none": 0, "log7": 3}[kind] if isinstance(kind, str) else (len(kind["kernel"]) - 1) // 2
        h += (cost["census"] - 1) // 2 if isinstance(cost, dict) else 0
        r = (n - 1) // 2
        self.P = fpga.get("lanes", 1)
        self.K = n + self.R - 1 if self.is_column else 1
        self.G = up(self.K, self.P)
        units = matcher.get("units", "all")
        self.S = 1 if units == "all" else up(D, units)
        w = self.R * up(max(0, h - r), self.R)
        if self.is_column:
            self.slots = [(u, v + h - r + k, k, u == 0) for v in range(-w, self.H, self.R)
                          for u in range(self.W) for k in range(self.K)]
        else:
            self.slots = [(u, y, 0, u == 0) for y in range(self.H + r + h) for u in range(self.W)]
        self.drain = D - 1 + r + h
        self.ahead = self.drain + (w // self.R if self.is_column else r + h) * self.W
        self.lane_slots, self.queue_words = fpga["lane_fifo_slots"], fpga["result_fifo_words"]
        self.latency, self.delay = fpga["pipeline_latency_cycles"], fpga.get("result_delay_cycles", 0)
        self.joint, self.cache = fpga.get("tables") == "joint", fpga.get("pixel_cache") == "word"

        # The ports: P of left_lut, of right_lut, of left_pixel and of right_pixel, then result.
        place, self.place = 0, {}
        for group in fpga["priority"]:
            for p in range(self.P if group not in ("result", "host") else 1):
                self.place[group, p] = place
                place += 1
        names = list(board["ssram"]["banks"])
        banks = [bank_of(board, name) for name in names]
        self.arbiters = [[Arbiter(bank, fpga["arbitration"], place)
                          for _ in range(2 if bank["kind"] == "qdr" else 1)] for bank in banks]
        # Where the buffers, or their parts, lie: (bank, first word) of each part.
        ends, self.at, self.latencies = [0] * len(banks), {}, {}
        for name, each in buffers(board).items():
            self.at[name], self.latencies[name] = [], []
            for parts in each if name != "right_lut" or not self.joint else []:
                where = []
                for i, bank in enumerate(map(names.index, parts)):
                    where.append((bank, ends[bank]))
                    ends[bank] += up(self.H - i, len(parts)) * self.W // (1 if "lut" in name else 4)
                self.at[name].append(where)
                self.latencies[name].append(read_latency(banks[where[0][0]]))
        if self.joint:
            for found in (self.at, self.latencies):
                found["right_lut"] = found["left_lut"]
        self.now = 0

    def word(self, parts, row, column, row_words):
        bank, first = parts[row % len(parts)]
        return bank, first + row // len(parts) * row_words + column

    def accesses(self, name, entry, p):
        """Of each slot of lane p: its (bank, word) in this buffer, or None if it passes."""
        found, kept, parts = [], {}, self.at[name][entry]
        for u, row, k, begins in self.slots:
            if k % self.P != p:
                continue
            if begins:
                kept.pop(k, None)
            if not 0 <= row < self.H:
                found.append(None)
            elif "lut" in name:
                found.append(self.word(parts, row, u, self.W))
            elif self.cache and kept.get(k) == (row, u // 4):
                found.append(None)
            else:
                found.append(self.word(parts, row, u // 4, self.W // 4))
                kept[k] = (row, u // 4)
        return found

    def frame_cycles(self, frame, is_waitless=False):
        """Runs the next frame. is_waitless: every request is granted at once."""
        P, lanes = self.P, range(2 * self.P)
        images, tables = ("left_image", "right_image"), ("left_lut", "right_lut")
        entry = frame % len(self.at["left_image"])
        result = self.at["disparity"][frame % len(self.at["disparity"])]
        has_table = [bool(self.at[tables[i // P]]) for i in lanes]
        lut = [self.accesses(tables[i // P], 0, i % P) if has_table[i] else [] for i in lanes]
        pixel = [self.accesses(images[i // P], entry, i % P) for i in lanes]
        table_latency = [self.latencies[tables[i // P]][0] if has_table[i] else 0 for i in lanes]
        image_latency = [self.latencies[images[i // P]][entry] for i in lanes]
        taken, handled = [[] for _ in lanes], [[] for _ in lanes]  # of each slot, in which cycle
        consumed = [0 for _ in lanes]
        slot_columns = len(self.slots) // self.K
        column = g = written = 0
        queue, work_ends, start, now = [], None, self.now, self.now - 1
        while written < self.W * self.H // 4:
            now += 1
            acts = set()  # ports whose access is granted, or that pass: their numbers
            asked = {}  # by bank, and whether it is the second direction of a qdr bank

            def ask(port, access, writes=False):
                if access is None or is_waitless:
                    acts.add(port)
                    return
                bank, word = access
                direction = int(writes) if len(self.arbiters[bank]) == 2 else 0
                group = (*tables, "left_pixel", "right_pixel", "result")[port // P]
                asked.setdefault((bank, direction), {})[self.place[group, port % P]] = (port, writes, word)

            for i in lanes:
                has_room = len(taken[i]) < len(pixel[i]) and len(taken[i]) - consumed[i] < self.lane_slots
                if not has_table[i]:
                    if has_room:
                        ask(2 * P + i, pixel[i][len(taken[i])])
                    continue
                if has_room and (i < P or not self.joint):
                    ask(i, lut[i][len(taken[i])])
                slot = len(handled[i])
                if slot < len(taken[i]) and now >= taken[i][slot] + table_latency[i]:
                    ask(2 * P + i, pixel[i][slot])
            if queue and queue[0][2] < now:
                row, col, _ = queue[0]
                ask(4 * P, self.word(result, row, col, self.W // 4), True)
            uses = [i for i in lanes if column < slot_columns and g * P + i % P < self.K]
            if (work_ends is None and len(queue) + self.R <= self.queue_words
                    and column < slot_columns + self.drain
                    and all(len(handled[i]) > consumed[i]
                            and now >= handled[i][consumed[i]] + image_latency[i] for i in uses)):
                work_ends = now + self.S - 1

            for (bank, direction), requests in asked.items():
                arbiter = self.arbiters[bank][direction]
                winner = arbiter.decide({place: each[1:] for place, each in requests.items()}, now)
                if winner is not None:
                    acts.add(requests[winner][0])
            if 4 * P in acts:
                queue.pop(0)
                written += 1
            if work_ends == now:
                work_ends = None
                for i in uses:
                    consumed[i] += 1
                g = (g + 1) % self.G
                if g == 0:
                    index = column - self.ahead
                    column += 1
                    if index >= 0 and index % 4 == 3:
                        strip = self.R * (index // self.W)
                        for row in range(strip, min(strip + self.R, self.H)):
                            queue.append((row, index % self.W // 4, now + self.delay))
            for i in lanes:
                if 2 * P + i in acts:
                    handled[i].append(now)
                if (i % P if self.joint else i) in acts if has_table[i] else 2 * P + i in acts:
                    taken[i].append(now)
        self.now = now + 1 + self.latency
        return self.now - start
