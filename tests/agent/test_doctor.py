"""The doctor looks and reports; it changes nothing and does not import what it looks for."""

from __future__ import annotations

import sys

import pytest

from scenewright.agent import doctor
from scenewright.gaussians.language import encoders, masks


def test_every_finding_is_usable_or_says_what_to_do() -> None:
    findings = doctor.examine()
    assert {"torch", "cuda", "embedded encoder", "torchvision", "ffmpeg"} <= {f.name for f in findings}
    assert all(f.usable != bool(f.fix) for f in findings)
    assert len({f.name for f in findings}) == len(findings)


def test_every_encoder_and_source_of_masks_is_told_of() -> None:
    told = " ".join(f"{f.name} {f.serves}" for f in doctor.examine())
    assert all(name in told for name in encoders.backends())
    assert all(name in told for name in masks.sources())


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_version", lambda name: "")
    findings = {f.name: f for f in doctor.examine()}
    assert not findings["torch"].usable and findings["torch"].needed and findings["torch"].fix
    assert findings["torchvision"].detail == "not installed"
    assert all("models" in findings[name].fix for name in ("onnx:FOLDER", "masks sam:PATH"))


def test_a_cpu_torch_is_not_asked_for_cuda(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_version", lambda name: "2.13.0+cpu")
    assert doctor._cuda().detail == "this torch is a CPU build"


@pytest.mark.parametrize(
    ("problems", "usable", "told"),
    [(["", ""], True, "imports beside"), (["nms", ""], True, "cures"), (["nms", "broken"], False, "broken")],
)
def test_the_torchvision_trap(monkeypatch: pytest.MonkeyPatch, problems: list[str], usable: bool, told: str) -> None:
    answers = iter(problems)
    monkeypatch.setattr(doctor, "_version", lambda name: {"torch": "2.13.0+cpu"}.get(name, "0.28.0"))
    monkeypatch.setattr(doctor, "_problem", lambda code: next(answers))
    finding = doctor._torchvision()
    assert finding.usable is usable and told in finding.detail


def test_a_failing_import_is_quoted() -> None:
    assert doctor._problem("import sys") == ""
    assert "No module named 'no_such_module'" in doctor._problem("import no_such_module")


def test_the_machine() -> None:
    assert doctor.machine()["executable"] == sys.executable
