"""Drives the synchroniser from another language: python3 drive.py PROGRAM [ARGUMENTS OF vehicle_stdio]

A perfect vehicle in an empty sea: it is wherever the trajectory in force says, and reports once a second. A real one reports
where it is, hands over the echoes of its sonar, and steers by `set_point`. After a minute this one is restarted from a saved
state, as after a power cut.
"""

import json
import math
import subprocess
import sys


class Synchroniser:
    """The process, one JSON object a line each way."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.ready = json.loads(self.process.stdout.readline())

    def ask(self, message):
        self.process.stdin.write(json.dumps(message) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if answer["type"] == "refused":
            sys.exit(answer["reason"])
        return answer

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def place_at(trajectory, time_s):
    """Position and velocity on a trajectory, which is straight between its points."""
    for a, b in zip(trajectory, trajectory[1:]):
        if a[3] <= time_s < b[3]:
            velocity = [(b[i] - a[i]) / (b[3] - a[3]) for i in range(3)]
            return [a[i] + velocity[i] * (time_s - a[3]) for i in range(3)], velocity
    return (trajectory[0] if time_s < trajectory[0][3] else trajectory[-1])[:3], [0.0, 0.0, 0.0]


def main():
    command = sys.argv[1:]
    synchroniser = Synchroniser(command)
    position, velocity, trajectory, time_s = synchroniser.ready["position"], [0.0, 0.0, 0.0], None, 0.0
    restarted = False
    while True:
        if trajectory:
            position, velocity = place_at(trajectory, time_s)
        heading_rad = math.atan2(velocity[1], velocity[0])
        orders = synchroniser.ask({
            "type": "observation", "time_s": time_s, "position": position, "velocity": velocity,
            "scan": {"heading_rad": heading_rad, "background": 1.0 + 1e-3 * (time_s % 7), "echoes": []},
        })
        trajectory = orders["trajectory"] or trajectory
        for call in orders["route_calls"]:
            print(f"{time_s:7.0f} s  route: {call['reason']}, {call['tasks']} tasks")
        for leg in orders["legs"]:
            print(f"{time_s:7.0f} s  leg {leg['from']} -> {leg['to']}: {leg['leg_s']:.0f} s, {leg['expected_s']:.0f} s expected")
        if orders["outcome"]:
            print(f"{time_s:7.0f} s  {orders['outcome']}")
            break
        if time_s >= 60.0 and not restarted:
            restarted = True
            checkpoint = synchroniser.ask({"type": "save"})["checkpoint"]
            synchroniser.close()
            synchroniser = Synchroniser(command)
            resumed = synchroniser.ask({"type": "resume", "checkpoint": checkpoint})
            trajectory = resumed["trajectory"] or trajectory
            print(f"{time_s:7.0f} s  restarted")
        time_s = min(time_s + 1.0, max(orders["due_s"], time_s + 1e-3))
    synchroniser.close()


if __name__ == "__main__":
    main()
