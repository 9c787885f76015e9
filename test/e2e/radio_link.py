"""A radio link between two network namespaces: two TUN devices with rate, delay, loss, bursts and outages between them."""
import contextlib
import fcntl
import multiprocessing
import os
import random
import selectors
import struct
import subprocess
import time
from collections import deque
from dataclasses import dataclass

VEHICLE, GROUND = "10.99.0.1", "10.99.0.2"
QUEUE_BYTES = 256 * 1024
LATE_S = 0.02  # A packet that is delivered so late was held up by this machine, not by the link.
TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000


class NoLink(Exception):
    """This machine cannot have such a link; the message says why."""


@dataclass
class Conditions:
    rate_mbps: float = 20.0
    delay_s: float = 0.025       # each way
    loss_ratio: float = 0.0      # of IP packets
    burst_packets: float = 1.0   # mean length of a loss


class Direction:
    """Packets on their way from one end to the other, through a drop-tail queue; losses follow Gilbert's two states."""

    def __init__(self, source, target, conditions, tally, seed):
        self.source, self.target, self.conditions, self.tally = source, target, conditions, tally
        self.random = random.Random(seed)
        self.on_air = deque()    # (arrival, packet)
        self.free_at = 0.0
        self.is_losing = False

    def take(self, now, is_up):
        for _ in range(64):
            try:
                packet = os.read(self.source, 2048)
            except BlockingIOError:
                return
            byte_s = 8e-6 / self.conditions.rate_mbps
            starts = max(now, self.free_at)
            if not is_up or (starts - now) / byte_s > QUEUE_BYTES:
                continue
            self.free_at = starts + len(packet) * byte_s
            if not self.loses():
                self.on_air.append((self.free_at + self.conditions.delay_s, packet))

    def loses(self):
        ratio, length = self.conditions.loss_ratio, max(self.conditions.burst_packets, 1.0)
        if length == 1.0 or ratio <= 0.0:
            return self.random.random() < ratio
        leaves = 1.0 / length
        self.is_losing = self.random.random() < (1.0 - leaves if self.is_losing else leaves * ratio / (1.0 - ratio))
        return self.is_losing

    def deliver(self, now):
        while self.on_air and self.on_air[0][0] <= now:
            due, packet = self.on_air.popleft()
            self.tally[0] += 1
            self.tally[1] += now - due > LATE_S
            with contextlib.suppress(OSError):  # The namespace is going down.
                os.write(self.target, packet)


def forward(ends, conditions, is_up, tally):
    ways = [Direction(ends[0], ends[1], conditions, tally, 1), Direction(ends[1], ends[0], conditions, tally, 2)]
    with selectors.DefaultSelector() as selector:
        for way in ways:
            selector.register(way.source, selectors.EVENT_READ, way)
        while True:
            now = time.monotonic()
            due = min((way.on_air[0][0] for way in ways if way.on_air), default=now + 0.1)
            for key, _ in selector.select(max(due - now, 0.0)):
                key.data.take(time.monotonic(), bool(is_up.value))
            for way in ways:
                way.deliver(time.monotonic())


def ip(*arguments):
    done = subprocess.run(["ip", *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        raise NoLink(f"ip {' '.join(arguments)}: {done.stderr.strip()}")


def open_tun(name):
    try:
        end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
        fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH", name.encode(), IFF_TUN | IFF_NO_PI))
    except OSError as problem:
        raise NoLink(f"/dev/net/tun: {problem.strerror}") from problem
    return end


class RadioLink:
    """`vehicle` and `ground` are what to put before a command to run it at that end."""

    def __init__(self, conditions):
        self.conditions = conditions
        self.is_up = multiprocessing.Value("b", 1)
        self.tally = multiprocessing.Array("L", 2)  # packets delivered, and of these too late

    def __enter__(self):
        if os.geteuid() != 0:
            raise NoLink("network namespaces need root")
        self.undo = contextlib.ExitStack()
        with self.undo:
            ends = [self.make_end(VEHICLE, "v"), self.make_end(GROUND, "g")]
            worker = multiprocessing.get_context("fork").Process(
                target=forward, args=(ends, self.conditions, self.is_up, self.tally), daemon=True)
            worker.start()
            self.undo.callback(worker.join)
            self.undo.callback(worker.terminate)
            self.undo = self.undo.pop_all()
        return self

    def __exit__(self, *_):
        self.undo.close()

    def make_end(self, address, letter):
        space = device = f"sf{letter}{os.getpid()}"
        end = open_tun(device)
        self.undo.callback(os.close, end)
        ip("netns", "add", space)
        self.undo.callback(ip, "netns", "del", space)
        ip("link", "set", device, "netns", space)
        ip("-n", space, "address", "add", f"{address}/24", "dev", device)
        ip("-n", space, "link", "set", device, "up")
        ip("-n", space, "link", "set", "lo", "up")
        return end

    def at(self, letter):
        return ["ip", "netns", "exec", f"sf{letter}{os.getpid()}"]

    @property
    def vehicle(self):
        return self.at("v")

    @property
    def ground(self):
        return self.at("g")

    @property
    def late_ratio(self):
        return self.tally[1] / max(self.tally[0], 1)

    def cut(self):
        self.is_up.value = 0

    def restore(self):
        self.is_up.value = 1
