"""A robot server for several people, on good days and bad ones."""

import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog
from robot_api.client import Robot
from robot_api.drivers import emulated
from robot_api.server import Server

ROUND = ("run", "--world", "ward", "--yes", "go to ward a and then to ward b")


@pytest.fixture
def last_run(home):
    def last_run():
        log = RunLog(home / "runs.sqlite")
        row = log.runs(1)[0]
        calls = log.calls(row.id)
        log.close()
        return row, calls

    return last_run


def test_one_serves_another_runs_a_third_stops(start, serve, last_run) -> None:
    server, address = serve("--speed", "1")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    with Robot(address) as visitor:
        visitor.stop()
    assert nurse.end() == ExitStatus.FAILED
    assert "Stopped. The robot was stopped." in nurse.output
    assert last_run()[0].status == "stopped"
    server.kill(signal.SIGTERM)
    assert server.end() == ExitStatus.OK
    assert "Traceback" not in server.output


def test_ctrl_c_at_the_client_stops_the_robot_at_the_server(start, serve) -> None:
    _, address = serve("--speed", "1")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    nurse.kill(signal.SIGINT)
    assert nurse.end() == ExitStatus.INTERRUPTED
    assert "Stopped." in nurse.output
    with Robot(address) as robot:
        assert robot.request("program.state")["state"] == "stopped"


def test_a_program_goes_on_when_its_client_is_killed(start, serve) -> None:
    _, address = serve("--speed", "20")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    nurse.kill(signal.SIGKILL)
    with Robot(address) as robot:
        assert robot.request("program.wait", {"run": 1})["state"] == "done"
        assert robot.location().place == "ward b"


def test_a_server_that_is_killed_is_told_to_the_client(start, serve, last_run) -> None:
    server, address = serve("--speed", "1")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    server.kill(signal.SIGKILL)
    assert nurse.end() == ExitStatus.NO_ROBOT
    said = " ".join(nurse.output.split())
    assert "The connection to the robot was lost. If the robot still moves, stop it by" in said
    assert "Traceback" not in said
    row, [call] = last_run()
    assert (row.status, call.seconds) == (None, None)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=lambda n: n.name)
def test_a_server_that_is_ended_stops_the_program_and_logs_it(
    start, serve, last_run, number
) -> None:
    server, address = serve("--speed", "1")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    server.kill(number)
    assert server.end() == ExitStatus.OK
    assert nurse.end() in (ExitStatus.FAILED, ExitStatus.NO_ROBOT)
    assert "Traceback" not in server.output + nurse.output
    assert last_run()[0].status == "stopped"


def test_a_port_that_is_in_use(serve, nl2robot) -> None:
    _, address = serve()
    port = address.rpartition(":")[2]
    status, out, err = nl2robot("serve", "--world", "ward", "--port", port)
    assert status == ExitStatus.BAD_INPUT
    assert f"Port {port} is in use by another program. End that program, or choose" in err
    assert out == ""


def test_others_need_the_token(serve, nl2robot) -> None:
    server, address = serve("--host", "0.0.0.0", "--speed", "20")
    token = server.output.split("this token: ")[1].split()[0]
    address = "ws://127.0.0.1:" + address.rpartition(":")[2]
    for wrong in ([], ["--token", "guessed"]):
        status, _, err = nl2robot(*ROUND, "--robot", address, *wrong)
        assert status == ExitStatus.NO_ROBOT
        assert "token is missing or wrong" in err
    status, out, _ = nl2robot(*ROUND, "--robot", address, "--token", token)
    assert status == ExitStatus.OK
    assert "Done." in out


# --- servers that run no programs, and servers of something else ---------------------------------


def test_a_robot_without_a_runner_gets_one_here(nl2robot, last_run, tmp_path) -> None:
    with Server(emulated(answers=["ward b"]), port=0) as server:
        status, out, _ = nl2robot(*ROUND, "--robot", f"ws://{server.address}")
        assert status == ExitStatus.OK
        assert "Dry run: It would take" in out
        row, calls = last_run()
        assert (row.status, row.seed, len(calls)) == ("done", None, 2)
        status, _, err = nl2robot("log", str(row.id), "--replay")
        assert status == ExitStatus.BAD_INPUT
        assert "was not simulated" in err
        (tmp_path / "stop.py").write_text('robot.stop()\nrobot.say("never")\n')
        program = ("run", "--world", "ward", "-y", "--program", str(tmp_path / "stop.py"))
        status, out, _ = nl2robot(*program, "--robot", server.address)
        assert status == ExitStatus.FAILED
        assert "Stopped. The robot was stopped." in out


ROBOT = """
from robot_api.drivers import emulated
from robot_api.server import Server
Server(emulated(speed=1.0), port=0).serve_forever(lambda server: print(server.address, flush=True))
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM], ids=lambda n: n.name)
def test_a_robot_that_is_lost_half_way(start, last_run, number) -> None:
    with subprocess.Popen([sys.executable, "-c", ROBOT], stdout=subprocess.PIPE) as robot:
        try:
            address = robot.stdout.readline().decode().strip()
            wait = ("run", "--world", "ward", "-y", "wait for one minute", "--robot", address)
            nurse = start(*wait)
            nurse.until("wait(seconds=60")
            robot.send_signal(number)
            status = nurse.end()
        finally:
            robot.kill()
    assert "Traceback" not in nurse.output
    row, [call] = last_run()
    assert call.error is not None
    if number == signal.SIGKILL:
        assert status == ExitStatus.NO_ROBOT
        assert row.status == "failed"
    else:
        assert status in (ExitStatus.FAILED, ExitStatus.NO_ROBOT)
        assert row.status in ("stopped", "failed")


def test_what_is_no_robot_is_not_waited_for(nl2robot, monkeypatch) -> None:
    from websockets.sync.server import serve

    monkeypatch.setattr("nl2robot.station.station.ANSWERS_WITHIN", 0.3)

    def echo(connection) -> None:
        for message in connection:
            connection.send(message)

    def say_nothing(connection) -> None:
        for _ in connection:
            pass

    def make_no_sense(connection) -> None:
        for _ in connection:
            connection.send('{"jsonrpc": "2.0", "id": 1, "result": {"methods": 7}}')

    for behaviour in (echo, say_nothing, make_no_sense):
        with serve(behaviour, "127.0.0.1", 0) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            port = server.socket.getsockname()[1]
            status, _, err = nl2robot(*ROUND, "--robot", f"ws://127.0.0.1:{port}")
            assert status == ExitStatus.NO_ROBOT
            assert "it is no robot's" in err
            server.shutdown()


def test_nothing_is_left_running(start, serve) -> None:
    """Neither the server nor the processes in which programs compute."""
    server, address = serve("--speed", "1")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    family = children_of(server.process.pid)
    assert family
    server.kill(signal.SIGTERM)
    server.end()
    nurse.end()
    assert not any(alive(pid) for pid in family)


def children_of(pid: int) -> list[int]:
    tasks = Path(f"/proc/{pid}/task")
    if not tasks.is_dir():
        pytest.skip("this system does not list processes under /proc")
    listed = " ".join((task / "children").read_text() for task in tasks.iterdir())
    return [int(child) for child in listed.split()]


def alive(pid: int) -> bool:
    try:
        status = Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return False
    return status.rpartition(")")[2].split()[0] != "Z"


def test_a_run_that_still_goes_on_is_no_interrupted_one(start, serve, nl2robot) -> None:
    _, address = serve("--speed", "1")
    nurse = start(*ROUND, "--robot", address)
    nurse.until("goto(place='ward a')")
    _, out, _ = nl2robot("log")
    assert "running" in out and "interrupted" not in out
    nurse.interrupt()
    nurse.end()
    assert "stopped" in nl2robot("log")[1]
