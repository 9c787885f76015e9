"""Runs a client of any DDS vendor against a scene server; it has to end well and to have printed what the server has.

usage: clients_test.py SERVER CLIENT...
"""
import os
import subprocess
import sys
from pathlib import Path

# Without multicast, so that neither the network nor other tests are met.
CYCLONE = """<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General><Discovery>
<ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery></Domain></CycloneDDS>"""


def read_truth(server, client):
    """The lines that a client with that name has to print."""
    truth = []
    for line in server.stdout:
        if line.strip() == "ready":
            return truth
        name, text = line.strip().split(": ", 1)
        if name == client:
            truth.append(text)
    raise SystemExit("the server ended before it was ready")


def main():
    server_program, *client_command = sys.argv[1:]
    domain = str(100 + os.getpid() % 100)
    environment = {**os.environ, "ROS_DOMAIN_ID": domain, "CYCLONEDDS_URI": CYCLONE}
    with subprocess.Popen([server_program], env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          text=True) as server:
        truth = read_truth(server, Path(client_command[-1]).name)
        client = subprocess.run([*client_command, domain], env=environment, capture_output=True, text=True, timeout=150)
        server.stdin.close()
        print(client.stdout, client.stderr, sep="")
        missing = [line for line in truth if line not in client.stdout.splitlines()]
        for line in missing:
            print(f"FAILED the client should have printed: {line}")
        return 1 if client.returncode != 0 or missing or server.wait(timeout=20) != 0 else 0


if __name__ == "__main__":
    sys.exit(main())
